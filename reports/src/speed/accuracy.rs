//! Tests `--accuracy`: one gather against the exhaustive sum over the same cloud.

use crate::{
    error::Error,
    markdown::{percent, table, three},
    speed::{
        configuration::{Configuration, EXHAUSTIVE, MEDIA, Subject, Summing},
        findings::{Findings, Target},
        harness::Harness,
        measure::difference,
        shot::Shot,
    },
};

/// Measures every medium with several accuracies.
pub fn accuracy(harness: &mut Harness, subjects: &[Subject]) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let what = "error of a gather over --accuracy, worst";
    let Some(cut) = harness.configuration("all").filter(|c| matches!(c.summing, Summing::Cut(_))) else {
        findings.targets.push(Target::at_most(what, 1.5, None, "`cut` is missing"));
        return Ok(findings);
    };
    let subjects = &subjects[..harness.effort.of(1, 1, subjects.len())];
    let (mut rows, mut worst) = (Vec::new(), 0.0f64);
    for subject in subjects {
        for medium in MEDIA {
            harness.say(&format!("{} {}: accuracy of one gather", subject.name, medium.name));
            let more = vec!["--filter".into(), "point".into()];
            let (size, samples) =
                (harness.effort.of([24, 24], [96, 54], [96, 54]), harness.effort.of(3_000, 100_000, 300_000));
            let shot = Shot { samples, size, more, ..harness.shot(subject, medium, EXHAUSTIVE) };
            let exact = harness.take(&shot)?;
            for x in [0.1, 0.03, 0.01, 0.003] {
                let configuration = Configuration { summing: Summing::Cut(Some(x)), ..cut };
                let taken = harness.take(&Shot { configuration, ..shot.clone() })?;
                let error = difference(&taken.picture, &exact.picture);
                harness.judge(&taken, error, None);
                worst = worst.max(error / x);
                let gathers = taken.gathering.number("gathers").unwrap_or(f64::NAN);
                let evaluations = taken.gathering.number("bssrdf_evaluations").unwrap_or(f64::NAN) / gathers;
                let numbers = [three(x), percent(error), three(error / x), three(evaluations)];
                rows.push([subject.name.clone(), medium.name.into()].into_iter().chain(numbers).collect());
            }
        }
        harness.forget_clouds();
    }
    findings.targets.push(Target::at_most(what, 1.5, Some(worst), "measured"));
    let header = ["scene", "medium", "--accuracy", "error", "error / accuracy", "evaluations a gather"];
    let text =
        "Relative RMSE over the image of single gathers against the sum over all samples, same cloud, same paths.";
    findings.section("Accuracy of a gather", format!("{text}\n\n{}", table(&header, &rows)));
    Ok(findings)
}
