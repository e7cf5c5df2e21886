//! Counter-based random numbers: a pure function of (seed, purpose, index, dimension).
//!
//! There is no state, so any thread may compute any number, and nothing depends on order. The first values are pinned
//! in a test: changing them changes every cloud and image.

/// The purpose of a stream: streams of different purposes are independent.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    /// Surface samples of phase one.
    Surface,
    /// Camera paths of phase two.
    CameraPath,
    /// Acceptance and choice of samples in the sums of phase two.
    Gather,
    /// Points at which paths cross their pixel.
    Pixel,
    /// Points at which paths cross the lens.
    Lens,
    /// Points around the first exitant point of a path: place and direction of their light, and the rest.
    NearField,
    NearLight,
    /// Points around later exitant points, and light that opaque surfaces reflect to any.
    NearPoint,
    /// Transmittance rays of edge pixels.
    Edge,
    /// Points at which phase two corrects the error that the cut predicts.
    CutCorrection,
    /// Directions towards lights, and of what is mirrored, at the first surface of a path that has many.
    FirstSurface,
    /// Light that surfaces mirror to rough ones, which tells where highlights are looked for.
    Highlight,
    /// Pixels by which phase two chooses the accuracy of the cut, and their gathers.
    Balance,
    /// Rounds the numbers of paths of pixels.
    Allotment,
    /// Scrambles of the sequences of phase one.
    Scramble,
    /// Light that opaque surfaces reflect to the samples of phase one.
    Bounce,
    /// The shards that the paths of a pixel gather from.
    ShardPick,
    /// The first numbers of random walks that camera paths begin.
    WalkStart,
    /// Random walks that light begins.
    LightWalk,
    /// Points of the surface where a calibration compares the model with random walks.
    CalibrationPoint,
    /// More points of the surface, which measure its parts.
    CalibrationArea,
    /// The sums over the cloud at these points.
    CalibrationSum,
    /// Random walks behind the table of the half-space model.
    HalfSpaceTable,
    /// The bits below those of one of these sequences.
    Remainder(u64),
}

impl Purpose {
    fn number(self) -> u64 {
        match self {
            Purpose::Edge => 0,
            Purpose::Surface => 1,
            Purpose::CameraPath => 2,
            Purpose::Gather => 3,
            Purpose::Scramble => 4,
            Purpose::Pixel => 5,
            Purpose::CutCorrection => 6,
            Purpose::Bounce => u64::MAX,
            Purpose::ShardPick => u64::MAX - 1,
            Purpose::LightWalk => u64::MAX - 2,
            Purpose::WalkStart => u64::MAX - 7,
            Purpose::CalibrationPoint => u64::MAX - 4,
            Purpose::CalibrationSum => u64::MAX - 5,
            Purpose::CalibrationArea => u64::MAX - 6,
            Purpose::NearField => u64::MAX - 8,
            Purpose::NearLight => u64::MAX - 9,
            Purpose::NearPoint => u64::MAX - 10,
            Purpose::FirstSurface => u64::MAX - 12,
            Purpose::Balance => u64::MAX - 11,
            Purpose::Allotment => u64::MAX - 13,
            Purpose::Highlight => u64::MAX - 14,
            Purpose::Lens => u64::MAX - 20,
            Purpose::HalfSpaceTable => u64::MAX - 3,
            Purpose::Remainder(k) => 7 + k,
        }
    }
}

/// The seed of shard `index` of `count`: `seed` itself if there is only one shard, else another for each index and
/// count.
pub fn shard_seed(seed: u64, index: u32, count: u32) -> u64 {
    if count == 1 { seed } else { mix(mix(!seed) ^ (u64::from(index) << 32 | u64::from(count))) }
}

/// All numbers of one purpose under one seed.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    key: u64,
}

/// The numbers of one item (a sample, a path) of a stream.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    key: u64,
}

impl Stream {
    pub fn new(seed: u64, purpose: Purpose) -> Stream {
        Stream { key: mix(mix(seed) ^ purpose.number().wrapping_mul(0x9E37_79B9_7F4A_7C15)) }
    }

    /// The numbers of item `index`.
    pub fn item(self, index: u64) -> Item {
        Item { key: mix(self.key.wrapping_add(index.wrapping_mul(0xD6E8_FEB8_6659_FD93))) }
    }
}

impl Item {
    /// One of several items that this one is split into; the first is this one.
    pub fn part(self, index: u64) -> Item {
        if index == 0 { self } else { Item { key: mix(self.bits(index | 1 << 63)) } }
    }

    /// 64 random bits for one dimension.
    pub fn bits(self, dimension: u64) -> u64 {
        mix(self.key.wrapping_add((dimension + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15)))
    }

    /// Uniform number in [0, 1) with 53 random bits.
    pub fn uniform(self, dimension: u64) -> f64 {
        unit(self.bits(dimension))
    }
}

/// The largest number below 1.
pub const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// The number in [0, 1) that the upper 53 of 64 bits stand for.
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// A bijection of 64 bits that leaves no visible structure: two rounds of multiply and xor-shift (the SplitMix64
/// finalizer of Steele, Lea and Flood 2014, with the constants of Stafford's variant 13).
pub fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lie_in_the_unit_interval_with_mean_and_correlation_as_independent_ones() {
        let stream = Stream::new(7, Purpose::Surface);
        let n = 100_000;
        let (mut sum, mut lag, mut across) = (0.0, 0.0, 0.0);
        for k in 0..n {
            let item = stream.item(k);
            let u = item.uniform(0);
            assert!((0.0..1.0).contains(&u));
            sum += u - 0.5;
            lag += (u - 0.5) * (stream.item(k + 1).uniform(0) - 0.5);
            across += (u - 0.5) * (item.uniform(1) - 0.5);
        }
        let sigma = (n as f64).sqrt();
        // Five standard deviations: the stream is fixed, so this cannot fail by chance once it passed.
        assert!(sum.abs() < 5.0 * sigma / 12f64.sqrt());
        assert!(lag.abs() < 5.0 * sigma / 12.0 && across.abs() < 5.0 * sigma / 12.0);
    }
}
