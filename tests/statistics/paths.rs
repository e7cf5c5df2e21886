//! Camera paths through `gather::render`: interfaces, the way through a medium, emission.

use bssrdf::{Model, fresnel};
use gather::{Filter, Input, Rendered, Settings, estimator::Estimator};
use glam::DVec3;
use scene::{Camera, NormalKind, Projection};
use support::{
    EFFORT,
    meshes::{Part, World, slab, sphere, world},
    pipeline::{by_area, cloud, grey},
    z_test::{Estimate, assert_mean},
};

/// An orthographic camera that looks from `towards` at the origin.
fn camera(towards: DVec3, half_height: f64) -> Camera {
    let forward = -towards.normalize();
    let right = forward.any_orthonormal_vector();
    Camera {
        name: "test".into(),
        position: -10.0 * forward,
        right,
        up: right.cross(forward),
        forward,
        projection: Projection::Orthographic { half_height },
        aspect: None,
    }
}

/// An image of a clear body of index 1.5.
fn render(world: &World, camera: &Camera, environment: DVec3, paths_per_pixel: u32, max_depth: u32) -> Rendered {
    let settings = Settings {
        width: 16,
        height: 16,
        paths_per_pixel,
        filter: Filter::Box,
        estimator: Estimator::Exhaustive,
        model: Model::DirectionalDipole,
        normals: NormalKind::Geometric,
        environment,
        max_depth,
        seed: 1,
    };
    let cloud = cloud(world, &by_area(16, 0));
    let input = Input {
        scene: &world.scene,
        rays: &world.rays,
        cloud: &cloud,
        media: &[grey(0.0, 0.0, 0.0, 1.5)],
        camera,
    };
    gather::render(&input, &settings, |_| ())
}

/// Under light of the same radiance from everywhere a clear body cannot be seen: each path shows exactly that radiance
/// unless the depth limit ended it, and then nothing.
///
/// Seen to catch: throughput scaled by η² at one crossing; the chosen refraction weighted with T21 again; reflection
/// inside with the reflectance of the outside.
#[test]
fn a_clear_body_under_a_constant_sky_is_invisible() {
    let world = world(&[Part::translucent(sphere(1.0, 3))], &[], DVec3::ONE);
    let paths = 16 * EFFORT as u32;
    let rendered = render(&world, &camera(DVec3::new(1.0, 2.0, 3.0), 1.2), DVec3::ONE, paths, 64);
    let mut missing = 0.0;
    for pixel in &rendered.pixels {
        let lost = (DVec3::ONE - pixel.beauty()) * f64::from(paths);
        assert!((lost - lost.round()).abs().max_element() < 1e-4, "a path shows {lost} too little");
        missing += lost.x;
    }
    assert_eq!(missing.round() as u64, rendered.counts.cut_by_depth);
    let share = rendered.counts.cut_by_depth as f64 / rendered.counts.paths as f64;
    println!("{share:.1e} of the paths cut");
    assert!(share < 0.01);
    assert_eq!(rendered.counts.escaped_inside, 0, "the body is closed");
}

/// A clear body that glows is seen through its interface: `T21 L_e` beside the sky, from a face under a known angle. It
/// is convex, so no face lights another.
///
/// Seen to catch: emission added at reflections too; T21 of the chosen refraction applied again; emission shown at
/// inner hits.
#[test]
fn emission_is_seen_through_the_interface() {
    let (emission, sky) = (DVec3::new(3.0, 1.0, 0.25), DVec3::new(0.5, 0.5, 2.0));
    let body = Part { emission, ..Part::translucent(slab(DVec3::new(10.0, 10.0, 1.0), 1)) };
    let world = world(&[body], &[], DVec3::ZERO);
    for degrees in [0.0, 60.0, 80.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        // A window small enough that all of it lies on one face.
        let camera = camera(DVec3::new(sine, 0.0, cosine), 0.01);
        let rendered = render(&world, &camera, sky, 100 * EFFORT as u32, 1000);
        assert_eq!(rendered.counts.cut_by_depth, 0);
        let expected = fresnel::transmittance(cosine, 1.5) * emission + sky;
        for c in 0..3 {
            let values: Vec<f64> = rendered.pixels.iter().map(|p| p.beauty()[c]).collect();
            assert_mean(&format!("glow at {degrees}°, channel {c}"), Estimate::of(&values), expected[c]);
        }
    }
}
