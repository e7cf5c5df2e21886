//! Rough and glossy surfaces: energy, light against its integral, and scattered light against random walks.

use bsdf::{Bsdf, Gloss, Lobe, RoughBoundary, Side, Stated, View};
use bssrdf::{Model, RoughEntry};
use gather::{
    Filter, Rendered, Settings, Summation,
    estimator::{Estimator, Scratch},
    samples::Exit,
};
use glam::DVec3;
use sample_surface::Choice;
use scene::{Camera, GlossStated};
use std::{slice::from_ref, sync::Arc};
use test_support::{
    EFFORT,
    lit::scatterer,
    meshes::{Light, Part, World, graded_disc, quad, rectangle, sphere, world},
    pipeline::{Sampling, by_area, cloud, gray, input, orthographic, settings},
    random::Random,
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
/// Seen to catch: rays that meet the sky counted whole beside sampled light.
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
            let all = mean(&render(&world, &camera, 128 * EFFORT as u32));
            let allowed = 5e-3 + 4.5 * all.error;
            let what = format!("roughness {roughness}, metal {is_metal}: {all:?}");
            assert!((all.mean - 1.0).abs() < allowed && allowed < 0.05, "{what}");
        }
    }
}

/// A glossy floor below a square lamp and the sun, as the integral over the lamp has it. The smoother floor meets the lamp
/// by its own directions, the rougher one by the lamp's.
///
/// Seen to catch: rays that meet the lamp counted whole beside sampled light.
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

/// Albedo, index and roughness of the half-space below; its mean free path is a millimetre.
const ALBEDO: f64 = 0.9;
const ETA: f64 = 1.4;
/// `α = 0.3`.
const ROUGHNESS: f64 = 0.547_722_6;

/// Radiance that a half-space of isotropic scatterers behind a rough boundary sends towards `view` under a sun of
/// irradiance 1 across its light, by random walks from the viewer that are connected to the sun at the boundary.
fn walked(boundary: &RoughBoundary, towards: DVec3, sun: DVec3, walks: u32) -> Estimate {
    let (surface, mut random) = (boundary.surface(ROUGHNESS), Random(3));
    let mut walk = || {
        let view = View { normal: DVec3::Z, direction: towards, side: Side::Outside };
        let mut weight = surface.transmittance(&view);
        let mut xi = || [random.uniform(), random.uniform()];
        let Some(entered) = surface.sample(&view, Lobe::Transmission, &mut xi) else { return 0.0 };
        weight *= entered.weight.x;
        let (mut depth, mut direction, mut light, mut scattered) = (0.0f64, entered.direction, 0.0, false);
        loop {
            depth += direction.z * (1.0 - random.uniform()).ln();
            if depth < 0.0 {
                // From the boundary the rest of the free path is drawn anew, without memory.
                depth = 0.0;
                let view = View { normal: DVec3::NEG_Z, direction: -direction, side: Side::Inside };
                if scattered {
                    light += weight * surface.evaluate(&view, sun).x * sun.z;
                }
                let reflected = 1.0 - surface.transmittance(&view);
                let mut xi = || [random.uniform(), random.uniform()];
                let next = if xi()[0] < reflected { surface.sample(&view, Lobe::Reflection, &mut xi) } else { None };
                let Some(next) = next else { return light };
                (weight, direction) = (weight * next.weight.x, next.direction);
                continue;
            }
            if random.uniform() >= ALBEDO {
                return light;
            }
            (direction, scattered) = (random.direction(), true);
        }
    };
    Estimate::of(&(0..walks).map(|_| walk()).collect::<Vec<_>>())
}

/// The half-space model behind a rough boundary against random walks behind that boundary, within four standard errors
/// and 5 %, or 8 % where the sun is low: the model refracts as a smooth boundary does.
///
/// Seen to catch: Fresnel's transmittance where light enters.
#[test]
fn a_rough_half_space_is_nearly_that_of_random_walks() {
    let (boundary, medium) = (RoughBoundary::new(ETA, ROUGHNESS), gray(100.0, 900.0, 0.0, ETA));
    let direction = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
    let entry = RoughEntry::new(&boundary, ROUGHNESS);
    for (degrees, most) in [(0.0, 0.05), (45.0, 0.05), (75.0, 0.08)] {
        let sun = Light::Directional { towards: direction(degrees), irradiance: DVec3::ONE };
        let world = world(&[Part::translucent(graded_disc(2e-5, 60e-3, 45))], &[sun], DVec3::ZERO);
        let below = |seed: u64| {
            let cloud = cloud(&world, &Sampling { choice: Choice::Uniform, ..by_area(20_000, seed) });
            let scatterer = Arc::new(scatterer(Model::HalfSpace, &medium));
            let summation = Summation::of_clouds(scatterer, from_ref(&cloud), 0).behind(&entry);
            let exit = |_| Exit::new(-world.scene.origin, DVec3::Z, 0);
            summation.whole(Estimator::Exhaustive, exit, &mut Scratch::default()).radiance.x
        };
        let below = Estimate::of(&(0..24).map(below).collect::<Vec<_>>());
        for seen in [10.0, 60.0] {
            let towards = -direction(seen).with_z(-direction(seen).z);
            let [a, b] = Model::HalfSpace.exit_lobe(&medium)[0];
            let factor = boundary.transmittance(towards.z, ROUGHNESS) * (a + b * towards.z);
            let truth = walked(&boundary, towards, direction(degrees), 400_000);
            let model = below.mean * factor;
            let error = (below.error * factor).hypot(truth.error);
            let what = format!("sun at {degrees}, seen at {seen}: {model}, walks {truth:?}");
            assert!((model - truth.mean).abs() < most * truth.mean + 4.0 * error, "{what}");
            assert!(error < 0.02 * truth.mean, "{what}");
        }
    }
}
