//! A turntable: the camera at equal steps around a vertical axis, and a file for each.

use crate::arguments::Arguments;
use glam::{DMat3, DVec3};
use scene::Camera;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// One image of as many as `--orbit` asks for, or of one.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    index: u32,
    /// None: there is no orbit, and files keep their names.
    count: Option<u32>,
}

/// The steps of the orbit, or the one image there is without.
pub fn steps(arguments: &Arguments) -> impl Iterator<Item = Step> + use<> {
    let count = arguments.orbit;
    (0..count.unwrap_or(1)).map(move |index| Step { index, count })
}

impl Step {
    /// By how much the camera is turned.
    pub fn degrees(self) -> f64 {
        360.0 * f64::from(self.index) / f64::from(self.count.unwrap_or(1))
    }

    /// The camera turned about +Y through `target` (world, m), counter-clockwise seen from above.
    pub fn turned(self, camera: &Camera, target: DVec3) -> Camera {
        if self.index == 0 {
            return camera.clone(); // to the last digit
        }
        let turn = DMat3::from_rotation_y(self.degrees().to_radians());
        Camera {
            position: target + turn * (camera.position - target),
            right: turn * camera.right,
            up: turn * camera.up,
            forward: turn * camera.forward,
            ..camera.clone()
        }
    }

    /// `NAME.exr` as `NAME.0007.exr`.
    pub fn file(self, path: &Path) -> PathBuf {
        if self.count.is_none() {
            return path.to_owned();
        }
        let mut end = OsString::from(format!("{:04}", self.index));
        if let Some(extension) = path.extension() {
            end.push(".");
            end.push(extension);
        }
        path.with_extension(end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Projection;

    /// A quarter of a turn, on paper. Seen to catch: a turn the other way, and about the origin.
    #[test]
    fn a_quarter_turn_goes_from_the_front_to_the_right() {
        let camera = Camera {
            name: "front".into(),
            node: "front".into(),
            position: DVec3::new(1.0, 3.0, 7.0),
            right: DVec3::X,
            up: DVec3::Y,
            forward: DVec3::NEG_Z,
            projection: Projection::Perspective { tangent: 0.2 },
            aspect: None,
        };
        let turned = Step { index: 1, count: Some(4) }.turned(&camera, DVec3::new(1.0, 2.0, 2.0));
        assert!(turned.position.distance(DVec3::new(6.0, 3.0, 2.0)) < 1e-12, "{}", turned.position);
        assert!(turned.forward.distance(DVec3::NEG_X) < 1e-12 && turned.right.distance(DVec3::NEG_Z) < 1e-12);
        assert!(turned.up.distance(DVec3::Y) < 1e-12);
        assert_eq!(Step { index: 0, count: Some(4) }.turned(&camera, DVec3::splat(0.3)), camera);
    }

    #[test]
    fn files_are_numbered_before_their_ending() {
        let step = Step { index: 7, count: Some(12) };
        assert_eq!(step.file(Path::new("a.b/turn.v2.exr")), Path::new("a.b/turn.v2.0007.exr"));
        assert_eq!(step.file(Path::new("turn")), Path::new("turn.0007"));
        assert_eq!(Step { index: 0, count: None }.file(Path::new("turn.exr")), Path::new("turn.exr"));
    }
}
