//! Rays as the queries use them, scaled and started in the scene's box, and their hits.

use glam::DVec3;

/// The point where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// m along the unit direction.
    pub distance: f64,
    pub triangle: u32,
    /// Barycentric weights.
    pub weights: [f64; 3],
}

/// A ray in scaled units.
pub(super) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    /// The reciprocal of each component of the direction; infinite for a component of zero.
    pub inverse: DVec3,
    /// The distance outside the scene's box that was skipped.
    pub skipped: f64,
    /// Triangle of the mesh that the ray starts on.
    pub from: Option<u32>,
}

/// A ray in float32, for the tests of boxes.
pub(super) struct BoxRay {
    pub origin: [f32; 3],
    /// Reciprocals of the direction. For a ray that lies in a plane across an axis, infinity times zero is not a
    /// number: the tests of boxes ignore such a plane.
    pub inverse: [f32; 3],
    /// For each axis, which of a box's two planes across it the ray meets first.
    pub first: [usize; 3],
}

impl Ray {
    /// The ray, moved to where it enters the box `[low, high]`; none if it misses the box.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3, from: Option<u32>, [low, high]: [DVec3; 2]) -> Option<Ray> {
        let inverse = 1.0 / direction;
        let inside = origin.cmpge(low).all() && origin.cmple(high).all();
        // Most rays start inside: what follows must not wait for reciprocals then.
        let (skipped, origin) = if inside {
            (0.0, origin)
        } else {
            let skipped = entry(origin, inverse, [low, high])?;
            (skipped, origin + direction * skipped)
        };
        let valid =
            direction.abs().element_sum() >= f64::MIN_POSITIVE && (origin + direction).element_sum().is_finite();
        valid.then_some(Ray { origin, direction, inverse, skipped, from })
    }

    #[inline(always)]
    pub fn for_boxes(&self) -> BoxRay {
        let inverse = self.inverse.as_vec3().to_array();
        BoxRay { origin: self.origin.as_vec3().to_array(), inverse, first: inverse.map(|x| usize::from(x < 0.0)) }
    }
}

/// The distance at which a ray that starts outside the box `[low, high]` enters it; none if it misses the box.
#[inline(always)]
fn entry(origin: DVec3, inverse: DVec3, [low, high]: [DVec3; 2]) -> Option<f64> {
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        // For a component of zero these are infinite, of the same sign if the ray stays outside.
        let one = (low[axis] - origin[axis]) * inverse[axis];
        let two = (high[axis] - origin[axis]) * inverse[axis];
        enter = enter.max(one.min(two));
        leave = leave.min(one.max(two));
    }
    (enter <= leave && leave < f64::INFINITY).then_some(enter)
}
