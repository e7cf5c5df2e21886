//! Cameras at unusual positions, and rays that meet edges and vertices. The object is clear and the sky constant: every
//! path must show exactly the sky, or it was lost at an interface.

use crate::scenes::{Clear, aimed_at, assert_invisible, channel, render};
use bssrdf::{Model, fresnel};
use gather::{Filter, Settings};
use glam::DVec3;
use scene::Camera;
use test_support::{
    meshes::{Mesh, Part, quad, slab, sphere, world},
    pipeline::{by_area, cloud, gray, settings},
    random::Random,
};

fn body(mesh: Mesh) -> Clear {
    Clear::new(world(&[Part::translucent(mesh)], &[], DVec3::ONE))
}

fn one_pixel() -> Settings {
    Settings { paths_per_pixel: 4, ..settings(Model::DirectionalDipole, 1, 1) }
}

/// The camera is inside: the first interface is met from within, without one before it, and the way to it lies in the
/// medium. The camera is close enough to the center to avoid total reflection.
#[test]
fn camera_inside_a_clear_medium() {
    let body = body(sphere(1.0, 3));
    let settings = Settings { paths_per_pixel: 16, filter: Filter::Box, ..settings(Model::DirectionalDipole, 16, 16) };
    for eta in [1.0, 1.0 + 1e-7, 1.5] {
        for towards in [DVec3::X, DVec3::new(1.0, 2.0, -3.0)] {
            let projection = scene::Projection::Perspective { tangent: 1.0 };
            let camera =
                Camera { position: DVec3::new(0.1, 0.2, 0.1), projection, ..aimed_at(DVec3::ZERO, towards, 1.0) };
            let counts = assert_invisible("inside", &body, &[eta], &camera, &settings);
            assert_eq!((counts.escaped_inside, counts.nested), (0, 0));
        }
    }
}

/// The same through an absorbing medium of index 1: `e^{−σ_a s}` from the center, by roulette, so that each path
/// carries all or nothing.
#[test]
fn camera_inside_an_absorbing_medium() {
    let body = body(sphere(1.0, 4));
    let settings = Settings { paths_per_pixel: 256, ..settings(Model::BetterDipole, 8, 8) };
    let projection = scene::Projection::Perspective { tangent: 1.0 };
    let camera = Camera { position: DVec3::ZERO, projection, ..aimed_at(DVec3::ZERO, DVec3::X, 1.0) };
    let cloud = cloud(&body.world, &by_area(16, 0));
    let rendered = render(&body.world, &cloud, &[gray(0.5, 0.0, 0.0, 1.0)], &camera, &settings);
    let mean = rendered.pixels.iter().map(|p| p.beauty().x).sum::<f64>() / 64.0;
    // Five standard errors of 16 384 paths.
    assert!((mean - (-0.5f64).exp()).abs() < 5.0 * 0.5 / 128.0, "{mean}");
    assert_eq!(rendered.counts.gathers, 0, "nothing is gathered from inside");
}

/// Rays along every edge of a box, exactly and with rounding: two faces are seen edge-on, and the others are met at a
/// corner. At an index of 1.2, total reflection does not trap what the grazing interface lets in.
#[test]
fn camera_ray_along_an_edge() {
    let body = body(slab(DVec3::ONE, 1));
    for axis in 0..3 {
        for (u, v) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            for along in [1.0, -1.0] {
                for tilt in [0.0, 1e-17, -1e-17, 1e-15, -1e-15, 1e-9, -1e-9] {
                    let (mut towards, mut target) = (DVec3::splat(tilt), DVec3::ZERO);
                    towards[axis] = along;
                    (target[(axis + 1) % 3], target[(axis + 2) % 3]) = (u, v);
                    let camera = aimed_at(target, towards, 1.0);
                    let what = format!("along {axis} at {u} {v}, {tilt}");
                    let counts = assert_invisible(&what, &body, &[1.2], &camera, &one_pixel());
                    assert_eq!(counts.escaped_inside, 0, "{what}");
                }
            }
        }
    }
}

/// Rays through vertices from all sides, into the object and past it: no ray may pass between neighboring faces. (A
/// ray that touches the object only in a vertex may miss it, and is counted.)
#[test]
fn camera_ray_through_a_vertex() {
    let mut random = Random(3);
    for body in [body(slab(DVec3::ONE, 1)), body(sphere(1.0, 2))] {
        for position in body.world.scene.mesh.positions.iter().map(|p| p.as_dvec3()) {
            for into_the_body in [true, true, true, false, false, false] {
                let inside = 0.5 * random.direction();
                let towards = if into_the_body { position - inside } else { random.direction() };
                let camera = aimed_at(position, towards, 1.0);
                let what = format!("through {position} along {}", camera.forward);
                let counts = assert_invisible(&what, &body, &[1.5], &camera, &one_pixel());
                assert!(counts.escaped_inside == 0 || !into_the_body, "{what}");
            }
        }
    }
}

/// cos θ = 10⁻⁷: the light is reflected, except for 6·10⁻⁷, and the hit point is finite.
#[test]
fn grazing_view() {
    let body = body(quad(0.5, 0.0, 4));
    let settings = settings(Model::DirectionalDipole, 1, 1);
    for cosine in [1e-7, 1e-6, 1e-3] {
        let camera = aimed_at(DVec3::ZERO, DVec3::new(1.0, 0.0, cosine), 1.0);
        assert_invisible("grazing", &body, &[1.3], &camera, &settings);
        let rendered = body.render(&[1.3], &camera, &settings);
        let reflectance = 1.0 - fresnel::transmittance(cosine, 1.3);
        assert!((f64::from(channel(&rendered, &settings, "specular.R")[0]) - reflectance).abs() < 1e-7);
        assert!((channel(&rendered, &settings, "Z")[0] - 10.0).abs() < 1e-5);
        assert!(fresnel::transmittance(cosine, 1.3) < 10.0 * cosine);
    }
}

/// A camera on a face or in a vertex, and one so far away that its ray has no digits for the object. At an index of
/// 1.2, total reflection traps no path in a box.
#[test]
fn camera_on_the_surface_and_far_away() {
    let body = body(slab(DVec3::ONE, 1));
    let mut random = Random(4);
    for position in [DVec3::new(0.2, 0.3, 1.0), DVec3::ONE, DVec3::new(1.0, 1.0, 0.0), DVec3::splat(1e12)] {
        for _ in 0..40 {
            let camera = Camera { position, ..aimed_at(DVec3::ZERO, random.direction(), 1.0) };
            assert_invisible("on the surface", &body, &[1.2], &camera, &one_pixel());
        }
    }
}

/// The depth limit ends both branches of every path that meets the object, counts them, and shows nothing in their
/// place.
#[test]
fn depth_of_one() {
    let body = body(sphere(1.0, 3));
    let settings = Settings { max_depth: 1, ..settings(Model::DirectionalDipole, 8, 8) };
    let camera = aimed_at(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), 0.5);
    let rendered = body.render(&[1.5], &camera, &settings);
    assert_eq!((rendered.counts.cut_by_depth, rendered.counts.rays), (128, 64));
    assert!(rendered.pixels.iter().all(|p| p.beauty() == DVec3::ZERO));
}
