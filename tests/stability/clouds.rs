//! Clouds that are hard on a tree: hardly any samples, all of them at one point, on a line, or in one half.

use crate::{
    evaluate::assert_is,
    scenes::{SKY, aimed_at, render},
};
use bssrdf::{Medium, Model};
use formats::cloud::{Cloud, Sample};
use gather::{
    Filter, Settings,
    estimator::{Estimator, Sum},
    samples::{Exit, LitSamples},
};
use glam::{DVec3, Vec3};
use test_support::{
    lit::{scatterer, sum},
    meshes::{Light, Part, World, quad, slab, world},
    pipeline::{ESTIMATORS, Lit, MODELS, Point, cloud, gray, settings, stratified},
    planted::{Halves, alternating, cloud_of},
    random::Random,
};

/// The default estimator of the program.
fn default_settings(model: Model) -> Settings {
    let estimator = Estimator::Cut { accuracy: 0.01 };
    Settings { estimator, paths_per_pixel: 16, filter: Filter::Box, ..settings(model, 8, 8) }
}

fn milky() -> Medium {
    gray(100.0, 1000.0, 0.0, 1.3)
}

fn sunny_slab() -> World {
    let sun = Light::Directional { towards: DVec3::new(0.36, 0.48, 0.8), irradiance: DVec3::ONE };
    world(&[Part::translucent(slab(DVec3::new(5e-3, 5e-3, 2e-3), 2))], &[sun], SKY)
}

/// K = 1, 2, 3 with the defaults of both programs: every image can be written, is lit where a sample is, and states
/// how uncertain it is. Half of the cloud may be empty or hold everything.
#[test]
fn one_two_and_three_samples() {
    let world = sunny_slab();
    let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 4e-3);
    for (samples, seed) in [1, 2, 3].into_iter().flat_map(|samples| (0..12).map(move |seed| (samples, seed))) {
        let cloud = cloud(&world, &stratified(samples, seed));
        for model in MODELS {
            let rendered = render(&world, &cloud, &[milky()], &camera, &default_settings(model));
            assert_eq!(rendered.counts.gathers > 0, !cloud.is_empty());
            let sums: DVec3 = rendered.pixels.iter().map(|p| p.variance()).sum();
            assert!(sums.is_finite() && sums.min_element() > 0.0, "paths meet the sky in and beside the slab");
        }
    }
}

/// The mean of many cuts is close to the exhaustive sum: an error of one half, which the looser cut is asked for, is
/// 0.035 in the mean of 200, and `room` is at least three times that.
fn assert_sums(what: &str, halves: &Halves, points: &[Point], room: f64) {
    let cloud = cloud_of(halves);
    for model in MODELS {
        let lit = Lit::new(&cloud, &milky(), model);
        for point in points {
            let whole = lit.radiance(Estimator::Exhaustive, *point, 0);
            assert!(whole.is_finite() && whole.min_element() >= 0.0, "{what}: {whole}");
            for estimator in ESTIMATORS.into_iter().filter(|e| matches!(e, Estimator::Cut { .. })) {
                let mut random = Random(5);
                let mean = (0..200).map(|_| lit.radiance(estimator, *point, random.bits())).sum::<DVec3>() / 200.0;
                let error = (mean / whole - 1.0).abs().max_element();
                assert!(mean == whole || error < room, "{what}, {estimator:?} at {point:?}: {mean} {whole}");
            }
        }
    }
}

/// At the samples, beside them, and far away.
fn around(position: DVec3) -> Vec<Point> {
    let offsets = [DVec3::ZERO, DVec3::X * 1e-7, DVec3::X * 1e-4, DVec3::new(0.0, 2e-3, 0.0), DVec3::Y * 3e-2];
    offsets.map(|offset| Point { position: position + offset, normal: DVec3::Z }).into()
}

fn sample(position: Vec3, flux: f32) -> Sample {
    let direction = DVec3::new(0.3, 0.1, 1.0).normalize();
    Sample { position, normal: DVec3::Z, direction, flux: Vec3::splat(flux) }
}

/// A node of no extent: the guards are its radius and spread of 0, also at a distance of 0 from it. With equal
/// samples every pick is exact.
#[test]
fn all_samples_in_one_point() {
    let at = Vec3::new(1e-3, -2e-3, 0.0);
    for count in [1, 16, 17, 1000] {
        let equal = alternating((0..count).map(|_| sample(at, 2.0)));
        assert_sums("equal samples in a point", &equal, &around(at.as_dvec3()), 1e-5);
    }
    let uneven = alternating((0..1000).map(|k| sample(at, 1.0 + (k % 7) as f32)));
    assert_sums("uneven samples in a point", &uneven, &around(at.as_dvec3()), 0.1);
}

/// Samples along a line, evenly spaced and increasingly crowded: nodes whose center is far from most of their
/// samples.
#[test]
fn all_samples_on_a_line() {
    let at = |x: f32| sample(Vec3::new(x, 0.0, 0.0), 1.0);
    let even = alternating((0..3000).map(|k| at(k as f32 * 1e-5)));
    assert_sums("evenly on a line", &even, &around(DVec3::new(0.015, 0.0, 0.0)), 0.2);
    let crowded = alternating((0..3000).map(|k| at(0.03 * 0.99f32.powi(k))));
    assert_sums("crowded on a line", &crowded, &around(DVec3::ZERO), 0.2);
}

