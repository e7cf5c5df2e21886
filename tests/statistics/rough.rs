//! Rough and glossy surfaces: energy, light against its integral, and scattered light against random walks.

use bsdf::{Bsdf, Gloss, Lobe, RoughBoundary, RoughDielectric, Side, Stated, View};
use bssrdf::{Coefficients, Model, RoughInterface};
use calibration::{Task, calibrate};
use formats::{calibration::Calibration, cloud::Cloud};
use gather::{
    Filter, Rendered, Settings, Summation,
    estimator::{Estimator, Scratch},
    film,
    samples::Exit,
};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use sample_surface::Choice;
use scene::{
    Camera, GlossStated, NormalKind,
    random::{Purpose, Stream},
};
use std::{
    f64::consts::{PI, TAU},
    slice::from_ref,
    sync::Arc,
};
use test_support::{
    EFFORT,
    lit::scatterer,
    meshes::{Light, Part, World, graded_disc, quad, rectangle, slab, sphere, world},
    pipeline::{Sampling, by_area, cloud, gray, input, orthographic, settings, stratified},
    z_test::{Estimate, assert_mean},
};
use walks::{Boundary, Collision, Matter, Meeting, Observer, Rough, Sequence, Slab, Start, observed_walk};

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
/// error of the mean. Light that goes through the clear one meets its boundary several times. A mirror beside them, which
/// is a little rough, changes nothing.
///
/// Seen to catch: rays that meet the sky counted whole beside sampled light, or in the mirror beside rays that look for it.
#[test]
fn rough_bodies_under_a_constant_sky_lose_nothing() {
    let camera = orthographic(DVec3::new(1.0, 2.0, 3.0), 0.6);
    for roughness in [0.3, 1.0] {
        let bodies = [Part::translucent(sphere(1.0, 3)), Part::opaque(sphere(1.0, 3))];
        for (body, has_mirror) in bodies.into_iter().flat_map(|body| [(body.clone(), false), (body, true)]) {
            let is_metal = !body.translucent;
            let mut parts = if is_metal { vec![body, aside()] } else { vec![body] };
            if has_mirror {
                let mut mirror = sphere(1.0, 4);
                mirror.positions.iter_mut().for_each(|p| *p += Vec3::new(0.5, 1.0, 2.5));
                parts.push(Part::opaque(mirror));
            }
            let mut world = world(&parts, &[], DVec3::ONE);
            world.scene.materials[0].gloss = gloss(f64::from(u8::from(is_metal)), roughness);
            if has_mirror {
                world.scene.materials[parts.len() - 1].gloss = gloss(1.0, 0.2);
            }
            let all = mean(&render(&world, &camera, 128 * EFFORT as u32));
            let allowed = 5e-3 + 4.5 * all.error;
            let what = format!("roughness {roughness}, metal {is_metal}, mirror {has_mirror}: {all:?}");
            assert!((all.mean - 1.0).abs() < allowed && allowed < 0.05, "{what}");
        }
    }
}

/// Half the width of a lamp, which hangs 1 m above the floor from x = 0.5 to 1.3 m and shines down with RADIANCE, and of a
/// mirror, which stands upright from z = 0.3 to 0.9 m.
const HALF: f64 = 0.4;
const RADIANCE: f64 = 3.0;

