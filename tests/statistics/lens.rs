//! What the lens of a camera blurs is as wide as its circle of confusion, and as bright in all as without a lens.

use gather::{Filter, Settings, film::Pixel};
use glam::{DVec2, DVec3};
use scene::{Camera, Lens, Projection};
use test_support::{
    meshes::{Mesh, Part, World, world},
    pipeline::{MODELS, input, orthographic, settings},
};

/// Pixels of a side, and the tangent of half the field of view.
const SIDE: usize = 33;
const TANGENT: f64 = 0.05;

/// Distance of the lamp from the camera, and its side, m.
const DEPTH: f64 = 2.0;
const LAMP: f64 = 0.02;

/// A square lamp on the line of sight.
fn lamp() -> World {
    let corner = |x: f64, y: f64| (DVec3::new(x, y, 0.0) * 0.5 * LAMP).as_vec3();
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] };
    world(&[Part { emission: DVec3::ONE, ..Part::opaque(mesh) }], &[], DVec3::ZERO)
}

/// The light of the image in all, in pixels of radiance 1, and its mean square distance from the middle, pixels².
fn light(world: &World, lens: Option<Lens>, filter: Filter) -> [f64; 2] {
    let projection = Projection::Perspective { tangent: TANGENT };
    let camera = Camera { position: DVec3::Z * DEPTH, projection, lens, ..orthographic(DVec3::Z, 1.0) };
    let settings = Settings { paths_per_pixel: 2048, filter, ..settings(MODELS[0], SIDE, SIDE) };
    let pixels = gather::render(&input(world, &[], &[], &camera), &settings, |_| ()).pixels;
    let sum = |f: &dyn Fn(DVec2) -> f64| -> f64 {
        let place = |k: usize| DVec2::new((k % SIDE) as f64, (k / SIDE) as f64) - DVec2::splat(0.5 * (SIDE - 1) as f64);
        pixels.iter().enumerate().map(|(k, p): (usize, &Pixel)| p.beauty().x * f(place(k))).sum()
    };
    let all = sum(&|_| 1.0);
    [all, sum(&|place| place.length_squared()) / all]
}

/// A point of the lamp becomes a disc of the radius `R |z − F|/(z F)`, as a slope, and the mean square of a disc is half
/// of that of its radius. The lens sees the lamp at other angles than the camera's place, which is less than 0.1 % here.
///
/// Seen to catch: the random numbers of the pixel used for the lens again, its order used for the lens too, the same place on
/// the lens for all paths.
#[test]
fn a_lamp_out_of_focus_is_a_disc() {
    let world = lamp();
    let pixels = 0.5 * SIDE as f64 / TANGENT;
    let own = (LAMP / DEPTH * pixels).powi(2);
    for (focus, radius, filter) in
        [(1.0, 0.03, Filter::Box), (4.0, 0.05, Filter::Box), (4.0, 0.05, Filter::Point), (1.9, 0.05, Filter::Box)]
    {
        let [all, spread] = light(&world, Some(Lens { radius, focus }), filter);
        let disc = radius * (DEPTH - focus).abs() / (DEPTH * focus) * pixels;
        let expected = 0.5 * disc * disc + own / 6.0;
        println!("focus {focus}: light {:.4}, spread {:.4} of {expected:.3}", all / own, spread / expected);
        assert!((all / own - 1.0).abs() < 0.02, "focus {focus}: {all} of {own}");
        // A pixel adds up to 1/6 to the mean square.
        assert!((spread - expected).abs() < 0.02 * expected + 0.17, "focus {focus}: {spread} of {expected}");
    }
}

#[test]
fn a_lamp_in_focus_is_as_without_a_lens() {
    let world = lamp();
    let [sharp, blurred] =
        [None, Some(Lens { radius: 0.05, focus: DEPTH })].map(|lens| light(&world, lens, Filter::Box));
    assert!((sharp[0] / blurred[0] - 1.0).abs() < 5e-3 && (sharp[1] / blurred[1] - 1.0).abs() < 5e-3);
}
