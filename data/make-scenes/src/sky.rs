//! The environment of the milk: a sky that grows brighter to the horizon, with a low warm sun behind haze.

use glam::DVec3;

use crate::turned::circle;

/// Columns of the picture, and rows.
pub const SIZE: [usize; 2] = [128, 64];
const SUN: DVec3 = DVec3::new(-0.48, 0.6, -0.64);

/// The picture as a Radiance HDR file of the kind that `--environment` takes: its middle towards +X, columns on to the
/// right towards +Z, top row +Y. Scanlines are not compressed.
pub fn encode() -> Vec<u8> {
    let [width, height] = SIZE;
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for row in 0..height {
        for column in 0..width {
            bytes.extend(rgbe(radiance(direction(column, row))));
        }
    }
    bytes
}

/// Unit direction through the middle of a pixel. Both angles are taken from the same table of a circle.
fn direction(column: usize, row: usize) -> DVec3 {
    let fine = fine_circle();
    // The table has four steps for a column: a column's middle is two on, and a row is as wide as a column.
    let azimuth = fine[(4 * column + 2 + fine.len() / 2) % fine.len()];
    let elevation = fine[(fine.len() / 4 + fine.len() - (4 * row + 2)) % fine.len()];
    DVec3::new(elevation.x * azimuth.x, elevation.y, elevation.x * azimuth.y)
}

fn fine_circle() -> Vec<glam::DVec2> {
    let mut around = circle();
    while around.len() < 4 * SIZE[0] {
        let next = |k: usize| around[(k + 1) % around.len()];
        around = (0..around.len()).flat_map(|k| [around[k], (around[k] + next(k)).normalize()]).collect();
    }
    around
}

/// Radiance from a unit direction, W/(m² sr).
fn radiance(towards: DVec3) -> DVec3 {
    let height = towards.y;
    if height < 0.0 {
        return DVec3::ZERO; // below the horizon is the table
    }
    let zenith = DVec3::new(0.16, 0.3, 0.62);
    let horizon = DVec3::new(0.9, 0.82, 0.72);
    let sky = horizon.lerp(zenith, 1.0 - (1.0 - height) * (1.0 - height));
    // Lobes of the haze: 1 towards the sun, falling off over their width.
    let away = 1.0 - towards.dot(SUN.normalize());
    let lobe = |width: f64| {
        let x = away / width;
        1.0 / ((1.0 + x) * (1.0 + x) * (1.0 + x))
    };
    sky + 14.0 * lobe(0.03) * DVec3::new(1.0, 0.86, 0.66) + 1.8 * lobe(0.2) * DVec3::new(1.0, 0.8, 0.6)
}

/// A pixel in RGBE: three mantissas of eight bits and their common exponent.
fn rgbe(color: DVec3) -> [u8; 4] {
    let (mut scale, mut exponent) = (1.0, 0i32);
    while color.max_element() * scale >= 1.0 {
        (scale, exponent) = (0.5 * scale, exponent + 1);
    }
    while color.max_element() * scale < 0.5 && exponent > -127 {
        (scale, exponent) = (2.0 * scale, exponent - 1);
    }
    let [r, g, b] = (color * scale * 256.0).to_array().map(|x| x as u8);
    [r, g, b, (exponent + 128) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_towards_x_and_the_top_is_up() {
        let [width, height] = SIZE;
        assert!(direction(width / 2, height / 2).distance(DVec3::X) < 0.05);
        assert!(direction(3 * width / 4, height / 2).distance(DVec3::Z) < 0.05);
        assert!(direction(5, 0).distance(DVec3::Y) < 0.05);
    }

    #[test]
    fn colors_are_kept_to_a_part_in_128() {
        let color = DVec3::new(3.0, 0.75, 1.5);
        let [r, g, b, e] = rgbe(color);
        let scale = (f64::from(e) - 136.0).exp2();
        assert!((DVec3::new(r.into(), g.into(), b.into()) * scale).distance(color) < 3.0 / 128.0);
    }
}
