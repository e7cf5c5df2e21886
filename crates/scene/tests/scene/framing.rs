//! Cameras that are made for scenes without one.

use glam::{DMat3, DVec2};
use scene::{
    Camera, DVec3, Framing, Placed, Projection, Scene, ViewFile,
    light::{DirectionalLight, Light},
};
use serde_json::json;
use std::f64::consts::TAU;
use test_support::{Bench, glb::tetrahedron};

/// The tetrahedron, twice as wide as high, and a kilometre away.
fn scene() -> Scene {
    let mut asset = tetrahedron();
    let matrix = [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1000, 20, -30, 1];
    asset.set("/nodes/0/matrix", json!(matrix));
    asset.import().expect("a good file")
}

/// The extent of the scene's points in an image of this camera, as shares of its width and height: the smallest and
/// largest coordinates.
fn seen(scene: &Scene, camera: &Camera, aspect: f64, turned: f64, about: DVec3) -> [DVec2; 2] {
    let Projection::Perspective { tangent } = camera.projection else { panic!("a perspective") };
    let turn = DMat3::from_rotation_y(turned);
    let at = |p: DVec3| {
        let p = about + turn * (p + scene.origin - about) - camera.position;
        let ahead = p.dot(camera.forward) * tangent;
        0.5 * DVec2::new(p.dot(camera.right) / (ahead * aspect), p.dot(camera.up) / ahead)
    };
    let points = scene.mesh.positions.iter().map(|p| at(p.as_dvec3()));
    points.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

/// Seen to fail when the box was framed instead of what is in it, and when the wide image was framed by its width.
#[test]
fn surfaces_fill_the_height_or_the_width() {
    let scene = scene();
    let framing = Framing::new(&scene, |_| true);
    for placed in Placed::ALL {
        for (aspect, filled, axis) in [(4.0, 0.8, 1), (0.5, 0.9, 0)] {
            let (_, camera) = framing.view(placed, aspect, false).expect("a camera");
            let [low, high] = seen(&scene, &camera, aspect, 0.0, DVec3::ZERO);
            assert!(((high - low)[axis] - filled).abs() < 1e-3, "{placed:?} {aspect}: {low} {high}");
            assert!((low + high).abs().max_element() < 0.1 && (high - low).max_element() < 0.91, "{low} {high}");
        }
    }
    assert!(Framing::new(&scene, |_| false).view(Placed::Front, 1.0, false).is_none());
}

/// The target is on the axis through the middle, and no turn leaves the image. Seen to fail when the first view alone
/// was framed.
#[test]
fn an_orbit_keeps_the_surfaces_in_the_image() {
    let scene = scene();
    let framing = Framing::new(&scene, |_| true);
    let (view, camera) = framing.view(Placed::Front, 1.0, true).expect("a camera");
    let target = DVec3::from_array(view.target);
    assert!(((target - framing.middle()) * DVec3::new(1.0, 0.0, 1.0)).length() < 1e-3, "{target}");
    let turns = (0..24).map(|k| seen(&scene, &camera, 1.0, TAU * f64::from(k) / 24.0, target));
    let farthest = turns.flatten().fold(DVec2::ZERO, |most, p| most.max(p.abs()));
    assert!(farthest.x < 0.46 && farthest.y < 0.41 && farthest.max_element() > 0.38, "{farthest}");
}

/// The light is behind the surfaces, and from the front they are seen from +Z.
#[test]
fn backlit_is_opposite_of_the_light() {
    let mut scene = scene();
    let backwards =
        |scene: &Scene, placed| Framing::new(scene, |_| true).view(placed, 1.0, false).expect("one").1.forward;
    assert!(backwards(&scene, Placed::Front).z < -0.8);
    for azimuth in [0.3f64, 2.0, 4.5] {
        let direction = DVec3::new(azimuth.sin(), 0.5, azimuth.cos()).normalize();
        let sun = DirectionalLight { direction, irradiance: DVec3::ONE };
        scene.file_lights = vec![Box::new(sun) as Box<dyn Light>];
        let forward = backwards(&scene, Placed::Backlit);
        assert!(DVec2::new(forward.x, forward.z).normalize().dot(DVec2::new(azimuth.sin(), azimuth.cos())) > 0.999);
    }
}

/// What is said of a camera is a view file of it.
#[test]
fn a_view_is_the_text_of_its_file() {
    let scene = scene();
    let (view, camera) = Framing::new(&scene, |_| true).view(Placed::Backlit, 1.5, false).expect("a camera");
    let bench = Bench::new();
    let path = bench.write("backlit.json", view.json());
    let Ok(ViewFile::One(read)) = scene::View::read(&path) else { panic!("{}", view.json()) };
    assert_eq!((read.1, read.0.json()), (camera, view.json()));
}
