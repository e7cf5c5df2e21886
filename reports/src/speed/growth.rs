//! The cost of more samples: both programs from 10^4 samples up.

use crate::{
    error::Error,
    markdown::{count, table, three},
    speed::{
        configuration::{DEFAULT_PATHS, DEFAULT_SAMPLES, DEFAULTS, MARBLE, Subject},
        findings::{Findings, Target},
        harness::{Harness, Taken},
        plot::{Curve, Plot},
        shot::Shot,
    },
};

/// Seconds and gigabytes against samples.
pub fn growth(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let effort = harness.effort;
    let counts = effort.of(
        vec![1_000, 10_000, 100_000],
        vec![10_000, 100_000, DEFAULT_SAMPLES, 10_000_000, 100 * DEFAULT_SAMPLES],
        vec![10_000, 100_000, DEFAULT_SAMPLES, 10_000_000, 100 * DEFAULT_SAMPLES],
    );
    let side = effort.of(32, 256, 256);
    let shot = Shot { spp: DEFAULT_PATHS, size: [side; 2], ..harness.shot(subject, MARBLE, DEFAULTS) };
    let (mut rows, mut ours) = (Vec::new(), Vec::new());
    for samples in counts {
        harness.say(&format!("growth: K {}", count(samples)));
        match harness.take(&Shot { samples, ..shot.clone() }) {
            Ok(taken) => {
                rows.push(row(samples, &taken));
                ours.push((samples as f64, taken.sampling.wall, taken.gathering.wall));
            }
            Err(e) => match e.refusal() {
                Some(why) => harness.remarks.push(format!("K = {} was left out: {why}", count(samples))),
                None => return Err(e),
            },
        }
        harness.forget_clouds();
    }
    let note = note(harness, &shot)?;
    let seconds = |samples: u64| ours.iter().find(|o| o.0 == samples as f64).map(|o| o.2);
    let grown = seconds(DEFAULT_SAMPLES).zip(seconds(100 * DEFAULT_SAMPLES)).map(|(few, many)| many / few);
    let mut findings = Findings::default();
    let what = format!("{}, marble: time of the gather when K grows from 1M to 100M", subject.name);
    findings.targets.push(Target::at_most(what, 1.5, grown, "measured"));
    let header = ["K", "sampling, s", "gather, s", "evaluations a gather", "nodes a gather", "memory of both, MB"];
    let text = format!(
        "{}, marble, {side} x {side}, {DEFAULT_PATHS} paths a pixel.\n\n{}",
        subject.name,
        table(&header, &rows)
    );
    findings.plotted("What samples cost", "growth", plot(&ours, note), text);
    Ok(findings)
}

/// Seconds of the note's settings, for clouds that they gather in reasonable time.
fn note(harness: &mut Harness, shot: &Shot) -> Result<Vec<(f64, f64)>, Error> {
    let Some(note) = harness.configuration("note") else { return Ok(Vec::new()) };
    let mut points = Vec::new();
    for samples in harness.effort.of(vec![1_000, 3_000], vec![3_000, 10_000], vec![10_000, 100_000]) {
        let taken = harness.take(&Shot { samples, configuration: note, ..shot.clone() })?;
        points.push((samples as f64, taken.gathering.wall));
    }
    harness.forget_clouds();
    Ok(points)
}

fn row(samples: u64, taken: &Taken) -> Vec<String> {
    let a_gather = |name: &str| {
        let pair = taken.gathering.number(name).zip(taken.gathering.number("gathers"));
        pair.map_or("–".into(), |(n, gathers)| three(n / gathers.max(1.0)))
    };
    let memory = [&taken.sampling, &taken.gathering].map(|s| s.number("peak_memory_bytes").map_or(0.0, |b| b / 1e6));
    vec![
        count(samples),
        three(taken.sampling.wall),
        three(taken.gathering.wall),
        a_gather("bssrdf_evaluations"),
        a_gather("nodes_visited"),
        memory.map(three).join(", "),
    ]
}

fn plot(ours: &[(f64, f64, f64)], note: Vec<(f64, f64)>) -> Plot {
    let curve =
        |label: &str, points: Vec<(f64, f64)>| Curve { label: label.into(), line: points.clone(), dots: points };
    Plot {
        title: "Seconds of each program".into(),
        x: "samples K".into(),
        y: "seconds".into(),
        curves: vec![
            curve("gather, note", note),
            curve("gather, ours", ours.iter().map(|o| (o.0, o.2)).collect()),
            curve("sample-surface, ours", ours.iter().map(|o| (o.0, o.1)).collect()),
        ],
    }
}
