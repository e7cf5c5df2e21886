//! The images of one call: of a camera, of a turntable about a vertical axis, or of a list of views; and a file for each.

use crate::{
    arguments::Arguments,
    settings::{Cameras, Chosen},
};
use cli::Failure;
use gather::Settings;
use glam::{DMat3, DVec3};
use scene::{Camera, View, ViewFile};
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// One image.
pub struct Shot {
    pub camera: Camera,
    pub settings: Settings,
    /// By how much an orbit has turned the camera.
    pub degrees: f64,
    /// What chose the camera.
    pub argument: String,
    /// What its files have before their ending; none if there is one image only.
    tag: Option<String>,
}

/// All images, the sizes of which `settings` gives.
pub fn shots(
    arguments: &Arguments,
    cameras: &Cameras,
    settings: impl Fn(&Chosen) -> Result<Settings, Failure>,
) -> Result<Vec<Shot>, Failure> {
    match cameras {
        Cameras::One(chosen) => {
            let (count, settings) = (arguments.orbit.unwrap_or(1), settings(chosen)?);
            let shot = |index: u32| {
                let degrees = 360.0 * f64::from(index) / f64::from(count);
                let camera = turned(&chosen.camera, chosen.target, degrees);
                let tag = arguments.orbit.map(|_| view_tag(None, index as usize));
                Shot { camera, settings: settings.clone(), degrees, argument: chosen.argument.clone(), tag }
            };
            Ok((0..count).map(shot).collect())
        }
        Cameras::List(list) => {
            let shot = |(index, (name, chosen)): (usize, &(Option<String>, Chosen))| {
                let tag = view_tag(name.as_deref(), index);
                let settings = settings(chosen).map_err(|e| e.within(place(&tag)))?;
                let (camera, argument) = (chosen.camera.clone(), chosen.argument.clone());
                Ok(Shot { camera, settings, degrees: 0.0, argument, tag: Some(tag) })
            };
            list.iter().enumerate().map(shot).collect()
        }
    }
}

/// The files of the images that `output` becomes, in their order.
pub fn image_paths(arguments: &Arguments, output: &Path) -> Result<Vec<PathBuf>, Failure> {
    let tags: Vec<String> = match (arguments.orbit, &arguments.view) {
        (Some(count), _) => (0..count as usize).map(|index| view_tag(None, index)).collect(),
        (None, Some(path)) => match View::read(path)? {
            ViewFile::One(_) => Vec::new(),
            ViewFile::List(views) => {
                views.iter().enumerate().map(|(index, (view, _))| view_tag(view.name.as_deref(), index)).collect()
            }
        },
        (None, None) => Vec::new(),
    };
    if tags.is_empty() {
        return Ok(vec![output.to_owned()]);
    }
    Ok(tags.iter().map(|tag| tagged(output, tag)).collect())
}

/// What the files of a view have before their ending: its name, or else its place in the list.
fn view_tag(name: Option<&str>, index: usize) -> String {
    name.map_or_else(|| format!("{index:04}"), str::to_owned)
}

/// Says once if images have other proportions than their cameras ask for.
pub fn warn_of_aspects(shots: &[Shot], arguments: &Arguments) {
    let aspects = |shot: &Shot| Some((shot.camera.aspect?, shot.settings.width as f64 / shot.settings.height as f64));
    let misfit = |(wanted, own): &(f64, f64)| (wanted / own - 1.0).abs() > 0.01;
    if let Some((wanted, own)) = shots.iter().filter_map(aspects).find(misfit) {
        arguments.common.warn(format_args!(
            "the camera's aspect is {wanted:.3}, the image's {own:.3}: its vertical field of view is kept"
        ));
    }
}

impl Shot {
    /// A failure of this image, which says which it is if there are several.
    pub fn failure(&self, failure: Failure) -> Failure {
        match &self.tag {
            Some(tag) => failure.within(place(tag)),
            None => failure,
        }
    }

    /// A line about this image, which says which it is if there are several.
    pub fn line(&self, line: &str) -> String {
        self.tag.as_ref().map_or_else(|| line.to_owned(), |tag| format!("{}: {line}", place(tag)))
    }

    /// `NAME.exr` as `NAME.0007.exr`.
    pub fn file(&self, path: &Path) -> PathBuf {
        self.tag.as_ref().map_or_else(|| path.to_owned(), |tag| tagged(path, tag))
    }
}

/// A camera turned about +Y through `target` (world, m), counter-clockwise seen from above.
fn turned(camera: &Camera, target: DVec3, degrees: f64) -> Camera {
    if degrees == 0.0 {
        return camera.clone(); // to the last digit
    }
    let turn = DMat3::from_rotation_y(degrees.to_radians());
    Camera {
        position: target + turn * (camera.position - target),
        right: turn * camera.right,
        up: turn * camera.up,
        forward: turn * camera.forward,
        ..camera.clone()
    }
}

fn place(tag: &str) -> String {
    format!("view {tag}")
}

fn tagged(path: &Path, tag: &str) -> PathBuf {
    let mut end = OsString::from(tag);
    if let Some(extension) = path.extension() {
        end.push(".");
        end.push(extension);
    }
    path.with_extension(end)
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
        let turned = super::turned(&camera, DVec3::new(1.0, 2.0, 2.0), 90.0);
        assert!(turned.position.distance(DVec3::new(6.0, 3.0, 2.0)) < 1e-12, "{}", turned.position);
        assert!(turned.forward.distance(DVec3::NEG_X) < 1e-12 && turned.right.distance(DVec3::NEG_Z) < 1e-12);
        assert!(turned.up.distance(DVec3::Y) < 1e-12);
        assert_eq!(super::turned(&camera, DVec3::splat(0.3), 0.0), camera);
    }

    #[test]
    fn files_are_numbered_before_their_ending() {
        assert_eq!(tagged(Path::new("a.b/turn.v2.exr"), "0007"), Path::new("a.b/turn.v2.0007.exr"));
        assert_eq!(tagged(Path::new("turn"), "front"), Path::new("turn.front"));
    }
}
