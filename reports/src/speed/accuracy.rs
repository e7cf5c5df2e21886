//! Tests `--accuracy`: one gather against the same gather with a hundred times the accuracy and more.
//!
//! Both take the same light from near the exitant point, which has the same random numbers; what differs is the cut.

use crate::{
    error::Error,
    markdown::{count, percent, table, three},
    speed::{
        configuration::{Configuration, DEFAULTS, MEDIA, Medium, Subject, Summing},
        findings::{Findings, Target},
        harness::Harness,
        measure::difference,
        shot::Shot,
    },
};

/// An accuracy with which the cut is as good as exact.
const EXACT: f64 = 3e-5;

/// The accuracy of which all media are asked.
const ASKED: f64 = 0.01;

/// The most that an error should exceed its accuracy by.
const WANTED: f64 = 1.5;

/// The media of the second table: those whose errors exceed their accuracy by most.
const SHOWN: usize = 8;

/// Measures four media with several accuracies, and all media from the lit and the unlit side.
pub fn accuracy(harness: &mut Harness, subjects: &[Subject]) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let subjects = &subjects[..harness.effort.of(1, 1, subjects.len())];
    let (mut rows, mut worst) = (Vec::new(), 0.0f64);
    for subject in subjects {
        for medium in MEDIA {
            harness.say(&format!("{} {}: accuracy of one gather", subject.name, medium.name));
            let size = harness.effort.of([24, 24], [96, 54], [96, 54]);
            for found in of_one(harness, subject, medium, size, &[0.1, 0.03, 0.01, 0.003])? {
                worst = worst.max(found.excess());
                let numbers =
                    [three(found.asked), percent(found.error), three(found.excess()), three(found.evaluations)];
                rows.push([subject.name.clone(), medium.name.into()].into_iter().chain(numbers).collect());
            }
        }
        harness.forget_clouds();
    }
    findings.targets.push(Target::at_most("error of a gather over --accuracy, worst", WANTED, Some(worst), "measured"));
    let header = ["scene", "medium", "--accuracy", "error", "error / accuracy", "evaluations a gather"];
    let text = "Relative RMSE over the image of single gathers against the same with an accuracy of 0.00003, same \
                cloud, same paths.";
    findings.section("Accuracy of a gather", format!("{text}\n\n{}", table(&header, &rows)));
    findings.add(everywhere(harness, &subjects[0])?);
    Ok(findings)
}

/// All media from the first two cameras of a scene, of which one should see its lit side and one its unlit side.
fn everywhere(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let all = bssrdf::built_in_names().map(|name| Medium { name, rule: "mixture" });
    let media: Vec<Medium> = all.take(harness.effort.of(2, usize::MAX, usize::MAX)).collect();
    let size = harness.effort.of([24, 24], [64, 36], [96, 54]);
    let mut found = Vec::new();
    for camera in 0..subject.cameras.min(2) {
        harness.say(&format!("{}: accuracy of one gather in all media, camera {camera}", subject.name));
        let view = vec!["--camera".into(), camera.to_string()];
        let subject = Subject { view, ..subject.clone() };
        for medium in &media {
            let of_medium = of_one(harness, &subject, *medium, size, &[ASKED])?;
            found.extend(of_medium.into_iter().map(|found| (medium.name, camera, found)));
        }
    }
    harness.forget_clouds();
    found.sort_by(|(_, _, a), (_, _, b)| b.excess().total_cmp(&a.excess()));
    let worst = found.first().map(|(_, _, found)| found.excess());
    let what = format!("error of a gather over --accuracy, worst of {} media, lit and unlit", media.len());
    findings.targets.push(Target::at_most(what, WANTED, worst, "measured"));
    let row = |(medium, camera, found): &(&str, usize, Found)| {
        vec![(*medium).to_owned(), camera.to_string(), percent(found.error), three(found.excess())]
    };
    let rows: Vec<_> = found.iter().take(SHOWN).map(row).collect();
    let text = format!(
        "As above with --accuracy {ASKED}, in {} media and from two cameras of {}; the {SHOWN} worst.",
        count(media.len() as u64),
        subject.name
    );
    let header = ["medium", "camera", "error", "error / accuracy"];
    findings.section("Accuracy of a gather in all media", format!("{text}\n\n{}", table(&header, &rows)));
    Ok(findings)
}

/// The error of the gathers of one image.
struct Found {
    asked: f64,
    /// Relative RMSE.
    error: f64,
    /// Samples that a gather evaluates.
    evaluations: f64,
}

impl Found {
    fn excess(&self) -> f64 {
        self.error / self.asked
    }
}

/// Measures one medium with these accuracies.
fn of_one(
    harness: &mut Harness,
    subject: &Subject,
    medium: Medium,
    size: [u64; 2],
    accuracies: &[f64],
) -> Result<Vec<Found>, Error> {
    let with = |x: f64| Configuration { summing: Summing::Cut(Some(x)), ..DEFAULTS };
    let samples = harness.effort.of(3_000, 100_000, 300_000);
    let more = vec!["--filter".into(), "point".into()];
    let shot = Shot { samples, size, more, ..harness.shot(subject, medium, with(EXACT)) };
    let exact = harness.take(&shot)?.picture;
    let of = |x: f64| {
        let taken = harness.take(&Shot { configuration: with(x), ..shot.clone() })?;
        let error = difference(&taken.picture, &exact);
        harness.judge(&taken, error, None);
        let number = |name: &str| taken.gathering.number(name).unwrap_or(f64::NAN);
        Ok(Found { asked: x, error, evaluations: number("bssrdf_evaluations") / number("gathers") })
    };
    accuracies.iter().copied().map(of).collect()
}
