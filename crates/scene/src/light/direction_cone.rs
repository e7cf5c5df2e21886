//! Sets of directions: all unit vectors within an angle of an axis.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// The unit vectors within `half_angle` of `axis`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionCone {
    /// Unit vector.
    pub axis: DVec3,
    /// Half of the opening angle, rad, 0 to π.
    pub half_angle: f64,
}

impl DirectionCone {
    /// All directions.
    pub const SPHERE: DirectionCone = DirectionCone { axis: DVec3::Z, half_angle: PI };

    /// The narrowest cone about an axis that holds some unit vectors.
    pub fn around(axis: DVec3, vectors: &[DVec3]) -> DirectionCone {
        let half_angle = vectors.iter().map(|v| axis.angle_between(*v)).fold(0.0, f64::max);
        DirectionCone { axis, half_angle }
    }

    /// A cone that holds both.
    pub fn join(self, other: DirectionCone) -> DirectionCone {
        let (wide, narrow) = if self.half_angle >= other.half_angle { (self, other) } else { (other, self) };
        let between = wide.axis.angle_between(narrow.axis);
        if between + narrow.half_angle <= wide.half_angle {
            return wide;
        }
        let half_angle = 0.5 * (wide.half_angle + between + narrow.half_angle);
        let across = (narrow.axis - wide.axis * narrow.axis.dot(wide.axis)).try_normalize();
        // Opposite axes have no direction from one to the other.
        let Some(across) = across.filter(|_| half_angle < PI) else {
            return DirectionCone { half_angle: PI, ..wide };
        };
        let (sine, cosine) = (half_angle - wide.half_angle).sin_cos();
        DirectionCone { axis: (wide.axis * cosine + across * sine).normalize(), half_angle }
    }

    /// An upper bound of the cosine between a vector of this cone and one of the other, 0 if they are all perpendicular
    /// or farther apart.
    pub fn max_cosine(&self, other: &DirectionCone) -> f64 {
        let between = self.axis.angle_between(other.axis);
        // Rounding must not hide what lies on the horizon.
        let min_angle = between - self.half_angle - other.half_angle - 1e-6;
        if min_angle < FRAC_PI_2 { min_angle.max(0.0).cos() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Item, Purpose, Stream};

    fn direction(item: Item, first: u64) -> DVec3 {
        let at = |k| 2.0 * item.uniform(first + k) - 1.0;
        DVec3::new(at(0), at(1), at(2)).normalize()
    }

    /// Seen to catch: the wider cone returned when the other sticks out; half of the sum of the angles alone.
    #[test]
    fn joined_cones_hold_both() {
        let stream = Stream::new(5, Purpose::Surface);
        for k in 0..20_000 {
            let item = stream.item(k);
            let cone = |d: u64| {
                let half_angle = PI * item.uniform(d + 3).powi(2);
                DirectionCone { axis: direction(item, d), half_angle }
            };
            let [a, b] = [0, 4].map(cone);
            let joined = a.join(b);
            for own in [a, b] {
                let outermost = (joined.axis.angle_between(own.axis) + own.half_angle).min(PI);
                assert!(outermost <= joined.half_angle + 1e-6, "{a:?} {b:?} {joined:?}");
            }
        }
        let [a, b] = [DVec3::X, DVec3::NEG_X].map(|axis| DirectionCone { axis, half_angle: 0.1 });
        assert_eq!(a.join(b).half_angle, PI);
    }

    /// The largest cosine is an upper bound, and a close one. Seen to catch: angles added with the wrong sign.
    #[test]
    fn cosines_are_bounded_from_above() {
        let stream = Stream::new(4, Purpose::Surface);
        let within = |cone: DirectionCone, d: DVec3, xi: f64| {
            let across = (d - cone.axis * d.dot(cone.axis)).normalize();
            let (sine, cosine) = (cone.half_angle * xi).sin_cos();
            cone.axis * cosine + across * sine
        };
        for k in 0..20_000 {
            let item = stream.item(k);
            let cone =
                |d: u64| DirectionCone { axis: direction(item, 10 * d), half_angle: 0.3 * item.uniform(10 * d + 3) };
            let [one, two] = [0, 1].map(cone);
            let vector = |cone, d: u64| within(cone, direction(item, d), item.uniform(d + 3));
            let (n, w) = (vector(one, 20), vector(two, 30));
            let max = one.max_cosine(&two);
            assert!(n.dot(w) <= max + 1e-12, "{} {max}", n.dot(w));
            assert!(max <= one.axis.dot(two.axis).max(0.0) + one.half_angle + two.half_angle + 1e-5);
        }
    }
}
