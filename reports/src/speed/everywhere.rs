//! Compares the time with that of the note's settings: the same samples and paths on every scene, medium and size of
//! cloud.

use crate::{
    error::Error,
    markdown::{count, table, three},
    speed::{
        configuration::{Configuration, MEDIA, Subject},
        findings::{Findings, Target},
        harness::Harness,
        shot::Shot,
    },
};

/// Seconds after which no further round is needed: the times of short runs vary most.
const ENOUGH: f64 = 3.0;
const MAX_ROUNDS: u32 = 6;

/// Measures every scene, medium and number of samples.
pub fn everywhere(harness: &mut Harness, subjects: &[Subject]) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let Some(note) = harness.configuration("note") else { return Ok(findings) };
    let counts = harness.effort.of(vec![1_000], vec![10_000, 100_000], vec![10_000, 100_000]);
    let (mut rows, mut worst) = (Vec::new(), 0.0f64);
    for subject in subjects {
        for medium in MEDIA {
            harness.say(&format!("{} {}: beside the note", subject.name, medium.name));
            for samples in &counts {
                let side = harness.effort.of(32, 256, 256);
                let shot = Shot { samples: *samples, spp: 4, size: [side; 2], ..harness.shot(subject, medium, note) };
                let [theirs, ours] = shortest(harness, &shot, [note, harness.all()])?;
                worst = worst.max(ours / theirs);
                let numbers = [theirs, ours, ours / theirs].map(three);
                let names = [subject.name.clone(), medium.name.into(), count(*samples)];
                rows.push(names.into_iter().chain(numbers).collect());
            }
        }
        harness.forget_clouds();
    }
    let what = "time over the note's, same K and paths, worst of all scenes, media and K from 10k";
    findings.targets.push(Target::at_most(what, 1.05, Some(worst), "measured"));
    let header = ["scene", "medium", "K", "note, s", "ours, s", "ours / note"];
    let text = "Both programs together, 4 paths a pixel, 256 x 256; the shortest of one to six runs in turn.";
    findings.section("Beside the note at equal settings", format!("{text}\n\n{}", table(&header, &rows)));
    Ok(findings)
}

/// Seconds of both programs, sampling included, for two configurations in alternation: the shortest of several
/// rounds.
fn shortest(harness: &mut Harness, shot: &Shot, rivals: [Configuration; 2]) -> Result<[f64; 2], Error> {
    let (mut least, mut spent) = ([f64::INFINITY; 2], 0.0);
    for _ in 0..MAX_ROUNDS {
        harness.forget_clouds();
        for (least, configuration) in least.iter_mut().zip(rivals) {
            let seconds = harness.take(&Shot { configuration, ..shot.clone() })?.seconds();
            *least = least.min(seconds);
            spent += seconds;
        }
        if spent > ENOUGH {
            break;
        }
    }
    Ok(least)
}