/// The light that the floor at the origin shows of the lamp in a rough mirror at `x`, by directions that the floor's BSDF draws
/// and points on the lamp.
fn seen_in_mirror(floor: &Gloss, view: &View, mirror: &Gloss, x: f64) -> Estimate {
    let stream = Stream::new(8, Purpose::CalibrationPoint);
    let one = |k: u64| {
        let (item, mut dimension) = (stream.item(k), 2);
        let xi = || {
            dimension += 2;
            [dimension - 2, dimension - 1].map(|d| item.uniform(d))
        };
        let Some(sample) = floor.sample(view, Lobe::Reflection, xi) else { return 0.0 };
        let at = sample.direction * (x / sample.direction.x);
        if sample.direction.x <= 0.0 || at.y.abs() > HALF || !(0.3..=0.9).contains(&at.z) {
            return 0.0;
        }
        let [u, v] = [0, 1].map(|d| item.uniform(d));
        let to_lamp = DVec3::new(0.5 + 0.8 * u, HALF * (2.0 * v - 1.0), 1.0) - at;
        let light = to_lamp.normalize();
        let seen = View { normal: DVec3::NEG_X, direction: -sample.direction, side: Side::Outside };
        let irradiance = RADIANCE * light.z * -light.x * 0.8 * 2.0 * HALF / to_lamp.length_squared();
        sample.weight.y * mirror.evaluate(&seen, light).y * irradiance
    };
    Estimate::of(&(0..400_000).into_par_iter().map(one).collect::<Vec<f64>>())
}

/// A glossy floor below a square lamp and the sun, as the integral over the lamp has it; and the same beside a mirror, with
/// that over the lamp's image, or the light in a rough mirror. The smoother floor meets the lamp by its own directions, the
/// rougher one by the lamp's.
///
/// Seen to catch: rays that meet the lamp counted whole beside sampled light, or with one direction towards it in place of
/// four; sampled light that does not leave them theirs; the image counted whole by paths of the floor's own directions
/// beside those that look for it, by what they meet or by sampled light; the image left to them by lobes of another width.
#[test]
fn a_glossy_floor_shows_a_lamp_as_its_integral() {
    let sun = Light::Directional { towards: DVec3::new(0.3, 0.5, 1.0).normalize(), irradiance: DVec3::splat(0.7) };
    let stated = |metallic, roughness| {
        let dielectric = Stated::dielectric(1.5, 1.0, DVec3::ONE);
        Gloss::new(&Stated { base_color: DVec3::ONE, metallic, roughness, dielectric })
    };
    for (metallic, roughness, mirror_at, of_mirror) in [
        (1.0, 0.15, None, 0.0),
        (0.0, 0.3, None, 0.0),
        (0.4, 0.8, None, 0.0),
        (1.0, 0.15, Some(2.0), 0.0),
        (0.0, 0.3, Some(1.5), 0.0),
        (0.4, 0.8, Some(2.0), 0.0),
        (1.0, 0.3, Some(1.5), 0.3),
    ] {
        // The floor mirrors the middle of the lamp's image, or the lamp's border.
        let middle = mirror_at.map_or(1.0 / 1.2, |x| 2.0 * f64::from(x) - 0.9);
        let towards = DVec3::new(-middle, 0.0, 1.0).normalize();
        let mut lamp = rectangle([0.5, 1.3], HALF, 1.0, 1);
        lamp.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let lamp = Part { emission: DVec3::splat(RADIANCE), ..Part::opaque(lamp) };
        let mut parts = vec![Part::opaque(quad(0.3, 0.0, 1)), lamp, aside()];
        parts.extend(mirror_at.map(|x| {
            let mut mirror = rectangle([0.3, 0.9], HALF, 0.0, 1);
            mirror.positions.iter_mut().for_each(|p| *p = Vec3::new(x, p.y, p.x));
            Part::opaque(mirror)
        }));
        let mut world = world(&parts, &[sun], DVec3::ZERO);
        world.scene.materials[0].gloss = gloss(metallic, roughness);
        world.scene.materials.iter_mut().skip(3).for_each(|mirror| mirror.gloss = gloss(1.0, of_mirror));
        let (surface, view) =
            (stated(metallic, roughness), View { normal: DVec3::Z, direction: towards, side: Side::Outside });
        let mirrored = |light: DVec3| surface.evaluate(&view, light).y * light.z;
        let value = |light: DVec3| mirrored(light) + surface.base(&view, light).y * light.z;
        let cells = 200;
        let mut expected = 0.7 * value(DVec3::new(0.3, 0.5, 1.0).normalize());
        for k in 0..cells * cells {
            let at = |k: usize| (k as f64 + 0.5) / cells as f64;
            let offset = DVec3::new(0.5 + 0.8 * at(k / cells), HALF * (2.0 * at(k % cells) - 1.0), 1.0);
            let area = 0.8 * 2.0 * HALF / (cells * cells) as f64;
            let seen = |offset: DVec3, value: &dyn Fn(DVec3) -> f64| {
                RADIANCE * value(offset.normalize()) * offset.normalize().z * area / offset.length_squared()
            };
            expected += seen(offset, &value);
            // The base of an opaque surface is lit by lights alone, not by their images.
            let image = |x: f32| DVec3::new(2.0 * f64::from(x) - offset.x, offset.y, offset.z);
            expected += mirror_at.filter(|_| of_mirror == 0.0).map_or(0.0, |x| seen(image(x), &mirrored));
        }
        let rendered = render(&world, &orthographic(towards, 1e-4), 64 * EFFORT as u32);
        let mut got = mean(&rendered);
        assert!(got.relative_error() < 0.02, "{got:?}");
        if let Some(x) = mirror_at.filter(|_| of_mirror > 0.0) {
            got = got.minus(seen_in_mirror(&surface, &view, &stated(1.0, of_mirror), f64::from(x)));
        }
        let what = format!("metallic {metallic} roughness {roughness}, {mirror_at:?} of {of_mirror}");
        assert_mean(&what, got, expected);
    }
}

