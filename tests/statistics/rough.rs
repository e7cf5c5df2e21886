//! Light that is scattered below rough surfaces, against random walks.

use crate::glossy::gloss;
use bsdf::{Bsdf, Lobe, RoughBoundary, RoughDielectric, Side, View};
use bssrdf::{Coefficients, Model, RoughInterface};
use calibration::{Task, calibrate};
use formats::{calibration::Calibration, cloud::Cloud};
use gather::{
    Filter, Settings, Summation,
    estimator::{Estimator, Scratch},
    film,
    samples::Exit,
};
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use scene::{
    NormalKind,
    random::{Purpose, Stream},
};
use std::{
    f64::consts::{PI, TAU},
    slice::from_ref,
    sync::Arc,
};
use test_support::{
    lit::scatterer,
    meshes::{Light, Part, World, graded_disc, slab, world},
    pipeline::{Sampling, by_area, cloud, gray, input, orthographic, settings, stratified},
    z_test::Estimate,
};
use walks::{Boundary, Collision, Matter, Meeting, Observer, Rough, Sequence, Slab, Start, observed_walk};

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
