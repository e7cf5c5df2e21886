//! A full-size frame: the dragon of marble, 1920 x 1080, to one per cent of estimated error.

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

/// The most seconds that the frame should take, and the most paths of a pixel.
const SECONDS: f64 = 60.0;
const MOST_PATHS: u64 = 4096;

/// Renders the frame with paths to the target error, as anybody would: their number is what it takes.
pub fn frame(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let size = harness.effort.of([96, 54], [1920, 1080], [1920, 1080]);
    // So many samples lie close enough that almost no light enters between them.
    let samples = harness.effort.of(10_000, 8_000_000, 8_000_000);
    let more = vec!["--target-error".into(), ERROR.to_string()];
    let shot = Shot { size, samples, spp: MOST_PATHS, more, ..harness.shot(subject, MARBLE, DEFAULTS) };
    harness.say(&format!("frame: K {}, to {}", count(samples), percent(ERROR)));
    let taken = harness.take(&shot)?;
    let mut findings = Findings::default();
    findings.section(format!("A frame of {} x {}", size[0], size[1]), costs(&taken, size));
    harness.forget_clouds();
    let what = format!("{}, marble, {} x {}: seconds to 1 % estimated error", subject.name, size[0], size[1]);
    let reached = estimate(&taken) <= ERROR;
    let basis = format!("measured, {}", percent(estimate(&taken)));
    findings.targets.push(Target::at_most(what, SECONDS, reached.then(|| taken.seconds()), basis));
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