/// A lamp above a glossy floor that a screen hides: the floor sees its image in a ball, of metal or clear. The mean is known
/// within 5 and 8 %; without rays that look for the image, within 23 %.
///
/// Seen to catch: no such rays.
#[test]
fn highlights_have_little_noise() {
    let towards = DVec3::new(-1.0, 0.0, 1.0).normalize();
    for is_translucent in [false, true] {
        let mut lamp = rectangle([-0.1, 0.1], 0.1, 2.0, 1);
        lamp.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let lamp = Part { emission: DVec3::splat(100.0), ..Part::opaque(lamp) };
        let mut ball = sphere(0.3, 4);
        ball.positions.iter_mut().for_each(|p| *p += Vec3::new(0.8, 0.0, 0.8));
        let ball = if is_translucent { Part::translucent(ball) } else { Part::opaque(ball) };
        let screen = Part::opaque(rectangle([-0.15, 0.15], 0.15, 1.0, 1));
        let mut parts = vec![Part::opaque(quad(0.3, 0.0, 1)), lamp, ball, screen];
        if !is_translucent {
            parts.push(aside());
        }
        let mut world = world(&parts, &[], DVec3::ZERO);
        world.scene.materials[0].gloss = gloss(0.0, 0.3);
        if !is_translucent {
            world.scene.materials[2].gloss = gloss(1.0, 0.0);
        }
        let got = mean(&render(&world, &orthographic(towards, 1e-2), 64));
        assert!(got.relative_error() < 0.12, "{is_translucent}: {got:?}");
    }
}

/// A lamp in a clear ball, as a mirror shows it: the ball's interface, which is not the first surface, reflects its share of the
/// light to each path.
///
/// Seen to catch: the choice of one branch by chance, of which the mean is known within 4 % only.
#[test]
fn an_interface_in_a_mirror_reflects_without_noise() {
    let mut lamp = rectangle([0.3, 0.9], 0.3, 0.0, 1);
    lamp.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    lamp.positions.iter_mut().for_each(|p| *p = Vec3::new(-2.0, p.y, p.x));
    let lamp = Part { emission: DVec3::ONE, ..Part::opaque(lamp) };
    // The ray meets the ball at (0.6, 0, 0.6) and goes on along -x.
    let (at, normal) =
        (DVec3::new(0.6, 0.0, 0.6), (DVec3::NEG_X - DVec3::new(0.5f64.sqrt(), 0.0, 0.5f64.sqrt())).normalize());
    let mut ball = sphere(0.3, 5);
    ball.positions.iter_mut().for_each(|p| *p += (at - 0.3 * normal).as_vec3());
    let mut world = world(&[Part::opaque(quad(0.3, 0.0, 1)), lamp, Part::translucent(ball)], &[], DVec3::ZERO);
    world.scene.materials[0].gloss = gloss(1.0, 0.0);
    let got = mean(&render(&world, &orthographic(DVec3::new(-1.0, 0.0, 1.0).normalize(), 1e-4), 64));
    let expected = 1.0 - bsdf::fresnel::transmittance(0.5 * (2.0 + 2f64.sqrt()).sqrt(), 1.5);
    assert!((got.mean / expected - 1.0).abs() < 0.01 && got.relative_error() < 1e-3, "{got:?} {expected}");
}

