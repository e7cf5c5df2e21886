//! Objects of any size: samples of one million lie farther apart than light travels on the larger ones.

use crate::{
    error::Error,
    markdown::{percent, table, three},
    speed::{
        configuration::{DEFAULT_PATHS, DEFAULT_SAMPLES, DEFAULTS, MARBLE, Subject},
        findings::{Findings, Target},
        harness::Harness,
        measure::root,
        reference::{Quality, reference},
        shot::Shot,
    },
};

/// How many times the size of the scene's file, the flags that make it so, and the largest error that is wanted.
const SIZES: [(&str, &[&str], f64); 3] = [
    ("1", &["--metres-per-unit", "1"], 0.015),
    ("10", &["--metres-per-unit", "10"], 0.03),
    ("100", &["--metres-per-unit", "100"], 0.04),
];

/// Measures the error of the defaults on a scene of several sizes.
pub fn sizes(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let effort = harness.effort;
    let side = effort.of(32, 256, 256);
    let mut rows = Vec::new();
    for (times, flags, wanted) in SIZES {
        let subject = Subject { flags, ..subject.clone() };
        let shot = Shot { size: [side; 2], ..harness.shot(&subject, MARBLE, DEFAULTS) };
        let quality =
            Quality { clouds: 4, samples: effort.of(10_000, 4_000_000, 16_000_000), spp: effort.of(4, 64, 256) };
        let converged = reference(harness, &shot, quality)?;
        let samples = effort.of(10_000, DEFAULT_SAMPLES, DEFAULT_SAMPLES);
        let taken = harness.take(&Shot { samples, spp: effort.of(2, DEFAULT_PATHS, DEFAULT_PATHS), ..shot })?;
        let error = root(converged.squared_error(&taken.picture));
        harness.judge(&taken, error, Some(converged.bias(&taken.picture)));
        let what = format!("{} x {times}, marble, defaults: relative RMSE, %", subject.name);
        findings.targets.push(Target::at_most(what, 100.0 * wanted, Some(100.0 * error), "measured"));
        let number = |name: &str| taken.gathering.number(name).unwrap_or(f64::NAN);
        let near = number("near_points") / number("gathers");
        let own = percent(converged.own_error());
        rows.push(vec![times.to_owned(), percent(error), own, three(taken.cpu()), three(near)]);
        harness.forget_clouds();
    }
    let text = format!(
        "{}, marble, {side} x {side}, {DEFAULT_PATHS} paths, K = 1M, scaled with its lights; against the same model \
         converged. Points near the exitant points take the place of samples that lie too far apart.",
        subject.name
    );
    let header = ["size", "relative RMSE", "the reference's own", "CPU s of both programs", "near points a gather"];
    findings.section("Objects of any size", format!("{text}\n\n{}", table(&header, &rows)));
    Ok(findings)
}
