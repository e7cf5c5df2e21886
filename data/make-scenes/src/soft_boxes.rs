//! The light of a studio, for scenes that have none: a large soft key from the front left and above, a strip from behind
//! as a rim, a weak fill from the right, and a dark backdrop around the horizon, before which a silhouette shows.
//!
//! The front is +Z, as glTF has it. A camera that looks down a little from the front right sees the backdrop alone, and
//! so does one from the other side, for which the key is behind the object.

use glam::DVec3;

use crate::panorama;

/// Columns of the picture, and rows.
pub const SIZE: [usize; 2] = [256, 128];

/// The picture as a Radiance HDR file.
pub fn encode() -> Vec<u8> {
    panorama::compressed(SIZE, radiance)
}

/// A rectangle of light far away.
struct SoftBox {
    /// The direction towards its middle.
    middle: DVec3,
    /// Half of its width and height, at a distance of 1.
    half: [f64; 2],
    radiance: DVec3,
}

const BOXES: [SoftBox; 3] = [
    SoftBox { middle: DVec3::new(-0.27, 0.62, 0.74), half: [0.42, 0.36], radiance: DVec3::new(4.4, 4.2, 3.9) },
    SoftBox { middle: DVec3::new(-0.79, 0.58, -0.21), half: [0.2, 0.34], radiance: DVec3::new(4.2, 4.5, 5.0) },
    SoftBox { middle: DVec3::new(0.82, 0.57, 0.09), half: [0.45, 0.3], radiance: DVec3::new(0.34, 0.36, 0.4) },
];

/// The backdrop, and the ceiling straight above.
const BACKDROP: DVec3 = DVec3::new(0.05, 0.053, 0.06);
const CEILING: DVec3 = DVec3::new(0.16, 0.165, 0.175);
/// The floor straight below, which lights from beneath as the backdrop does.
const FLOOR: DVec3 = DVec3::new(0.05, 0.05, 0.05);
/// The heights of unit directions between which the backdrop becomes the ceiling.
const BEND: [f64; 2] = [0.16, 0.7];

/// Width of a box's edge over its half width.
const EDGE: f64 = 0.2;

/// Radiance from a unit direction, W/(m² sr).
fn radiance(towards: DVec3) -> DVec3 {
    let above = BACKDROP.lerp(CEILING, smooth((towards.y - BEND[0]) / (BEND[1] - BEND[0])));
    let room = if towards.y < 0.0 { BACKDROP.lerp(FLOOR, smooth(-towards.y)) } else { above };
    BOXES.iter().fold(room, |seen, soft_box| {
        let (share, radiance) = (soft_box.share(towards), soft_box.radiance);
        seen.lerp(radiance, share)
    })
}

impl SoftBox {
    /// 1 in the box and 0 outside, with a soft edge.
    fn share(&self, towards: DVec3) -> f64 {
        let axis = self.middle.normalize();
        let right = DVec3::Y.cross(axis).normalize();
        let ahead = towards.dot(axis);
        if ahead <= 0.0 {
            return 0.0;
        }
        let at = [towards.dot(right) / ahead, towards.dot(axis.cross(right)) / ahead];
        let within = |k: usize| smooth((self.half[k] - at[k].abs()) / (EDGE * self.half[k]) + 0.5);
        within(0) * within(1)
    }
}

/// A smooth step from 0 to 1.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the cameras see that are made for a scene without one: those from 15 degrees above, with 40 degrees.
    #[test]
    fn cameras_around_the_object_see_the_backdrop_alone() {
        for k in 0..64 {
            let azimuth = f64::from(k) * 0.1;
            for height in [-0.55, -0.2, 0.0, 0.08] {
                let radius = f64::sqrt(1.0 - height * height);
                let seen = radiance(DVec3::new(radius * azimuth.cos(), height, radius * azimuth.sin()));
                assert!(seen.max_element() < 0.07, "{azimuth} {height}: {seen}");
            }
        }
    }

    #[test]
    fn the_key_is_in_front_and_the_picture_is_small() {
        let middle = |k: usize| radiance(BOXES[k].middle.normalize());
        assert!(BOXES[0].middle.z > 0.0 && BOXES[1].middle.z < 0.0);
        assert!((0..3).all(|k| middle(k).distance(BOXES[k].radiance) < 1e-12));
        assert!(encode().len() < 40_000);
    }
}