/// Albedo, index and roughness of the half-space below; its mean free path is a millimetre.
const ALBEDO: f64 = 0.9;
const ETA: f64 = 1.4;
/// `α = 0.3`.
const ROUGHNESS: f64 = 0.547_722_6;

/// Adds up the light of a sun that a walk from the viewer meets through the boundary.
struct Sunlight<'a> {
    surface: RoughDielectric<'a>,
    towards: DVec3,
    light: f64,
}

impl Observer for Sunlight<'_> {
    const SEES_JUMPS: bool = false;

    fn collide(&mut self, _: &Collision, _: &mut Sequence) {}

    fn meet(&mut self, meeting: &Meeting, weight: f64, _: &mut Sequence) {
        self.light += weight * self.surface.evaluate(&meeting.view(), self.towards).x * -self.towards.z;
    }
}

/// Radiance that a half-space of isotropic scatterers behind a rough boundary sends towards `view` under a sun of
/// irradiance 1 across its light, by random walks from the viewer.
fn walked(boundary: &RoughBoundary, towards: DVec3, sun: DVec3, walks: u64) -> Estimate {
    let surface = boundary.surface(ROUGHNESS);
    let coefficients = Coefficients { sigma_a: 1.0 - ALBEDO, sigma_s: ALBEDO, asymmetry: 0.0 };
    let matter = Matter::new(&coefficients, ETA).expect("it scatters");
    let (half_space, stream) = (Slab { thickness: f64::INFINITY }, Stream::new(3, Purpose::LightWalk));
    // A slab lies above its front.
    let [towards, sun] = [towards, sun].map(|v| v.with_z(-v.z));
    let rough = Rough(|_: &Meeting| surface);
    let view = View { normal: DVec3::NEG_Z, direction: towards, side: Side::Outside };
    let walk = |k: u64| {
        let mut random = Sequence::new(stream.item(k));
        let meeting = Meeting { position: DVec3::ZERO, face: Slab::FRONT, normal: DVec3::NEG_Z, direction: -towards };
        let direction = rough.enter(&meeting, &mut random).expect("it enters");
        let start = Start { position: DVec3::ZERO, direction, face: Some(Slab::FRONT) };
        let mut sunlight = Sunlight { surface, towards: sun, light: 0.0 };
        observed_walk(&half_space, &matter, &rough, &start, &mut random, &mut sunlight);
        sunlight.light
    };
    let below = Estimate::of(&(0..walks).into_par_iter().map(walk).collect::<Vec<_>>());
    below.scaled(surface.transmittance(&view))
}

