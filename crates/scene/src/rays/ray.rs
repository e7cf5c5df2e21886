//! A ray as the queries use it: scaled, and started in the scene's box.

use glam::DVec3;

pub(super) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    /// One over each component of the direction; infinite for one that is zero.
    pub inverse: DVec3,
    /// Way outside the scene's box that was left out.
    pub skipped: f64,
    /// Triangle of the mesh that the ray starts on.
    pub from: Option<u32>,
}

/// A ray as boxes see it, in float32.
pub(super) struct BoxRay {
    pub origin: [f32; 3],
    /// Infinite along an axis: times zero, for a ray in a plane across it, that is not a number. The tests of boxes
    /// pass over such a plane.
    pub inverse: [f32; 3],
    /// For each axis, which of a box's two planes across it is met first.
    pub first: [usize; 3],
}

impl Ray {
    /// Moves a ray that starts outside the box to where it enters; none if it misses the box.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3, from: Option<u32>, [low, high]: [DVec3; 2]) -> Option<Ray> {
        let inverse = 1.0 / direction;
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            // Along a component that is zero these are infinities, of one sign if the ray stays outside.
            let one = (low[axis] - origin[axis]) * inverse[axis];
            let two = (high[axis] - origin[axis]) * inverse[axis];
            enter = enter.max(one.min(two));
            leave = leave.min(one.max(two));
        }
        let origin = origin + direction * enter;
        // A ray that is no ray (direction 0, not a number) never leaves.
        let valid = enter <= leave && leave < f64::INFINITY && (origin + direction).is_finite();
        valid.then_some(Ray { origin, direction, inverse, skipped: enter, from })
    }

    #[inline(always)]
    pub fn for_boxes(&self) -> BoxRay {
        let inverse = self.inverse.as_vec3().to_array();
        BoxRay { origin: self.origin.as_vec3().to_array(), inverse, first: inverse.map(|x| usize::from(x < 0.0)) }
    }
}
