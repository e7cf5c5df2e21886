//! The shapes of a peach and of a slice of one, with the texture coordinates of their surfaces.
//!
//! In its own axes a fruit has its stem along +y and its crease along +z; mm.

use glam::{DMat3, DVec2, DVec3};

use crate::field::{Shape, smooth_max};
use crate::noise::step;

pub const RADIUS_MM: f64 = 33.0;
/// Width, height and depth of a fruit over its radius.
const STRETCH: DVec3 = DVec3::new(1.04, 0.94, 1.0);
/// The tangent of half the angle between the cuts of a slice.
pub const HALF_ANGLE: f64 = 0.62;
/// Half the axes of the stone, whose hollow the slice shows.
const STONE_MM: DVec3 = DVec3::new(8.5, 14.0, 8.5);
/// The extent of the picture of a slice: distance from the axis, and height to both sides.
pub const SLICE_MM: [f64; 2] = [36.0, 36.0];

/// A place and the axes of an object there, as columns.
#[derive(Clone, Copy)]
pub struct Pose {
    pub center: DVec3,
    pub axes: DMat3,
}

impl Pose {
    /// With y along `up`, and z as near to `front` as that allows.
    pub fn new(center: DVec3, up: DVec3, front: DVec3) -> Self {
        let y = up.normalize();
        let x = y.cross(front).normalize();
        Self { center, axes: DMat3::from_cols(x, y, x.cross(y)) }
    }

    /// A place of the scene in the axes of the object.
    pub fn inside(&self, p: DVec3) -> DVec3 {
        self.axes.transpose() * (p - self.center)
    }
}

/// The implicit function of a whole fruit.
pub fn whole(p: DVec3) -> f64 {
    let q = p / STRETCH;
    let length = q.length();
    let d = q / length.max(1e-9);
    // How far off the axis a direction is.
    let aside = (d.x * d.x + d.z * d.z).sqrt();
    let dimple = if d.y > 0.0 { 0.23 * bump(aside / 0.22) } else { 0.06 * bump(aside / 0.2) };
    // The crease fades out on the way around the lower end.
    let crease = 0.1 * bump(d.x / 0.13) * step(-0.15, 0.5, d.z) * step(-0.9, -0.1, d.y);
    length - RADIUS_MM * (1.0 - dimple - crease)
}

/// The implicit function of a slice, which is cut towards +z.
pub fn slice(p: DVec3) -> f64 {
    let side = |x: f64| (x - HALF_ANGLE * p.z) / (1.0 + HALF_ANGLE * HALF_ANGLE).sqrt();
    let cut = smooth_max(side(p.x), side(-p.x), 4.0);
    // The crease is on the other side.
    let away = DVec3::new(p.x, p.y, -p.z);
    let stone = Shape::Ellipsoid { center: DVec3::ZERO, radii: STONE_MM }.distance(p);
    smooth_max(smooth_max(whole(away), cut, 2.4), -stone, 3.0)
}

/// 1 in the middle, a quarter at 1, and flat far from there.
fn bump(x: f64) -> f64 {
    let y = 1.0 + x * x;
    1.0 / (y * y)
}

/// Texture coordinates of a direction: Lambert's equal-area projection about +z, which has no seam, and spreads only
/// the point at -z over the rim of a disc.
pub fn disc(direction: DVec3) -> DVec2 {
    let d = direction.normalize();
    let scale = (2.0 / (1.0 + d.z).max(1e-6)).sqrt();
    DVec2::new(0.5 + 0.25 * scale * d.x, 0.5 - 0.25 * scale * d.y)
}

/// The direction of texture coordinates; beyond the disc, that of its rim.
pub fn from_disc(uv: DVec2) -> DVec3 {
    let at = 4.0 * DVec2::new(uv.x - 0.5, 0.5 - uv.y);
    let squared = at.length_squared().min(4.0);
    let scale = (1.0 - 0.25 * squared).sqrt();
    DVec3::new(scale * at.x, scale * at.y, 1.0 - 0.5 * squared)
}

/// Texture coordinates of a place of a slice: its distance from the axis, and its height.
pub fn section(p: DVec3) -> DVec2 {
    let [out, up] = SLICE_MM;
    DVec2::new((p.x * p.x + p.z * p.z).sqrt() / out, 0.5 - 0.5 * p.y / up)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_disc_and_its_inverse_agree() {
        for k in 0..100 {
            let t = f64::from(k);
            let d = DVec3::new((3.0 * t).sin(), (1.7 * t).cos(), 0.4 + (0.9 * t).sin()).normalize();
            assert!(from_disc(disc(d)).distance(d) < 1e-6, "{d}");
        }
    }

    #[test]
    fn poses_are_rotations() {
        let pose = Pose::new(DVec3::ONE, DVec3::new(0.3, 1.0, 0.2), DVec3::new(-0.4, 0.1, 1.0));
        assert!((pose.axes.determinant() - 1.0).abs() < 1e-12);
        assert!((pose.inside(DVec3::ZERO).length() - 3f64.sqrt()).abs() < 1e-12);
    }
}