/// The half-space model behind a rough boundary against random walks behind that boundary, within four standard errors
/// and 5 %, or 2 % where the sun is low: the exit lobe is the same for light from any direction.
///
/// Seen to catch: Fresnel's transmittance where light enters, light without its gain.
#[test]
fn a_rough_half_space_is_nearly_that_of_random_walks() {
    let (boundary, medium) = (RoughBoundary::new(ETA, ROUGHNESS), gray(100.0, 900.0, 0.0, ETA));
    let direction = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
    let interface = RoughInterface { boundary: &boundary, roughness: ROUGHNESS, eta: ETA };
    let entry = Model::HalfSpace.rough_entry(&medium, &interface);
    let [a, b] = Model::HalfSpace.rough_exit_lobe(&medium, &interface)[0];
    for (degrees, most) in [(0.0, 0.05), (45.0, 0.05), (75.0, 0.02)] {
        let sun = Light::Directional { towards: direction(degrees), irradiance: DVec3::ONE };
        let world = world(&[Part::translucent(graded_disc(2e-5, 60e-3, 45))], &[sun], DVec3::ZERO);
        let below = |seed: u64| {
            let cloud = cloud(&world, &Sampling { choice: Choice::Uniform, ..by_area(20_000, seed) });
            let scatterer = Arc::new(scatterer(Model::HalfSpace, &medium));
            let summation = Summation::of_clouds(scatterer, from_ref(&cloud), 0).behind(Some(&entry));
            let exit = |_| Exit::new(-world.scene.origin, DVec3::Z, 0);
            summation.whole(Estimator::Exhaustive, exit, &mut Scratch::default()).radiance.x
        };
        let below = Estimate::of(&(0..24).map(below).collect::<Vec<_>>());
        for seen in [10.0, 60.0] {
            let towards = -direction(seen).with_z(-direction(seen).z);
            let factor = boundary.transmittance(towards.z, ROUGHNESS) * (a + b * towards.z);
            let truth = walked(&boundary, towards, direction(degrees), 1_600_000);
            let model = below.mean * factor;
            let error = (below.error * factor).hypot(truth.error);
            let what = format!("sun at {degrees}, seen at {seen}: {model}, walks {truth:?}");
            assert!((model - truth.mean).abs() < most * truth.mean + 4.0 * error, "{what}");
            assert!(error < 0.02 * truth.mean, "{what}");
        }
    }
}

/// Shares of the light of a sun straight above that a slab of isotropic scatterers scatters out of its rough front and out
/// of its rough back, by walks of this test's own, without weights. Lengths are mean free paths.
fn scattered_out(boundary: &RoughBoundary, albedo: f64, thickness: f64, walks: u64) -> [Estimate; 2] {
    let (surface, stream) = (boundary.surface(ROUGHNESS), Stream::new(11, Purpose::LightWalk));
    let walk = |k: u64| {
        let mut random = Sequence::new(stream.item(k));
        let sun = View { normal: DVec3::Z, direction: DVec3::Z, side: Side::Outside };
        let (Lobe::Transmission, mut direction) = surface.scatter(&sun, || random.uniform()) else { return [0.0; 2] };
        let (mut depth, mut is_scattered) = (0.0f64, false);
        loop {
            depth += direction.z * (1.0 - random.uniform()).ln();
            let inward = if depth < 0.0 {
                DVec3::NEG_Z
            } else if depth > thickness {
                DVec3::Z
            } else {
                if random.uniform() >= albedo {
                    return [0.0; 2];
                }
                let (z, turn) = (2.0 * random.uniform() - 1.0, TAU * random.uniform());
                direction = ((1.0 - z * z).sqrt() * DVec3::new(turn.cos(), turn.sin(), 0.0)).with_z(z);
                is_scattered = true;
                continue;
            };
            let view = View { normal: inward, direction: -direction, side: Side::Inside };
            match surface.scatter(&view, || random.uniform()) {
                (Lobe::Reflection, back) => direction = back,
                (Lobe::Transmission, _) => {
                    let share = f64::from(u8::from(is_scattered));
                    return if depth < 0.0 { [share, 0.0] } else { [0.0, share] };
                }
            }
            depth = depth.clamp(0.0, thickness);
        }
    };
    let ends: Vec<[f64; 2]> = (0..walks).into_par_iter().map(walk).collect();
    [0, 1].map(|face| Estimate::of(&ends.iter().map(|end| end[face]).collect::<Vec<_>>()))
}

/// A wide sheet below a sun of irradiance 1, as images show the light that it scatters.
struct Sheet {
    world: World,
    cloud: Cloud,
    medium: bssrdf::Medium,
    half_thickness: f64,
}

