//! Camera paths through `gather::render`: interfaces, absorption in a medium, emission.

use bssrdf::{Model, fresnel};
use gather::{Filter, Rendered, Settings};
use glam::DVec3;
use scene::Camera;
use std::slice::from_ref;
use test_support::{
    EFFORT,
    meshes::{Part, World, slab, sphere, world},
    pipeline::{by_area, cloud, gray, input, orthographic, settings},
    z_test::{Estimate, assert_mean},
};

/// An image of an object of index 1.5 that scatters nothing; `sigma_a` in 1/m.
fn render(world: &World, camera: &Camera, sigma_a: f64, settings: &Settings) -> Rendered {
    let (cloud, media) = (cloud(world, &by_area(16, 0)), [gray(sigma_a, 0.0, 0.0, 1.5)]);
    let input = input(world, from_ref(&cloud), &media, camera);
    gather::render(&input, settings, |_| ())
}

fn of_paths(paths_per_pixel: u32, max_depth: u32) -> Settings {
    let settings = settings(Model::DirectionalDipole, 16, 16);
    Settings { paths_per_pixel, max_depth, filter: Filter::Box, ..settings }
}

/// The mean of all pixels, in each channel, against the expected one.
fn assert_image(what: &str, rendered: &Rendered, expected: DVec3) {
    assert_eq!(rendered.counts.cut_by_depth, 0);
    for c in 0..3 {
        let values: Vec<f64> = rendered.pixels.iter().map(|p| p.beauty()[c]).collect();
        assert_mean(&format!("{what}, channel {c}"), Estimate::of(&values), expected[c]);
    }
}

/// A clear object in a constant environment is invisible: the two branches of a path carry R and T21 of that
/// radiance. A path that the depth limit ends carries nothing.
///
/// Seen to catch: throughput scaled by η⁻² at one crossing; the refracted branch weighted with T21 twice; the mirrored
/// one without R.
#[test]
fn a_clear_body_under_a_constant_sky_is_invisible() {
    let world = world(&[Part::translucent(sphere(1.0, 3))], &[], DVec3::ONE);
    let paths = 16 * EFFORT as u32;
    let camera = orthographic(DVec3::new(1.0, 2.0, 3.0), 1.2);
    let rendered = render(&world, &camera, 0.0, &of_paths(paths, 64));
    // R and T21 of a path add up to 1 up to rounding.
    let rounding = 1e-14 * f64::from(paths);
    let mut missing = 0.0;
    let mut darker = 0;
    for pixel in &rendered.pixels {
        let lost = (DVec3::ONE - pixel.beauty()) * f64::from(paths);
        assert!(lost.min_element() > -rounding, "the paths show {lost} too little");
        missing += lost.x;
        darker += u64::from(lost.x > rounding);
    }
    // The missing radiance was refracted: T21 of a path, between a tenth (two degrees from grazing) and its largest
    // value.
    let cut = rendered.counts.cut_by_depth;
    let largest = fresnel::transmittance(1.0, 1.5);
    assert!(darker <= cut && missing <= largest * cut as f64 + 1e-9 && missing >= 0.1 * cut as f64, "{missing} {cut}");
    let share = rendered.counts.cut_by_depth as f64 / rendered.counts.paths as f64;
    println!("{share:.1e} of the paths cut");
    assert!(share < 0.01);
    assert_eq!(rendered.counts.escaped_inside, 0, "the body is closed");
}

