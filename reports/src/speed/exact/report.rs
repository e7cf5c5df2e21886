//! The section of one scene: plot, text and tables.

use crate::{
    markdown::{count, table, three},
    speed::{
        exact::{
            Race, Run,
            others::Floor,
            ways::{CALIBRATED, REFERENCE},
        },
        findings::Findings,
        plot::{Curve, Plot},
    },
};

/// Adds the section of a scene.
pub fn add(findings: &mut Findings, race: &Race) {
    let names = format!("{}, {}", race.subject.name, race.medium.name);
    let name = format!("truth-{}", race.subject.name.split(' ').next().unwrap_or_default());
    findings.plotted(format!("To the truth: {names}"), name, plot(race, &names), text(race));
}

fn plot(race: &Race, names: &str) -> Plot {
    let mut curves = Vec::new();
    for (way, runs) in &race.runs {
        let mut own = curve(way.label, runs, |run| run.cpu);
        if way.label == REFERENCE {
            // Its error is noise, which falls as 1/time.
            own.line.extend(race.reference_product().map(|product| (REACH, product / REACH)));
        }
        curves.push(own);
        if way.label == CALIBRATED {
            curves.push(curve("the same, next camera", runs, |run| run.gather));
        }
    }
    curves.extend(race.others.iter().filter(|o| o.floor != Floor::OtherLight).map(|o| o.curve(RANGE, race.black)));
    Plot {
        title: format!("Error to the truth: {names}"),
        x: "CPU seconds of all programs".into(),
        y: "relMSE to the exact image".into(),
        curves,
    }
}

/// CPU seconds up to which exact walks are drawn beyond their runs.
const REACH: f64 = 100.0;

/// CPU seconds in which other renderers are drawn.
const RANGE: [f64; 2] = [0.3, 30.0];

fn curve(label: &str, runs: &[Run], seconds: impl Fn(&Run) -> f64) -> Curve {
    let points: Vec<(f64, f64)> = runs.iter().map(|r| (seconds(r), r.error())).filter(|p| p.1 > 0.0).collect();
    Curve { label: label.into(), line: points.clone(), dots: points }
}

fn text(race: &Race) -> String {
    format!(
        "{}\n\n{}\nOther renderers: pbrt-v3 (photon beam diffusion), Cycles 4.5, POV-Ray 3.7, Mitsuba 3.9.\n\n{}",
        reading(race),
        runs(race),
        others(race)
    )
}

/// What the figures say.
fn reading(race: &Race) -> String {
    let last = |label: &str| race.way(label).last();
    let of = |run: Option<&Run>| run.map_or("–".into(), |r| three(r.error()));
    let dipoles = ["directional-dipole", "better-dipole", "standard-dipole"].map(|m| of(last(m)));
    let catch = race.reference_product().zip(last(CALIBRATED)).filter(|(_, run)| run.error() > 0.0);
    let catch = catch.map_or("–".into(), |(product, run)| three(product / run.error()));
    let parts = last(CALIBRATED).map_or(["–", "–"].map(String::from), |r| [r.cpu - r.gather, r.gather].map(three));
    format!(
        "The dipoles end on {} (directional), {} (better) and {} (standard), however long they run; the \
         half-space model ends on {} as it is, and on {} calibrated, of which the cloud and its calibration take {} CPU \
         s, once for all cameras, and the image {}. Random walks from the camera have no floor, and are as good after \
         {catch} CPU s of each image.",
        dipoles[0],
        dipoles[1],
        dipoles[2],
        of(last("half-space")),
        of(last(CALIBRATED)),
        parts[0],
        parts[1],
    )
}

/// What the figures of both scenes mean.
pub const INTRODUCTION: &str = "\
The error of the scattered light to the exact image, of model, cloud and paths together. relMSE is the mean over the \
object of (t - a)(t - b)/(r² + 0.01), with two independent exact images a and b and their mean r, so that it is free \
of their noise; the plots have the mean of the channels. CPU seconds are of whole processes on one thread: sampling, \
calibration and image; `next camera` is what another image of the same cloud and calibration takes. In the plots, the \
samples, paths and walks of each way grow together. Other renderers are drawn from their measured figures, as the \
error of the converged image plus noise that falls as 1/time; the thin lines have no runs.
";

fn runs(race: &Race) -> String {
    let numbers = |v: [f64; 3]| v.map(three).join(" ");
    let mut rows = Vec::new();
    for (way, runs) in &race.runs {
        for run in runs {
            let samples = if way.label == REFERENCE { "–".into() } else { count(run.step.samples) };
            let walks = run.step.walks.map_or("–".into(), count);
            let seconds = [run.cpu, run.gather].map(three);
            let errors = [run.pixels, run.blocks, run.ratio].map(numbers);
            let names = [way.label.to_owned(), samples, run.step.spp.to_string(), walks];
            rows.push(names.into_iter().chain(seconds).chain(errors).collect());
        }
    }
    let header = [
        "way",
        "K",
        "paths a pixel",
        "walks",
        "CPU s",
        "next camera",
        "relMSE, R G B",
        "in blocks of 4 x 4 pixels",
        "mean over truth",
    ];
    table(&header, &rows)
}

fn others(race: &Race) -> String {
    let rows: Vec<Vec<String>> = race
        .others
        .iter()
        .map(|other| {
            let floor = match other.floor {
                Floor::Measured(floor) => three(floor),
                Floor::Black => format!("{} (black)", three(race.black)),
                Floor::Unknown => "not measured: the plot has the noise alone".into(),
                Floor::OtherLight => "another light, not in the plot".into(),
            };
            vec![other.name.into(), other.noise.map_or("–".into(), three), floor, other.ignores.into()]
        })
        .collect();
    let header = ["renderer", "noise, relMSE x CPU s", "converged, relMSE to the truth", "ignores"];
    table(&header, &rows)
}
