//! The environment of the milk: a sky that grows brighter to the horizon, with a low warm sun behind haze.

use glam::DVec3;

use crate::panorama;

/// Columns of the picture, and rows.
pub const SIZE: [usize; 2] = [128, 64];
const SUN: DVec3 = DVec3::new(-0.48, 0.6, -0.64);

/// The picture as a Radiance HDR file.
pub fn encode() -> Vec<u8> {
    panorama::flat(SIZE, radiance)
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
