//! Rough and glossy surfaces through `gather::render`: energy, and light against its integral.

use bsdf::{Bsdf, Gloss, Side, Stated, View};
use bssrdf::Model;
use gather::{Filter, Rendered, Settings};
use glam::DVec3;
use scene::{Camera, GlossStated};
use std::slice::from_ref;
use test_support::{
    EFFORT,
    meshes::{Light, Part, World, quad, rectangle, sphere, world},
    pipeline::{by_area, cloud, gray, input, orthographic, settings},
    z_test::{Estimate, assert_mean},
};

fn gloss(metallic: f64, roughness: f64) -> Option<GlossStated> {
    let dielectric = Stated::dielectric(1.5, 1.0, DVec3::ONE);
    Some(GlossStated { metallic, roughness, texture: None, dielectric })
}

/// An image of 16 × 16 pixels. The translucent parts are clear and of index 1.5.
fn render(world: &World, camera: &Camera, paths: u32) -> Rendered {
    let (cloud, media) = (cloud(world, &by_area(16, 0)), [gray(0.0, 0.0, 0.0, 1.5)]);
    let input = input(world, from_ref(&cloud), &media, camera);
    let settings = settings(Model::DirectionalDipole, 16, 16);
    let settings = Settings { paths_per_pixel: paths, max_depth: 64, filter: Filter::Box, ..settings };
    gather::render(&input, &settings, |_| ())
}

fn mean(rendered: &Rendered) -> Estimate {
    Estimate::of(&rendered.pixels.iter().map(|p| p.beauty().y).collect::<Vec<_>>())
}

/// A small clear ball that nothing sees: a scene has a translucent surface.
fn aside() -> Part {
    let mut ball = sphere(0.01, 1);
    ball.positions.iter_mut().for_each(|p| p.z -= 30.0);
    Part::translucent(ball)
}

/// Rough bodies under a constant sky, a clear one and one of white metal, return what they get, within 0.5 % and the
/// error of the mean. Light that goes through the clear one meets its boundary several times.
///
/// Seen to catch: rays that meet the sky counted whole beside sampled light; the reflected branch without its share.
#[test]
fn rough_bodies_under_a_constant_sky_lose_nothing() {
    let camera = orthographic(DVec3::new(1.0, 2.0, 3.0), 0.6);
    for roughness in [0.3, 1.0] {
        let parts = [Part::translucent(sphere(1.0, 3)), Part::opaque(sphere(1.0, 3))];
        for part in parts {
            let is_metal = !part.translucent;
            let parts = if is_metal { vec![part, aside()] } else { vec![part] };
            let mut world = world(&parts, &[], DVec3::ONE);
            world.scene.materials[0].gloss = gloss(f64::from(u8::from(is_metal)), roughness);
            let all = mean(&render(&world, &camera, 32 * EFFORT as u32));
            let allowed = 5e-3 + 4.5 * all.error;
            let what = format!("roughness {roughness}, metal {is_metal}: {all:?}");
            assert!((all.mean - 1.0).abs() < allowed && allowed < 0.04, "{what}");
        }
    }
}

/// A glossy floor below a square lamp and the sun, as the integral over the lamp has it. The smoother floor meets the lamp
/// by its own directions, the rougher one by the lamp's.
///
/// Seen to catch: either of the two without its share; the density of the lamp without its distance.
#[test]
fn a_glossy_floor_shows_a_lamp_as_its_integral() {
    let (half, height) = (0.4, 1.0);
    let towards = DVec3::new(-1.0, 0.0, 1.2).normalize();
    let sun = Light::Directional { towards: DVec3::new(0.3, 0.5, 1.0).normalize(), irradiance: DVec3::splat(0.7) };
    for (metallic, roughness) in [(1.0, 0.15), (0.0, 0.3), (0.4, 0.8)] {
        let mut lamp = rectangle([0.5, 1.3], half, height, 1);
        lamp.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let lamp = Part { emission: DVec3::splat(3.0), ..Part::opaque(lamp) };
        let mut world = world(&[Part::opaque(quad(3.0, 0.0, 1)), lamp, aside()], &[sun], DVec3::ZERO);
        world.scene.materials[0].gloss = gloss(metallic, roughness);
        let stated = Stated {
            base_color: DVec3::ONE,
            metallic,
            roughness,
            dielectric: Stated::dielectric(1.5, 1.0, DVec3::ONE),
        };
        let (surface, view) = (Gloss::new(&stated), View { normal: DVec3::Z, direction: towards, side: Side::Outside });
        let value = |light: DVec3| (surface.evaluate(&view, light) + surface.base(&view, light)).y * light.z;
        let cells = 200;
        let mut expected = 0.7 * value(DVec3::new(0.3, 0.5, 1.0).normalize());
        for k in 0..cells * cells {
            let at = |k: usize| (k as f64 + 0.5) / cells as f64;
            let offset = DVec3::new(0.5 + 0.8 * at(k / cells), half * (2.0 * at(k % cells) - 1.0), height);
            let light = offset.normalize();
            let area = 0.8 * 2.0 * half / (cells * cells) as f64;
            expected += 3.0 * value(light) * light.z * area / offset.length_squared();
        }
        let rendered = render(&world, &orthographic(towards, 1e-4), 64 * EFFORT as u32);
        let got = mean(&rendered);
        assert!(got.relative_error() < 0.02, "{got:?}");
        assert_mean(&format!("metallic {metallic} roughness {roughness}"), got, expected);
    }
}
