//! Sums have the same bits for any vector width.

use crate::threads::still_life;
use bssrdf::{built_in, simd::Level};
use gather::{
    estimator::{Scatterer, Sum},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use test_support::{
    lit::sum,
    pipeline::{ESTIMATORS, MODELS, by_area, cloud},
};

#[test]
fn sums_have_the_same_bits_for_any_vector_width() {
    let world = still_life();
    let cloud = cloud(&world, &by_area(20_000, 3));
    let mut lit = 0;
    for medium in ["skin1", "marble", "espresso"].map(|name| built_in(name).expect("a built-in medium")) {
        let samples = LitSamples::new(&cloud, &cloud.meta().materials[0].halves[0], medium.eta);
        for model in MODELS {
            let mut scatterer = Scatterer::new(model, &medium, 5e-3);
            for (estimator, normal) in ESTIMATORS
                .into_iter()
                .flat_map(|e| [DVec3::Z, DVec3::NEG_X, DVec3::new(0.6, -0.8, 0.0)].map(|n| (e, n)))
            {
                let exit = Exit::new(normal * 4e-3, normal, 77);
                let at_level = |level: Level| {
                    scatterer.level = level;
                    sum(&scatterer, &samples, &exit, estimator)
                };
                let sums: Vec<Sum> =
                    Level::ALL.into_iter().filter(|level| level.is_available()).map(at_level).collect();
                let bits = |s: &Sum| (s.radiance.to_array().map(f64::to_bits), s.evaluations, s.nodes);
                let same = sums.iter().all(|s| bits(s) == bits(&sums[0]));
                assert!(same, "{} {} {estimator:?}: {sums:?}", medium.name, model.name());
                lit += u32::from(sums[0].radiance.min_element() > 0.0);
            }
        }
    }
    assert!(lit > 120, "only {lit} of 162 sums are not zero");
}
