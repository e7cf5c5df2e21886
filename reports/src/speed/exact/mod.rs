//! Time against the error to the truth: the note, the dipoles, the calibrated model and random walks, beside what is
//! known of other renderers.

mod others;
mod report;
mod ways;

use crate::{
    error::Error,
    markdown::count,
    speed::{
        configuration::{MARBLE, Medium, SKIM_MILK, Subject, Subjects},
        findings::{Findings, Target},
        harness::Harness,
        shot::Shot,
    },
    truth::{BLOCK, Exact, Scattered, Shot as TruthShot, Truth},
};
use others::{ON_BUNNY, ON_SPHERE, Other};
use ways::{REFERENCE, Step, Way, ways};

/// Side of the images, pixels.
const SIDE: u64 = 128;

/// First seed of the runs: the truths have taken the lowest.
const SEED: u64 = 100;

/// Error and cost of one image.
struct Run {
    step: Step,
    /// CPU seconds of all programs, and those of `gather` alone.
    cpu: f64,
    gather: f64,
    /// relMSE to the truth of each channel, by pixels and by blocks of 4 x 4.
    pixels: [f64; 3],
    blocks: [f64; 3],
    /// Mean light over that of the truth.
    ratio: [f64; 3],
}

impl Run {
    /// Mean of the channels, by pixels.
    fn error(&self) -> f64 {
        self.pixels.iter().sum::<f64>() / 3.0
    }
}

/// One scene with one medium.
struct Race<'a> {
    subject: &'a Subject,
    medium: Medium,
    others: &'static [Other],
    /// relMSE of a black image.
    black: f64,
    runs: Vec<(Way, Vec<Run>)>,
}

/// Measures both scenes, if they are there.
pub fn exact(harness: &mut Harness, subjects: &Subjects, truths: &Exact) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    findings.section("Time against the error to the truth", report::INTRODUCTION.into());
    let scenes: [(_, _, &'static [Other]); 2] =
        [(&subjects.sphere_of_peers, SKIM_MILK, &ON_SPHERE), (&subjects.bunny_of_peers, MARBLE, &ON_BUNNY)];
    for (subject, medium, others) in scenes {
        let Some(subject) = subject else { continue };
        let race = race(harness, subject, medium, others, truths)?;
        if medium == SKIM_MILK {
            findings.targets.push(race.reference_target());
        }
        report::add(&mut findings, &race);
    }
    Ok(findings)
}

fn race<'a>(
    harness: &mut Harness,
    subject: &'a Subject,
    medium: Medium,
    others: &'static [Other],
    truths: &Exact,
) -> Result<Race<'a>, Error> {
    let effort = harness.effort;
    let side = effort.of(32, SIDE, SIDE);
    let paths = effort.of(4, 64, 256);
    let names = format!("{}, {}", subject.name, medium.name);
    harness.say(&format!("{names}: truth, twice {paths} paths"));
    let shared: Vec<String> = subject.flags.iter().map(|f| (*f).to_owned()).collect();
    let (scene, view) = (subject.path.as_path(), &subject.view[..]);
    let truth = TruthShot { scene, medium: medium.name, shared: &shared, view, side: side as u32 };
    let truth = truths.truth(&truth, paths)?;
    let mut runs = Vec::new();
    for way in ways(effort) {
        let shot = Shot {
            size: [side; 2],
            threads: 1,
            cloud_seed: SEED,
            gather_seed: SEED,
            ..harness.shot(subject, medium, way.configuration)
        };
        let mut own = Vec::new();
        for step in &way.steps {
            harness.say(&format!("{names}: {}, K {}, {} paths", way.label, count(step.samples), step.spp));
            own.push(run(harness, &shot, *step, &truth)?);
        }
        runs.push((way, own));
    }
    harness.forget_clouds();
    let mut black = truth.mean();
    black.pixels.fill([0.0; 3]);
    let black = truth.relative_mse(&black, 1, WHITE).iter().sum::<f64>() / 3.0;
    Ok(Race { subject, medium, others, black, runs })
}

/// The lights of both scenes have an irradiance of π across them.
const WHITE: f64 = 1.0;

fn run(harness: &mut Harness, shot: &Shot, step: Step, truth: &Truth) -> Result<Run, Error> {
    let Step { samples, spp, walks } = step;
    let taken = harness.take(&Shot { samples, spp, walks, ..shot.clone() })?;
    let scattered = Scattered::read(&taken.file)?;
    let [pixels, blocks] = [1, BLOCK].map(|block| truth.relative_mse(&scattered, block, WHITE));
    let run =
        Run { step, cpu: taken.cpu(), gather: taken.gathering.cpu, pixels, blocks, ratio: truth.ratio(&scattered) };
    harness.judge_truth(&taken, run.error());
    Ok(run)
}

impl Race<'_> {
    fn way(&self, label: &str) -> &[Run] {
        self.runs.iter().find(|(way, _)| way.label == label).map_or(&[], |(_, runs)| runs)
    }

    fn reference_target(&self) -> Target {
        let what = format!("{}, {}: {REFERENCE}, relMSE x CPU s", self.subject.name, self.medium.name);
        Target::at_most(what, 0.1, self.reference_product(), "measured")
    }

    /// relMSE times CPU seconds of the longest run of the exact solution.
    fn reference_product(&self) -> Option<f64> {
        self.way(REFERENCE).last().map(|run| run.error() * run.cpu)
    }
}
