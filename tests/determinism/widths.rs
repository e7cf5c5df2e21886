//! The same bits for any vector width.

use crate::threads::still_life;
use bssrdf::{
    Medium, Model, built_in,
    lanes::{BetterLanes, DirectionalLanes, LaneModel, StandardLanes},
    simd::{self, Kernel, Level},
};
use gather::{
    estimator::{Calibration, Cut, Estimator, Exhaustive, FalloffTables, Roulette, Scratch, Sum},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use test_support::pipeline::{ESTIMATORS, MODELS, by_area, cloud};

/// Sums by the scalar body and by every vector width that this processor has.
fn each_way<M: LaneModel>(
    (medium, kind): (&Medium, Model),
    tables: &FalloffTables,
    samples: &LitSamples,
    exit: &Exit,
    estimator: Estimator,
) -> Vec<Sum> {
    let model = &M::new(medium);
    match estimator {
        Estimator::Exhaustive => all_ways(|| Exhaustive { model, samples, exit }),
        Estimator::Roulette(rule) => {
            let rates = rule.rates(kind.of(medium).transport());
            all_ways(|| Roulette { model, samples, exit, rates })
        }
        Estimator::Cut { accuracy } => {
            let (accuracy, calibration) = (accuracy as f32, &Calibration::default());
            levels()
                .map(|level| {
                    let scratch = &mut Scratch::default();
                    simd::run_as(level, Cut { model, samples, tables, exit, accuracy, calibration, scratch })
                })
                .collect()
        }
    }
}

fn all_ways<K: Kernel<Output = Sum>>(kernel: impl Fn() -> K) -> Vec<Sum> {
    levels().map(|level| simd::run_as(level, kernel())).collect()
}

fn levels() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|level| level.is_available())
}

#[test]
fn sums_have_the_same_bits_for_any_vector_width() {
    let world = still_life();
    let cloud = cloud(&world, &by_area(20_000, 3));
    let mut lit = 0;
    for medium in ["skin1", "marble", "espresso"].map(|name| built_in(name).expect("a built-in medium")) {
        let samples = LitSamples::new(&cloud, &cloud.meta().materials[0].halves[0], medium.eta);
        for model in MODELS {
            let tables = FalloffTables::new(&medium, &*model.of(&medium), 5e-3);
            let sums = match model {
                Model::DirectionalDipole => each_way::<DirectionalLanes>,
                Model::BetterDipole => each_way::<BetterLanes>,
                Model::StandardDipole => each_way::<StandardLanes>,
            };
            for (estimator, normal) in ESTIMATORS
                .into_iter()
                .flat_map(|e| [DVec3::Z, DVec3::NEG_X, DVec3::new(0.6, -0.8, 0.0)].map(|n| (e, n)))
            {
                let exit = Exit::new(normal * 4e-3, normal, 77);
                let sums = sums((&medium, model), &tables, &samples, &exit, estimator);
                let bits = |s: &Sum| (s.radiance.to_array().map(f64::to_bits), s.evaluations, s.nodes);
                let same = sums.iter().all(|s| bits(s) == bits(&sums[0]));
                assert!(same, "{} {} {estimator:?}: {sums:?}", medium.name, model.name());
                lit += u32::from(sums[0].radiance.min_element() > 0.0);
            }
        }
    }
    assert!(lit > 120, "only {lit} of 162 sums are not zero");
}
