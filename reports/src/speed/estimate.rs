//! Compares the error that `gather` estimates with the actual one.

use crate::{
    error::Error,
    markdown::{percent, table, three},
    speed::{
        configuration::{MEDIA, Medium, Subject},
        findings::{Findings, Target},
        harness::Harness,
        measure::root,
        reference::{Quality, reference},
        shot::Shot,
    },
};

/// Root mean squares over several seeds.
struct Found {
    estimated: f64,
    measured: f64,
    bias: f64,
    reference: f64,
}

/// Measures every scene and medium.
pub fn estimate(harness: &mut Harness, subjects: &[Subject]) -> Result<Findings, Error> {
    let (mut rows, mut worst) = (Vec::new(), 0.0f64);
    for subject in subjects {
        for medium in MEDIA {
            let found = one(harness, subject, medium)?;
            let ratio = found.estimated / found.measured;
            worst = worst.max((ratio - 1.0).abs());
            let shares = [found.estimated, found.measured].map(percent);
            let rest = [three(ratio), percent(found.bias), percent(found.reference)];
            rows.push([subject.name.clone(), medium.name.into()].into_iter().chain(shares).chain(rest).collect());
        }
        harness.forget_clouds();
    }
    let mut findings = Findings::default();
    let what = "estimated error of an image against the measured one, worst deviation";
    findings.targets.push(Target::at_most(what, 0.25, Some(worst), "measured"));
    let header = ["scene", "medium", "estimated", "measured", "ratio", "bias", "reference's own error"];
    let text = "Relative RMSE of whole images, root mean square over independent seeds of cloud and paths. The bias is \
                the mean brightness over the reference's, its own error included.";
    findings.section("The estimated error", format!("{text}\n\n{}", table(&header, &rows)));
    Ok(findings)
}

fn one(harness: &mut Harness, subject: &Subject, medium: Medium) -> Result<Found, Error> {
    let effort = harness.effort;
    let side = effort.of(32, 128, 128);
    let shot = Shot { size: [side; 2], ..harness.shot(subject, medium, harness.all()) };
    let quality = Quality { clouds: 4, samples: effort.of(20_000, 2_000_000, 2_000_000), spp: effort.of(4, 16, 16) };
    let converged = reference(harness, &shot, quality)?;
    let seeds = effort.of(2, 3, 3);
    let (mut estimated, mut measured, mut bias) = (0.0, 0.0, 0.0);
    for seed in 1..=seeds {
        let samples = effort.of(3_000, 300_000, 1_000_000);
        let taken = harness.take(&Shot { samples, spp: 16, cloud_seed: seed, gather_seed: seed, ..shot.clone() })?;
        let (squared, tilt) = (converged.squared_error(&taken.picture), converged.bias(&taken.picture));
        harness.judge(&taken, root(squared), Some(tilt));
        estimated += taken.gathering.number("estimated_relative_error").unwrap_or(f64::NAN).powi(2) / seeds as f64;
        measured += squared / seeds as f64;
        bias += tilt / seeds as f64;
    }
    let (estimated, measured) = (root(estimated), root(measured));
    Ok(Found { estimated, measured, bias, reference: converged.own_error() })
}