/// A clear emissive object is seen through its interface: `T21 L_e` beside the sky, from a face at a known angle. The
/// object is convex, so no face lights another.
///
/// Nothing in it is random: each pixel has its value to the float32 of the file.
///
/// Seen to catch: emission added to the mirrored branch too; T21 of the refracted one applied twice; emission shown at
/// inner hits.
#[test]
fn emission_is_seen_through_the_interface() {
    let (emission, sky) = (DVec3::new(3.0, 1.0, 0.25), DVec3::new(0.5, 0.5, 2.0));
    let body = Part { emission, ..Part::translucent(slab(DVec3::new(10.0, 10.0, 1.0), 1)) };
    let world = world(&[body], &[], sky);
    for degrees in [0.0, 60.0, 80.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        // The image shows so little that all of it lies on one face.
        let camera = orthographic(DVec3::new(sine, 0.0, cosine), 0.01);
        let rendered = render(&world, &camera, 0.0, &of_paths(100 * EFFORT as u32, 1000));
        let expected = fresnel::transmittance(cosine, 1.5) * emission + sky;
        let worst =
            rendered.pixels.iter().map(|p| (p.beauty() / expected - 1.0).abs().max_element()).fold(0.0, f64::max);
        assert!(worst < 1e-7 && rendered.counts.cut_by_depth == 0, "glow at {degrees}°: {worst:e}");
    }
}

/// An emissive block reflected in a pane of an opaque medium: `R L_e`, without noise. The block is also an area
/// light, whose light must not be added a second time.
///
/// Seen to catch: a mirrored branch that ends at light sources.
#[test]
fn a_lamp_is_seen_in_a_mirror() {
    let emission = DVec3::new(1.0, 2.0, 4.0);
    for degrees in [40.0, 60.0, 75.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        let mut lamp = Part { emission, ..Part::opaque(slab(DVec3::splat(3.0), 1)) };
        let middle = 30.0 * DVec3::new(-sine, 0.0, cosine);
        lamp.mesh.positions.iter_mut().for_each(|p| *p += middle.as_vec3());
        let world = world(&[Part::translucent(slab(DVec3::new(20.0, 20.0, 0.25), 1)), lamp], &[], DVec3::ZERO);
        let camera = orthographic(DVec3::new(sine, 0.0, cosine), 0.01);
        let rendered = render(&world, &camera, 1e4, &of_paths(4, 16));
        let expected = (1.0 - fresnel::transmittance(cosine, 1.5)) * emission;
        for pixel in &rendered.pixels {
            let worst = (pixel.beauty() / expected - 1.0).abs().max_element();
            assert!(worst < 1e-7, "{degrees} degrees: {} instead of {expected}", pixel.beauty());
        }
    }
}

/// A pane before an emissive wall: with R at each face and the transmittance a of one way through, it shows `(1 − R)²
/// a/(1 − R² a²)` of the wall.
///
/// Seen to catch: internal reflection with the probability of the outside; absorption left out; rays that are likelier to come
/// through than their weights suppose, and rays that are as likely as their light.
#[test]
fn a_pane_transmits_what_its_faces_and_its_medium_let_through() {
    const SIGMA_A: f64 = 0.8;
    let emission = DVec3::new(1.0, 2.0, 4.0);
    let mut wall = Part { emission, ..Part::opaque(slab(DVec3::new(30.0, 30.0, 1.0), 1)) };
    wall.mesh.positions.iter_mut().for_each(|p| p.z -= 5.0);
    let pane = Part::translucent(slab(DVec3::new(20.0, 20.0, 0.25), 1));
    let world = world(&[pane, wall], &[], DVec3::ZERO);
    for degrees in [0.0, 60.0, 75.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        let camera = orthographic(DVec3::new(sine, 0.0, cosine), 0.01);
        let rendered = render(&world, &camera, SIGMA_A, &of_paths(100 * EFFORT as u32, 1000));
        let through = (-SIGMA_A * 0.5 / (1.0 - (sine / 1.5).powi(2)).sqrt()).exp();
        let enters = fresnel::transmittance(cosine, 1.5);
        let reflected = (1.0 - enters) * through;
        let share = enters * enters * through / (1.0 - reflected * reflected);
        assert_image(&format!("wall through a pane at {degrees}°"), &rendered, share * emission);
        // At 0° the error is 0.0013; it would be 0.0046 if as few rays came through as light does.
        let error = Estimate::of(&rendered.pixels.iter().map(|p| p.beauty().y).collect::<Vec<_>>()).relative_error();
        assert!(degrees > 0.0 || error < 2e-3, "{error}");
    }
}
