//! View files.

use crate::file::with_file;
use scene::{Camera, Projection, View, ViewFile};
use std::collections::HashSet;

/// The rays of an accepted view have directions; names of the views of a list can be parts of file names.
pub fn view(bytes: &[u8]) -> bool {
    let Ok(file) = with_file("view.json", bytes, View::read) else { return false };
    match file {
        ViewFile::One(one) => check_view(&one.0, &one.1),
        ViewFile::List(views) => {
            assert!(!views.is_empty());
            views.iter().for_each(|(view, camera)| check_view(view, camera));
            check_names(views.iter().filter_map(|(view, _)| view.name.as_deref()));
        }
    }
    true
}

fn check_view(view: &View, camera: &Camera) {
    assert!(camera.aspect.is_none_or(|a| a > 0.0 && a.is_finite()), "{:?} {:?}", view.width, view.height);
    check_camera(camera);
}

fn check_names<'a>(names: impl Iterator<Item = &'a str>) {
    let mut seen = HashSet::new();
    for name in names {
        assert!(seen.insert(name), "{name} twice");
        assert!(!name.is_empty() && name.len() < 200 && !name.contains(['/', '\\', '\0']), "{name:?}");
    }
}

/// Resolution of the rays that are tested, pixels.
const SIZE: [f64; 2] = [8.0, 6.0];

/// Every ray has a finite origin and a unit direction.
pub fn check_camera(camera: &Camera) {
    assert!(camera.position.is_finite());
    let (Projection::Perspective { tangent: extent } | Projection::Orthographic { half_height: extent }) =
        camera.projection;
    assert!(extent > 0.0 && extent.is_finite(), "{extent}");
    let axes = [camera.right, camera.up, camera.forward];
    assert!(axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-9), "{axes:?}");
    for point in [[0.0, 0.0], [3.0, 3.0], SIZE] {
        let (origin, direction) = camera.ray(point.into(), SIZE.into());
        assert!(origin.is_finite() && (direction.length() - 1.0).abs() < 1e-9, "{origin} {direction}");
    }
}
