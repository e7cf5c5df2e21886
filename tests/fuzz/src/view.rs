//! View files.

use crate::file::with_file;
use scene::{Camera, Projection, View};

/// An accepted view is a camera whose rays have directions.
pub fn view(bytes: &[u8]) -> bool {
    let Ok((view, camera)) = with_file("view.json", bytes, View::read) else { return false };
    assert!(camera.aspect.is_none_or(|a| a > 0.0 && a.is_finite()), "{:?} {:?}", view.width, view.height);
    check_camera(&camera);
    true
}

/// Pixels of the image that rays are sent through.
const SIZE: [f64; 2] = [8.0, 6.0];

/// Every ray starts somewhere and goes along a unit vector.
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
