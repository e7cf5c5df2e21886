//! Frames as anybody would render them, to one per cent of estimated error: a full-size one of the dragon, and a small one
//! of the bunny, of marble.

use crate::{
    error::Error,
    markdown::{count, percent, table, three, time},
    speed::{
        configuration::{DEFAULTS, MARBLE, Subject},
        findings::{Findings, Target},
        harness::{Harness, Taken},
        shot::Shot,
    },
};

/// The target error, as `gather` estimates it.
const ERROR: f64 = 0.01;

/// The most paths of a pixel.
const MOST_PATHS: u64 = 4096;

/// A frame.
struct Frame {
    size: [u64; 2],
    samples: u64,
    /// The most seconds that it should take, sampling included.
    seconds: f64,
}

/// So many samples lie close enough that almost no light enters between them.
const LARGE: Frame = Frame { size: [1920, 1080], samples: 8_000_000, seconds: 60.0 };

/// As many samples as by default.
const SMALL: Frame = Frame { size: [512, 512], samples: 1_000_000, seconds: 3.0 };

/// Renders both frames with as many paths as the target error takes.
pub fn frames(harness: &mut Harness, [large, small]: [&Subject; 2]) -> Result<Findings, Error> {
    let mut findings = frame(harness, large, &LARGE)?;
    findings.add(frame(harness, small, &SMALL)?);
    Ok(findings)
}

fn frame(harness: &mut Harness, subject: &Subject, frame: &Frame) -> Result<Findings, Error> {
    let size = harness.effort.of([96, 54], frame.size, frame.size);
    let samples = harness.effort.of(10_000, frame.samples, frame.samples);
    let more = vec!["--target-error".into(), ERROR.to_string()];
    let shot = Shot { size, samples, spp: MOST_PATHS, more, ..harness.shot(subject, MARBLE, DEFAULTS) };
    harness.say(&format!("{}, frame: K {}, to {}", subject.name, count(samples), percent(ERROR)));
    let taken = harness.take(&shot)?;
    let mut findings = Findings::default();
    findings.section(format!("A frame of {} x {}: {}", size[0], size[1], subject.name), costs(&taken, size));
    harness.forget_clouds();
    let what = format!("{}, marble, {} x {}: seconds to 1 % estimated error", subject.name, size[0], size[1]);
    let reached = estimate(&taken) <= ERROR;
    let basis = format!("measured, {}", percent(estimate(&taken)));
    findings.targets.push(Target::at_most(what, frame.seconds, reached.then(|| taken.seconds()), basis));
    Ok(findings)
}

/// Estimated error.
fn estimate(taken: &Taken) -> f64 {
    taken.gathering.number("estimated_relative_error").unwrap_or(f64::NAN)
}

/// The costs of the steps of both programs, the three largest first.
fn costs(taken: &Taken, size: [u64; 2]) -> String {
    let mut steps = Vec::new();
    for (program, spent) in [("sample-surface", &taken.sampling), ("gather", &taken.gathering)] {
        let seconds = spent.statistics["seconds"].as_object();
        let named = seconds.into_iter().flatten().filter(|(step, _)| *step != "total");
        steps.extend(named.map(|(step, s)| (format!("{program}: {step}"), s.as_f64().unwrap_or(0.0))));
    }
    steps.sort_by(|a, b| b.1.total_cmp(&a.1));
    let total = taken.seconds();
    let rows: Vec<_> = steps.iter().take(3).map(|(n, s)| vec![n.clone(), three(*s), percent(s / total)]).collect();
    let number = |key: &str| taken.gathering.number(key).unwrap_or(0.0);
    format!(
        "K = {}, {} paths a pixel on average, {} to {} by the noise of the pixels around: {}, estimated error {}. The \
         three largest costs:\n\n{}",
        count(number("samples_drawn") as u64),
        three(number("paths") / (size[0] * size[1]) as f64),
        number("fewest_paths_of_a_pixel"),
        number("most_paths_of_a_pixel"),
        time(total),
        percent(estimate(taken)),
        table(&["step", "seconds", "share"], &rows)
    )
}
