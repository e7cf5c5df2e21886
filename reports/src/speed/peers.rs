//! Comparison with other renderers: relMSE over the object times CPU seconds.

use crate::{
    error::Error,
    markdown::{count, table, three},
    speed::{
        configuration::{DEFAULT_PATHS, DEFAULT_SAMPLES, DEFAULTS, MARBLE, Medium, SKIM_MILK, Subject, Subjects},
        findings::{Findings, Target},
        harness::Harness,
        measure::Reference,
        reference::{Quality, reference},
        shot::Shot,
    },
};

/// The best relMSE times CPU seconds of another renderer on each scene, each against its own converged image: POV-Ray
/// 3.7 (dipole, 200 samples; biased) on the sphere, Cycles 4.5 (Burley) on the bunny; 128 x 128, on a similar
/// machine.
const BEST_ON_SPHERE: (&str, f64) = ("POV-Ray 3.7, dipole", 0.0003);
const BEST_ON_BUNNY: (&str, f64) = ("Cycles 4.5, Burley", 0.0085);

/// Side of the image, pixels.
const SIDE: u64 = 128;

/// Means over the seeds, for one number of samples and paths.
struct Point {
    samples: u64,
    spp: u64,
    relative_mse: f64,
    cpu: f64,
}

impl Point {
    fn product(&self) -> f64 {
        self.relative_mse * self.cpu
    }

    fn is_default(&self) -> bool {
        (self.samples, self.spp) == (DEFAULT_SAMPLES, DEFAULT_PATHS)
    }
}

/// Measures both scenes, if they are there.
pub fn peers(harness: &mut Harness, subjects: &Subjects) -> Result<Findings, Error> {
    let mut findings = Findings::default();
    let pairs =
        [(&subjects.sphere_of_peers, SKIM_MILK, BEST_ON_SPHERE), (&subjects.bunny_of_peers, MARBLE, BEST_ON_BUNNY)];
    let mut rows = Vec::new();
    for (subject, medium, (peer, best)) in pairs {
        let Some(subject) = subject else { continue };
        let points = scene(harness, subject, medium)?;
        let ours = points.iter().find(|point| point.is_default()).map(Point::product);
        let what = format!("{}, {}: {peer} over our defaults, relMSE x CPU s", subject.name, medium.name);
        let found = ours.map_or("–".into(), three);
        let basis = format!("theirs {} (measured before), ours {found} (measured)", three(best));
        findings.targets.push(Target::at_least(what, 30.0, ours.map(|ours| best / ours), basis));
        rows.extend(points.iter().map(|p| row(subject, medium, p)));
    }
    let header = ["scene", "medium", "K", "paths a pixel", "relMSE", "CPU s", "product"];
    let text = "The half-space model without a calibration, against itself converged, as the others are. Whole processes on \
                one thread, sampling included; relMSE is the mean of (t - r)² / (r² + 0.01) over \
                the object, 128 x 128, means over seeds of cloud and paths.\n\n";
    findings.section("Beside other renderers", format!("{text}{}", table(&header, &rows)));
    Ok(findings)
}

fn row(subject: &Subject, medium: Medium, p: &Point) -> Vec<String> {
    let numbers = [p.relative_mse, p.cpu, p.product()].map(three);
    let names = [subject.name.clone(), medium.name.into(), count(p.samples), p.spp.to_string()];
    names.into_iter().chain(numbers).collect()
}

/// Measures all numbers of samples and paths on one scene.
fn scene(harness: &mut Harness, subject: &Subject, medium: Medium) -> Result<Vec<Point>, Error> {
    let effort = harness.effort;
    let side = effort.of(32, SIDE, SIDE);
    let shot = Shot { size: [side; 2], threads: 1, ..harness.shot(subject, medium, DEFAULTS) };
    let quality = Quality { clouds: 4, samples: effort.of(20_000, 4_000_000, 8_000_000), spp: effort.of(4, 32, 128) };
    let converged = reference(harness, &shot, quality)?;
    let mut points = Vec::new();
    for samples in effort.of(vec![1_000], vec![DEFAULT_SAMPLES], vec![100_000, DEFAULT_SAMPLES]) {
        for spp in effort.of(vec![1], vec![4, DEFAULT_PATHS, 64], vec![4, DEFAULT_PATHS, 64]) {
            points.push(point(harness, &Shot { samples, spp, ..shot.clone() }, &converged)?);
        }
    }
    harness.forget_clouds();
    Ok(points)
}

fn point(harness: &mut Harness, shot: &Shot, reference: &Reference) -> Result<Point, Error> {
    let seeds = harness.effort.of(2, 3, 3);
    harness.say(&format!("{} {}: K {}, {} paths", shot.subject.name, shot.medium.name, count(shot.samples), shot.spp));
    let (mut error, mut cpu) = (0.0, 0.0);
    for seed in 1..=seeds {
        let one = Shot { cloud_seed: seed, gather_seed: seed, ..shot.clone() };
        let taken = harness.take(&one)?;
        error += reference.relative_mse(&taken.picture) / seeds as f64;
        cpu += taken.cpu() / seeds as f64;
    }
    let (samples, spp) = (shot.samples, shot.spp);
    // A mean below the noise of the reference cannot be told from zero, and counts as no measurement.
    let relative_mse = if error > 0.0 { error } else { f64::INFINITY };
    Ok(Point { samples, spp, relative_mse, cpu })
}
