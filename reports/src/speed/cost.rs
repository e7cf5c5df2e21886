//! What the half-space model and its calibration cost.

use crate::{
    error::Error,
    markdown::{count, table, three},
    speed::{
        configuration::{Configuration, MARBLE, SKIM_MILK, Subject},
        findings::{Findings, Target},
        harness::Harness,
        shot::Shot,
    },
};
use bssrdf::Model;

/// Number of runs of which the shortest counts.
const ROUNDS: u32 = 3;

/// Measures both on one scene.
pub fn cost(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let samples = harness.effort.of(3_000, 1_000_000, 1_000_000);
    let [side, large] = harness.effort.of([32, 64], [256, 512], [256, 512]);
    let dipole = harness.all();
    let ours = Configuration { model: Model::HalfSpace, ..dipole };
    let (mut rows, mut worst) = (Vec::new(), 0.0f64);
    for medium in [MARBLE, SKIM_MILK] {
        harness.say(&format!("{} {}: cost of the model", subject.name, medium.name));
        let shot = Shot { samples, spp: 4, size: [side; 2], threads: 1, ..harness.shot(subject, medium, dipole) };
        let mut least = [f64::INFINITY; 2];
        for _ in 0..ROUNDS {
            for (least, configuration) in least.iter_mut().zip([dipole, ours]) {
                *least = harness.take(&Shot { configuration, ..shot.clone() })?.gathering.cpu.min(*least);
            }
        }
        let [theirs, own] = least;
        worst = worst.max(own / theirs);
        let what = format!("gather, {}, half-space over directional dipole", medium.name);
        rows.push(vec![what, three(own), three(theirs), three(own / theirs)]);
    }
    let what = "gather half-space over directional dipole at equal K and paths, CPU s";
    findings.targets.push(Target::at_most(what, 1.3, Some(worst), "measured"));
    harness.say(&format!("{} marble: cost of a calibration", subject.name));
    let walks = Some(harness.effort.of(3_000, 300_000, 300_000));
    let image = Shot { samples, spp: 16, size: [large; 2], walks, threads: 1, ..harness.shot(subject, MARBLE, ours) };
    let taken = harness.take(&image)?;
    let (calibration, gather) = (taken.calibrating.map_or(f64::NAN, |c| c.cpu), taken.gathering.cpu);
    let what = format!("calibration, marble, over an image of {large} x {large} and 16 paths");
    rows.push(vec![what, three(calibration), three(gather), three(calibration / gather)]);
    let what = format!("{}: calibration of marble over an image of {large} x {large}, 16 paths, CPU s", subject.name);
    findings.targets.push(Target::at_most(what, 1.0, Some(calibration / gather), "measured"));
    harness.forget_clouds();
    let text = format!(
        "{}, K = {}, one thread, 4 paths a pixel of {side} x {side} unless stated; the least of {ROUNDS} runs in turn. A \
         calibration follows the default number of walks, 300k of each channel, and serves all cameras.",
        subject.name,
        count(samples)
    );
    let header = ["", "CPU s", "over CPU s", "ratio"];
    findings.section("What the model and its calibration cost", format!("{text}\n\n{}", table(&header, &rows)));
    Ok(findings)
}
