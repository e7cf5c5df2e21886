//! Deterministic mutations of a file.
//!
//! Two of three mutations of a .glb change one chunk and adjust its length: a wrong length is refused before anything
//! else is read.

use test_support::{
    Random,
    glb::{chunks, container},
};

/// Numbers that replace lengths, counts and offsets.
const LENGTHS: [u64; 14] = [
    0,
    1,
    2,
    16,
    0xff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    1 << 32,
    1 << 60,
    i64::MAX as u64,
    i64::MIN as u64,
    u64::MAX,
];

/// Texts that replace numbers.
const TEXTS: [&str; 26] = [
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "7",
    "-1",
    "65535",
    "5121",
    "5125",
    "5126",
    "2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "-0.0",
    "0.5",
    "1e-45",
    "1e39",
    "1e300",
    "-1e300",
    "1e-300",
    "null",
    "[]",
    "\"1\"",
];

/// Values that replace bytes.
const BYTES: [u8; 9] = [0, 1, 0x7f, 0x80, 0xff, b'0', b'9', b'-', b'{'];

/// Mutation `number` of a file.
pub fn mutate(file: &[u8], number: u64) -> Vec<u8> {
    let mut random = Random(number << 32);
    match chunks(file)[..] {
        [text, binary] if random.below(3) > 0 => {
            let (mut text, mut binary) = (text.to_vec(), binary.to_vec());
            let part = if random.below(4) == 0 { &mut binary } else { &mut text };
            *part = damage(part, number, &mut random);
            container(&[(b"JSON", &text), (b"BIN\0", &binary)])
        }
        _ => damage(file, number, &mut random),
    }
}

fn damage(bytes: &[u8], kind: u64, random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if bytes.is_empty() {
        return vec![random.pick(&BYTES)];
    }
    match kind % 6 {
        0 => flip(&mut bytes, random),
        1 => bytes.truncate(random.below(bytes.len())),
        2 => overwrite_length(&mut bytes, random),
        3 => splice(&mut bytes, random),
        _ => (0..=random.below(3)).for_each(|_| replace_number(&mut bytes, random)),
    }
    bytes
}

fn flip(bytes: &mut [u8], random: &mut Random) {
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        bytes[at] = match random.below(3) {
            0 => bytes[at] ^ 1 << random.below(8),
            _ => random.pick(&BYTES),
        };
    }
}

/// Replaces two, four or eight bytes by another number.
fn overwrite_length(bytes: &mut [u8], random: &mut Random) {
    let size = random.pick(&[2, 4, 8]).min(bytes.len());
    let at = random.below(bytes.len() - size + 1) & !(random.pick(&[0, 1, 3, 7]));
    let near = bytes.len() as u64 + random.below(3) as u64 - 1;
    let number = if random.below(4) == 0 { near } else { random.pick(&LENGTHS) };
    bytes[at..at + size].copy_from_slice(&number.to_le_bytes()[..size]);
}

/// Replaces a part of the file by a copy of another part, of any length.
fn splice(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut range = || {
        let start = random.below(bytes.len());
        start..start + random.below((bytes.len() - start).min(256))
    };
    let (from, to) = (range(), range());
    let copy = bytes[from].to_vec();
    bytes.splice(to, copy);
}

/// Replaces a run of digits by another number; bytes without one are flipped.
fn replace_number(bytes: &mut Vec<u8>, random: &mut Random) {
    let is_part = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let from = random.below(bytes.len());
    let Some(start) = bytes[from..].iter().position(u8::is_ascii_digit).map(|k| from + k) else {
        return flip(bytes, random);
    };
    let end = bytes[start..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |k| start + k);
    bytes.splice(start..end, random.pick(&TEXTS).bytes());
}
