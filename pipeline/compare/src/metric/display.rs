//! Display values: linear values at exposure 0, clamped to 0..1, encoded by the curve of sRGB (IEC 61966-2-1).

use super::elementary::power;
use color::srgb::{GAMMA, LINE_END, LINE_SLOPE, OFFSET, SCALE};

/// The display value of a finite linear value.
#[inline(always)]
pub(super) fn display(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    let line = LINE_SLOPE as f32 * x;
    let curve = SCALE as f32 * power(x, 1.0 / GAMMA as f32) - OFFSET as f32;
    if x <= LINE_END as f32 { line } else { curve }
}

#[cfg(test)]
mod tests {
    use super::display;

    #[test]
    fn known_values() {
        for (linear, shown) in [(-1.0, 0.0), (0.0, 0.0), (0.001, 0.012_92), (0.5, 0.735_357), (1.0, 1.0), (9.0, 1.0)] {
            assert!((display(linear) - shown).abs() < 3e-7, "{linear}");
        }
    }
}
