//! Smooth shapes as implicit functions of position, negative inside, which approximate the signed distance near the
//! surface.

use glam::DVec3;

/// A shape. Lengths are in the unit of the caller.
#[derive(Clone, Copy)]
pub enum Shape {
    Ellipsoid {
        center: DVec3,
        radii: DVec3,
    },
    /// A capsule with a radius of its own at each end.
    Limb {
        ends: [DVec3; 2],
        radii: [f64; 2],
    },
    /// The half-space below this height.
    Below {
        height: f64,
    },
}

impl Shape {
    pub fn distance(&self, p: DVec3) -> f64 {
        match *self {
            Self::Ellipsoid { center, radii } => ellipsoid(p - center, radii),
            Self::Limb { ends: [from, to], radii: [from_radius, to_radius] } => {
                let axis = to - from;
                let along = ((p - from).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
                p.distance(from + along * axis) - (from_radius + along * (to_radius - from_radius))
            }
            Self::Below { height } => p.y - height,
        }
    }
}

/// The implicit function divided by the length of its gradient: the distance to first order at the surface.
fn ellipsoid(p: DVec3, radii: DVec3) -> f64 {
    let unit = (p / radii).length();
    let slope = (p / (radii * radii)).length();
    // At the center both are zero; the depth there is the smallest radius.
    if slope == 0.0 { -radii.min_element() } else { unit * (unit - 1.0) / slope }
}

/// The minimum of both, with a fillet where they differ by less than `blend`.
pub fn smooth_min(a: f64, b: f64, blend: f64) -> f64 {
    let overlap = (blend - (a - b).abs()).max(0.0) / blend;
    a.min(b) - overlap * overlap * overlap * blend / 6.0
}

pub fn smooth_max(a: f64, b: f64, blend: f64) -> f64 {
    -smooth_min(-a, -b, blend)
}

/// The gradient by central differences; `step` is in the unit of `p`.
pub fn gradient(field: &impl Fn(DVec3) -> f64, p: DVec3, step: f64) -> DVec3 {
    let slope = |axis: DVec3| (field(p + step * axis) - field(p - step * axis)) / (2.0 * step);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_zero_on_their_surface_and_negative_inside() {
        let radii = DVec3::new(1.0, 2.0, 3.0);
        let ellipsoid = Shape::Ellipsoid { center: DVec3::ONE, radii };
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            assert!(ellipsoid.distance(DVec3::ONE + radii * axis).abs() < 1e-12);
        }
        assert!(ellipsoid.distance(DVec3::ONE) < 0.0);
        let limb = Shape::Limb { ends: [DVec3::ZERO, DVec3::X], radii: [0.5, 0.25] };
        assert!(limb.distance(DVec3::new(1.25, 0.0, 0.0)).abs() < 1e-12);
        assert!(limb.distance(DVec3::new(0.0, 0.4, 0.0)) < 0.0);
    }

    #[test]
    fn smooth_min_only_differs_within_the_blend() {
        assert_eq!(smooth_min(1.0, 4.0, 2.0), 1.0);
        assert!(smooth_min(1.0, 1.0, 2.0) < 1.0);
    }
}
