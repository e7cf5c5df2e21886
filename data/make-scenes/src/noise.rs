//! Random numbers on a lattice, which integers decide alone, and smooth noise between them.

use glam::DVec3;

/// A number from 0 to 1 for each point of the lattice and each seed.
pub fn at_lattice([x, y, z]: [i64; 3], seed: u32) -> f64 {
    let mixed = [x, y, z].iter().fold(scrambled(seed), |hash, &k| scrambled(hash ^ scrambled(k as u32)));
    f64::from(mixed) / f64::from(u32::MAX)
}

/// A bijection of 32 bits by products with odd numbers and shifts.
fn scrambled(bits: u32) -> u32 {
    let once = (bits.wrapping_add(0x9E37_79B9) ^ (bits >> 16)).wrapping_mul(0x21F0_AAAD);
    let twice = (once ^ (once >> 15)).wrapping_mul(0x735A_2D97);
    twice ^ (twice >> 15)
}

/// Smooth noise from 0 to 1, whose lattice has a spacing of 1 and repeats after this many points along each axis.
pub fn repeating(p: DVec3, period: [i64; 3], seed: u32) -> f64 {
    let floor = p.floor();
    let [x, y, z] = (p - floor).to_array().map(|t| t * t * (3.0 - 2.0 * t));
    let corner = |dx: i64, dy: i64, dz: i64| {
        let at = [floor.x as i64 + dx, floor.y as i64 + dy, floor.z as i64 + dz];
        at_lattice([0, 1, 2].map(|k| at[k].rem_euclid(period[k])), seed)
    };
    let mix = |a: f64, b: f64, t: f64| a + t * (b - a);
    let row = |dy: i64, dz: i64| mix(corner(0, dy, dz), corner(1, dy, dz), x);
    let layer = |dz: i64| mix(row(0, dz), row(1, dz), y);
    mix(layer(0), layer(1), z)
}

/// Smooth noise from 0 to 1 that does not repeat within any scene.
pub fn smooth(p: DVec3, seed: u32) -> f64 {
    repeating(p, [1 << 30; 3], seed)
}

/// Noise of four scales, each half as large and half as strong as the one before.
pub fn layered(p: DVec3, seed: u32) -> f64 {
    let layer = |k: u32| smooth(f64::from(1 << k) * p, seed + k) / f64::from(2 << k);
    (0..4).map(layer).sum::<f64>() / 0.9375
}

/// 0 below `low`, 1 above `high`, and a smooth step between.
pub fn step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fill_the_unit_interval_evenly() {
        let count = 20_000;
        let all = (0..count).map(|k| at_lattice([k % 100, k / 100, -k], 7));
        let (sum, squares) = all.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
        let n = count as f64;
        // Six standard deviations of both means: a false alarm in 10^8.
        assert!((sum / n - 0.5).abs() < 6.0 * (1.0 / 12.0 / n).sqrt(), "{}", sum / n);
        assert!((squares / n - 1.0 / 3.0).abs() < 6.0 * (4.0 / 45.0 / n).sqrt(), "{}", squares / n);
    }

    #[test]
    fn noise_repeats_and_has_no_jumps() {
        let period = [5, 3, 4];
        for k in 0..200 {
            let p = DVec3::new(0.13, -0.21, 0.07) * f64::from(k);
            let noise = repeating(p, period, 3);
            assert!((noise - repeating(p + DVec3::new(5.0, -3.0, 8.0), period, 3)).abs() < 1e-9);
            assert!((noise - repeating(p + DVec3::splat(1e-6), period, 3)).abs() < 1e-5);
        }
    }
}
