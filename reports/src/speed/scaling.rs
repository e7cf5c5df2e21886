//! Several cameras on one cloud, numbers of threads, and image sizes.

use crate::{
    error::Error,
    markdown::{count, table, three},
    speed::{
        configuration::{MARBLE, Subject},
        findings::Findings,
        harness::Harness,
        shot::Shot,
    },
};

/// Measures all three.
pub fn scaling(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let samples = harness.effort.of(3_000, 1_000_000, 1_000_000);
    let side = harness.effort.of(32, 256, 256);
    let shot = Shot { samples, spp: 4, size: [side; 2], ..harness.shot(subject, MARBLE, harness.all()) };
    let mut findings = Findings::default();
    let setting = format!("{}, marble, K = {}, 4 paths a pixel", subject.name, count(samples));
    let size = format!("{side} x {side}");
    let text = format!("{setting}, {size}: every camera after the first costs a gather alone.");
    findings.section("Cameras off one cloud", format!("{text}\n\n{}", cameras(harness, &shot)?));
    findings.section("Threads", format!("{setting}, {size}.\n\n{}", threads(harness, &shot)?));
    findings.section("Sizes of the image", format!("{setting}.\n\n{}", sizes(harness, &shot)?));
    harness.forget_clouds();
    Ok(findings)
}

/// Ten cameras: those of the scene, cyclically.
fn cameras(harness: &mut Harness, shot: &Shot) -> Result<String, Error> {
    harness.say("ten cameras off one cloud");
    let (mut rows, mut sum) = (Vec::new(), 0.0);
    for number in 0..10 {
        let more = match shot.subject.cameras {
            0 => Vec::new(),
            cameras => vec!["--camera".into(), (number % cameras).to_string()],
        };
        let taken = harness.take(&Shot { more, ..shot.clone() })?;
        let cost = if number == 0 { taken.seconds() } else { taken.gathering.wall };
        sum += cost;
        if matches!(number, 0 | 1 | 2 | 9) {
            rows.push(vec![(number + 1).to_string(), three(cost), three(sum)]);
        }
    }
    Ok(table(&["camera", "its seconds", "seconds of all so far"], &rows))
}

/// Powers of two of threads, up to all.
fn threads(harness: &mut Harness, shot: &Shot) -> Result<String, Error> {
    let all = harness.threads;
    let mut counts: Vec<usize> = (0..).map(|power| 1 << power).take_while(|n| *n < all).collect();
    counts.push(all);
    let (mut rows, mut one) = (Vec::new(), None);
    for threads in counts {
        harness.say(&format!("{threads} threads"));
        let taken = harness.take(&Shot { threads, ..shot.clone() })?;
        let seconds = [taken.sampling.wall, taken.gathering.wall];
        let first = *one.get_or_insert(seconds);
        let speed_up = [0, 1].map(|k| three(first[k] / seconds[k]));
        rows.push([threads.to_string()].into_iter().chain(seconds.map(three)).chain(speed_up).collect());
    }
    let header = ["threads", "sampling, s", "gather, s", "sampling, times as fast", "gather, times as fast"];
    Ok(table(&header, &rows))
}

/// Squares of three sizes.
fn sizes(harness: &mut Harness, shot: &Shot) -> Result<String, Error> {
    let mut rows = Vec::new();
    for side in harness.effort.of([16, 32, 64], [128, 256, 512], [256, 512, 1024]) {
        harness.say(&format!("{side} x {side}"));
        let taken = harness.take(&Shot { size: [side; 2], ..shot.clone() })?;
        let paths = taken.gathering.number("paths").unwrap_or(f64::NAN);
        let cells = [taken.gathering.wall, 1e6 * taken.gathering.step("render") / paths].map(three);
        rows.push([format!("{side} x {side}")].into_iter().chain(cells).collect());
    }
    Ok(table(&["image", "gather, s", "render, µs a path"], &rows))
}
