//! Random bits for each sample of each sum, at a few integer operations.

/// 32 random bits for one sample in one sum: two rounds of multiplications and xor-shifts, with the constants of
/// Wellons' search for 32-bit mixers of low bias, each keyed.
#[inline(always)]
pub fn random_bits(index: u32, key: u64) -> u32 {
    let mut x = index ^ key as u32;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x = (x ^ (x >> 16)).wrapping_add((key >> 32) as u32);
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}