/// Points on a square of 8 mm.
fn scattered(count: usize) -> Vec<Sample> {
    let mut random = Random(8);
    let mut position = || Vec3::new(random.between(-4e-3, 4e-3) as f32, random.between(-4e-3, 4e-3) as f32, 0.0);
    (0..count).map(|_| sample(position(), 1.0)).collect()
}

/// The exitant point coincides with a sample to the last digit, amid others.
#[test]
fn exit_point_exactly_at_a_sample_of_many() {
    let samples = scattered(3000);
    let points: Vec<Point> =
        samples.iter().step_by(500).map(|s| Point { position: s.position.as_dvec3(), normal: DVec3::Z }).collect();
    assert_sums("at a sample", &alternating(samples), &points, 0.1);
}

/// All samples lie in one of the halves: the paths of the other half gather nothing, and the pixel is the mean of
/// both.
///
/// Seen to catch: the other half taken where one is empty.
#[test]
fn all_samples_in_one_half() {
    let world = world(&[Part::translucent(quad(5e-3, 0.0, 2))], &[], DVec3::ONE);
    let samples = scattered(500);
    let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 2e-3);
    let exact = Estimator::Cut { accuracy: 1e-5 };
    for halves in [[samples.clone(), Vec::new()], [Vec::new(), samples]] {
        let cloud: Cloud = cloud_of(&halves);
        let image = |estimator: Estimator, paths_per_pixel: u32| {
            let settings = Settings { estimator, paths_per_pixel, ..settings(Model::BetterDipole, 8, 8) };
            render(&world, &cloud, &[milky()], &camera, &settings).pixels
        };
        let whole = image(Estimator::Exhaustive, 4);
        for paths in [1, 2, 4] {
            for (a, b) in image(exact, paths).iter().zip(&whole) {
                assert_is("one half", a.beauty(), b.beauty(), 1e-3);
                assert!(b.beauty().min_element() > 0.0 && a.variance().min_element() > 0.0);
            }
        }
    }
}

/// Flux scaled by a power of two scales the sum by it, to the last bit and with the same samples.
///
/// Seen to catch: squared errors that leave float32: where they overflow every sample is summed, where they underflow
/// far too few are.
#[test]
fn strong_and_weak_light_is_cut_as_finely() {
    let lit = scattered(3000);
    let sums = |exponent: i32| -> Vec<Sum> {
        let scaled = lit.iter().map(|s| Sample { flux: s.flux * 2f32.powi(exponent), ..*s });
        let cloud = cloud_of(&alternating(scaled));
        let at = |model| {
            let lit = Lit::new(&cloud, &milky(), model);
            let points = around(DVec3::ZERO);
            points.iter().map(|p| lit.sum(0, Estimator::Cut { accuracy: 0.05 }, *p, 7)).collect::<Vec<_>>()
        };
        MODELS.into_iter().flat_map(at).collect()
    };
    let plain = sums(0);
    assert!(plain.iter().any(|sum| sum.evaluations < 1000 && sum.radiance.x > 0.0), "nothing was left out");
    for exponent in [-100, -70, -40, 40, 70, 100] {
        for (sum, plain) in sums(exponent).into_iter().zip(&plain) {
            assert_eq!(sum.radiance, plain.radiance * 2f64.powi(exponent), "2^{exponent}");
            assert_eq!((sum.evaluations, sum.nodes), (plain.evaluations, plain.nodes), "2^{exponent}");
        }
    }
}

/// A tree and samples that were not verified, or that change while they are read: no sum over them panics or hangs.
///
/// Seen to catch: a threshold below 0, for which leaves beyond the last tile are opened.
#[test]
fn samples_and_nodes_that_were_never_checked_do_no_harm() {
    let cloud = cloud_of(&alternating(scattered(180)));
    let group = cloud.meta().materials[0].halves[0];
    let (tiles, nodes) = cloud.group(&group);
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, -1e30, 0.0, 1e-45];
    let (mut random, scatterer) = (Random(3), scatterer(Model::StandardDipole, &milky()));
    for round in 0..500 {
        let (mut tiles, mut nodes) = (tiles.to_vec(), nodes.to_vec());
        let mut number = || numbers[random.bits() as usize % numbers.len()];
        match round % 5 {
            0 => tiles.iter_mut().flatten().for_each(|r| r.flux = r.flux.map(|x| -1e6 * x)),
            4 => nodes.iter_mut().for_each(|n| n.flux = -n.flux),
            1 => tiles.iter_mut().flatten().for_each(|r| r.flux = [number(); 3]),
            2 => nodes.iter_mut().for_each(|n| (n.flux, n.radius) = (number(), number())),
            _ => nodes
                .iter_mut()
                .for_each(|n| (n.center[0], n.spread, n.direction_deviation) = (number(), number(), number())),
        }
        for len in [group.samples as usize, usize::MAX] {
            let samples = LitSamples::of(&tiles, &nodes, len, 1.3);
            let exit = Exit::new(DVec3::X * random.between(-5e-3, 5e-3), DVec3::Z, round);
            for estimator in ESTIMATORS {
                let sum = sum(&scatterer, &samples, &exit, estimator);
                assert!(sum.evaluations <= 16 * tiles.len() as u64);
            }
        }
    }
}