impl Sheet {
    fn calibration(&self, walks: u64) -> Calibration {
        let task = Task {
            scene: &self.world.scene,
            rays: &self.world.rays,
            clouds: from_ref(&self.cloud),
            media: from_ref(&self.medium),
            model: Model::HalfSpace,
            normals: NormalKind::Geometric,
            walks,
            seed: 1,
        };
        calibrate(&task, |_| ()).expect("it is closed and lit")
    }

    /// The light that leaves its middle on the side that `up` points from, W/m²: the integral of the radiance over views.
    fn leaving(&self, up: DVec3, calibration: &Calibration) -> f64 {
        /// Gauss and Legendre's nodes and weights on [0, 1].
        const RULE: [(f64, f64); 4] = [
            (0.069_431_844_2, 0.173_927_422_6),
            (0.330_009_478_2, 0.326_072_577_4),
            (0.669_990_521_8, 0.326_072_577_4),
            (0.930_568_155_8, 0.173_927_422_6),
        ];
        let power = |(cosine, weight): (f64, f64)| {
            let sine = (1.0 - cosine * cosine).sqrt();
            let mut camera = orthographic(up * cosine + DVec3::X * sine, 1e-2 * cosine);
            camera.position += up * self.half_thickness;
            let input = input(&self.world, from_ref(&self.cloud), from_ref(&self.medium), &camera);
            let input = gather::Input { calibration: Some(calibration), ..input };
            let settings = Settings {
                paths_per_pixel: 16,
                filter: Filter::Box,
                near_field: true,
                estimator: Estimator::Cut { accuracy: 0.02 },
                ..settings(Model::HalfSpace, 6, 6)
            };
            let image = film::image(&gather::render(&input, &settings, |_| ()).pixels, 6, 6);
            // All channels have the same medium, and walks of their own.
            let channel = |name| image.channel(name).expect("a channel").iter().map(|x| f64::from(*x)).sum::<f64>();
            let light = ["subsurface.R", "subsurface.G", "subsurface.B"].map(channel).iter().sum::<f64>();
            2.0 * PI * cosine * weight * light / (3.0 * 36.0)
        };
        RULE.into_iter().map(power).sum()
    }
}

/// A sheet with rough sides, calibrated, reflects and transmits what the test's own walks bring through a slab, within 3 %,
/// and together within 1.5 %.
///
/// Seen to catch: walks of the calibration behind a smooth boundary; a smooth boundary where light leaves; its transmittance
/// left out there.
#[test]
fn a_rough_sheet_shows_the_light_of_its_two_sides() {
    let (boundary, albedo) = (RoughBoundary::new(ETA, ROUGHNESS), 0.99);
    for thickness in [2.0, 5.0] {
        let half_thickness = 0.5e-3 * thickness;
        let sun = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
        let mesh = slab(DVec3::new(24e-3, 24e-3, half_thickness), 24);
        let mut world = world(&[Part::translucent(mesh)], &[sun], DVec3::ZERO);
        world.scene.materials[0].gloss = gloss(0.0, ROUGHNESS);
        let cloud = cloud(&world, &stratified(1 << 16, 1));
        let medium = gray(1000.0 * (1.0 - albedo), 1000.0 * albedo, 0.0, ETA);
        let sheet = Sheet { world, cloud, medium, half_thickness };
        let calibration = sheet.calibration(70_000);
        let exact = scattered_out(&boundary, albedo, thickness, 200_000);
        let leaving = [DVec3::Z, DVec3::NEG_Z].map(|up| sheet.leaving(up, &calibration));
        println!("{thickness} mean free paths: {leaving:.4?}, walks {exact:?}");
        for (leaving, exact) in leaving.iter().zip(&exact) {
            assert!((leaving / exact.mean - 1.0).abs() < 0.03, "{leaving} for {exact:?}");
            assert!(exact.relative_error() < 0.005, "{exact:?}");
        }
        let [all, exact] = [leaving.iter().sum::<f64>(), exact.iter().map(|side| side.mean).sum()];
        assert!((all / exact - 1.0).abs() < 0.015, "{all} for {exact}");
    }
}
