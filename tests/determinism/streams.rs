//! The first values of every random stream: they may change only on purpose.

use gather::estimator::random_bits;
use scene::{
    random::{Purpose, Stream, shard_seed},
    sequence::Sequence,
};

/// If these change, every cloud and image changes, which takes a new cloud version and new golden statistics.
#[test]
fn first_random_numbers_are_pinned() {
    let bits = |stream: Stream, item: u64| [0, 1, 2, 3].map(|d| stream.item(item).bits(d));
    let surface = Stream::new(0, Purpose::Surface);
    assert_eq!(
        bits(surface, 0),
        [0x568a_9b0b_1a2c_05ec, 0x44e5_b8b1_47ef_718b, 0x4585_63ab_5552_1133, 0x7aec_6445_39b6_c0f9]
    );
    assert_eq!(
        bits(surface, 1 << 40),
        [0x889f_9966_eed6_89d8, 0x7de5_aaba_8463_a129, 0xdc8a_a0b6_20e8_c511, 0xb7b6_2ec8_6b79_e925]
    );
    assert_eq!(
        bits(Stream::new(1, Purpose::CameraPath), 7),
        [0xfef7_27d1_3e88_ad18, 0x04e9_e17f_5b62_d955, 0xe03c_af98_49e6_3f94, 0x20f2_fb99_4103_c58c]
    );
    assert_eq!(
        bits(Stream::new(u64::MAX, Purpose::Gather), 1),
        [0x35a5_92f9_18c4_fefe, 0xa1ea_2792_e273_8ac8, 0x29e4_02d1_c0ea_0e74, 0x05e6_d95d_aae0_6379]
    );
    assert_eq!(surface.item(0).uniform(0), 0.338_052_454_195_505_45);
}

/// A shard's seed is the seed itself if it is the only one.
#[test]
fn seeds_of_shards_are_pinned() {
    assert_eq!(shard_seed(7, 0, 1), 7);
    let seeds = [(0, 0, 4), (0, 3, 4), (0, 3, 5), (1, 3, 4)].map(|(seed, k, n)| shard_seed(seed, k, n));
    assert_eq!(seeds, [0xc8ff_7482_f64a_b898, 0xffa3_aca3_3bcd_be3c, 0xec43_d485_926f_625a, 0x2685_e3c5_3263_b668]);
}

/// The random bits of the roulette: if these change, images change, but not clouds.
#[test]
fn first_bits_of_the_roulette_are_pinned() {
    let values = [(1, 0), (0, 1 << 32), (7, 0x0123_4567_89ab_cdef)].map(|(index, key)| random_bits(index, key));
    assert_eq!(values, [0x58f5_4975, 0x6889_90c0, 0xc4fb_e3e2]);
}

/// The scrambled sequences that spread samples and camera rays: if these change, every cloud and image changes.
#[test]
fn first_points_of_the_sequences_are_pinned() {
    let stream = Stream::new(0, Purpose::Scramble);
    let rest = Stream::new(0, Purpose::Remainder(1));
    let point = |index: u32| Sequence::new(stream.item(1), rest).point(index);
    assert_eq!(
        point(0),
        [0.031_515_038_004_089_946, 0.693_186_982_710_690_5, 0.895_082_485_034_507_3, 0.432_220_364_467_036_04]
    );
    assert_eq!(
        point(1_000_000),
        [0.045_214_356_450_458_904, 0.494_344_414_247_839_04, 0.147_449_398_535_658_2, 0.593_192_163_404_031_1]
    );
}
