//! The roulette over samples: its acceptance rate, and the mean that its weights give.

use bssrdf::{
    Model, built_in,
    lanes::{LaneModel, StandardLanes},
    simd,
};
use formats::cloud::{Cloud, Sample};
use gather::{
    estimator::{Estimator, Rates, Roulette, random_bits},
    samples::{Exit, LitSamples},
};
use glam::{DVec3, Vec3};
use test_support::{
    EFFORT,
    meshes::{Light, Part, slab, world},
    pipeline::{Lit, Point, RULES, by_area, cloud, gray},
    planted::cloud_of,
    random::Random,
    significance,
    z_test::{Estimate, assert_mean},
};

/// A cloud of `count` equal samples one metre below the origin, all in its first half.
fn equal_samples(count: usize) -> Cloud {
    let sample = Sample { position: Vec3::NEG_Z, normal: DVec3::Z, direction: DVec3::Z, flux: Vec3::ONE };
    cloud_of(&[vec![sample; count], Vec::new()])
}

/// How many of the samples of the first half are accepted with probability `p` each.
fn accepted(cloud: &Cloud, p: f64, key: u64) -> u64 {
    let model = &StandardLanes::new(&gray(1.0, 1.0, 0.0, 1.3));
    let samples = &LitSamples::new(cloud, &cloud.meta().materials[0].halves[0], 1.3);
    let exit = &Exit::new(DVec3::ZERO, DVec3::Z, key);
    simd::dispatch(Roulette { model, samples, exit, rates: Rates::One(-p.ln()) }).evaluations
}

/// Fails if a binomial count is too far from its mean. The counts are large enough for a normal distribution, or so
/// much smaller than the number of trials that only their upper tail is heavier, by less than the correction allows.
fn assert_count(what: &str, count: u64, trials: f64, p: f64) {
    let error = (trials * p * (1.0 - p)).sqrt();
    let estimate = Estimate { mean: count as f64, error, freedom: 1e6 };
    println!("{what}: {count} of {trials:e}, z = {:.2}", estimate.deviation(trials * p));
    assert!(estimate.p_value(trials * p) >= significance(), "{what}: {count} for {}", trials * p);
}

/// Acceptance frequencies from one to 10⁻⁸.
///
/// Seen to catch: ξ of 24 bits compared as ξ < p (6 times too many at 10⁻⁸).
#[test]
fn samples_are_accepted_with_their_probability() {
    let samples = equal_samples(1 << 17);
    let run = |p: f64, keys: u64| {
        let mut random = Random(p.to_bits());
        let count: u64 = (0..keys).map(|_| accepted(&samples, p, random.bits())).sum();
        assert_count(&format!("p = {p:e}"), count, (keys * samples.len()) as f64, p);
    };
    assert_eq!(accepted(&samples, 1.0, 1), samples.len());
    for p in [0.9, 0.5, 0.1, 1e-3] {
        run(p, 20 * EFFORT);
    }
    run(1e-5, 400 * EFFORT);
    run(1e-8, 15_000 * EFFORT);
}

/// The key that makes the mixer of `random_bits` give 32 zeros for sample 0: it is a bijection of the index xor the low
/// half of the key, whose rounds are undone here one by one.
fn key_of_zero(high: u32) -> u64 {
    let inverse = |m: u32| (0..5).fold(m, |x, _| x.wrapping_mul(2u32.wrapping_sub(m.wrapping_mul(x))));
    let unshift = |x: u32, by: u32| (0..32).fold(x, |y, _| x ^ (y >> by));
    let undo = |x: u32| {
        let x = unshift(x, 16).wrapping_mul(inverse(0x846c_a68b));
        unshift(unshift(x, 15).wrapping_mul(inverse(0x7feb_352d)), 16)
    };
    let low = undo(undo(0).wrapping_sub(high));
    u64::from(high) << 32 | u64::from(low)
}

/// Below 2⁻³² the first 32 bits of ξ are zero, once in 2³² times; given that, acceptance has the probability 2³² p.
/// Only such keys are tried here.
///
/// Seen to catch: acceptance decided by 32 bits alone (always accepted), or by the same 32 bits twice.
#[test]
fn probabilities_below_the_first_bits_are_met() {
    let samples = equal_samples(1);
    let trials = 40_000 * EFFORT;
    let mut random = Random(9);
    let keys: Vec<u64> = (0..trials).map(|_| key_of_zero(random.bits() as u32)).collect();
    assert!(keys.iter().all(|key| random_bits(0, *key) == 0));
    for conditional in [0.5f64, 0.05, 1e-3, 1e-12] {
        let p = conditional * 2f64.powi(-32);
        let count = keys.iter().map(|key| accepted(&samples, p, *key)).sum();
        if conditional > 1e-6 {
            assert_count(&format!("p = {p:.1e}"), count, trials as f64, conditional);
        } else {
            assert_eq!(count, 0, "p = {p:e}");
        }
    }
}

/// Roulette over the exhaustive sum, on the same cloud at the same points, one number for each cloud; the mean is one
/// for every rule, channel and model. The rule of the note is tested only in channels where its variance is finite,
/// 2σ_tr,c > σ̄ (docs/method.md 7.1).
///
/// Seen to catch: weights of 1 instead of 1/p; unused lanes of the last block counted with weight 1.
#[test]
fn every_rule_has_the_mean_of_the_whole_sum() {
    let lights = [
        Light::Directional { towards: DVec3::new(0.48, 0.6, 0.64), irradiance: DVec3::ONE },
        Light::Point { position: DVec3::new(-0.01, 0.0, 0.01), intensity: DVec3::splat(1e-4) },
    ];
    let half_size = DVec3::new(3e-3, 2e-3, 1e-3);
    let world = world(&[Part::translucent(slab(half_size, 6))], &lights, DVec3::ZERO);
    let points = [DVec3::Z, DVec3::NEG_Z, DVec3::X].map(|n| Point { position: half_size * n, normal: n });
    let medium = built_in("skin1").expect("a built-in medium");
    let clouds: Vec<_> = (0..32).map(|seed| cloud(&world, &by_area(2048 * EFFORT, seed))).collect();
    for model in [Model::DirectionalDipole, Model::StandardDipole] {
        let transport = model.of(&medium).transport();
        let mean_transport = transport.iter().sum::<f64>() / 3.0;
        for (stream, rule) in RULES.into_iter().enumerate() {
            let ratio = |(seed, cloud): (usize, &_)| {
                let lit = Lit::new(cloud, &medium, model);
                let mut random = Random((seed << 8 | stream << 4 | model as usize) as u64);
                let mut roulette = |p: &Point| {
                    (0..100).map(|_| lit.radiance(Estimator::Roulette(rule), *p, random.bits())).sum::<DVec3>() / 100.0
                };
                let mean: DVec3 = points.iter().map(&mut roulette).sum::<DVec3>() / points.len() as f64;
                mean / lit.mean(&points)
            };
            let ratios: Vec<DVec3> = clouds.iter().enumerate().map(ratio).collect();
            for c in 0..3 {
                if rule.name() == "mean" && 2.0 * transport[c] <= mean_transport {
                    continue;
                }
                let runs: Vec<f64> = ratios.iter().map(|r| r[c]).collect();
                assert_mean(&format!("{} {} channel {c}", model.name(), rule.name()), Estimate::of(&runs), 1.0);
            }
        }
    }
}
