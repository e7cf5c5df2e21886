//! The error of clouds alone: stratified samples against independent ones, and how fast it falls.

use crate::{
    error::Error,
    markdown::{count, percent, table, three},
    speed::{
        configuration::{
            CloudKind, Configuration, INDEPENDENT_AREA, MARBLE, Medium, SKIM_MILK, STRATIFIED_AREA, Subject, Summing,
        },
        findings::{Findings, Target},
        harness::Harness,
        measure::spread,
        model::PowerLaw,
        picture::Picture,
        plot::{Curve, Plot},
        shot::Shot,
    },
};

/// Errors of one kind of cloud with one medium.
struct Series {
    kind: CloudKind,
    medium: Medium,
    /// `K`, and relative RMSE of each channel.
    errors: Vec<(u64, [f64; 3])>,
    /// The `K` above which the distance of samples is below the mean free path, per channel.
    resolved: [f64; 3],
}

impl Series {
    /// Points of one channel, or of all together (root mean square of the channels).
    fn points(&self, channel: Option<usize>) -> Vec<(f64, f64)> {
        let of = |e: &[f64; 3]| channel.map_or((e.iter().map(|x| x * x).sum::<f64>() / 3.0).sqrt(), |c| e[c]);
        self.errors.iter().map(|(k, e)| (*k as f64, of(e))).collect()
    }

    /// Exponent of the error where the mean free path is resolved; none with fewer than three points.
    fn slope(&self, channel: usize) -> Option<f64> {
        let points: Vec<_> =
            self.points(Some(channel)).into_iter().filter(|(k, _)| *k >= self.resolved[channel]).collect();
        PowerLaw::fit(&points).filter(|_| points.len() >= 3).map(|law| law.exponent)
    }
}

/// Measures both kinds of clouds and both media, under one directional light.
pub fn clouds(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let mut all = Vec::new();
    for kind in [INDEPENDENT_AREA, STRATIFIED_AREA] {
        if !harness.kinds().contains(&kind) {
            continue;
        }
        for medium in [MARBLE, SKIM_MILK] {
            all.push(series(harness, subject, medium, kind)?);
        }
        harness.forget_clouds();
    }
    let mut findings = Findings { targets: targets(&all), ..Findings::default() };
    findings.plotted("Error of clouds alone", "clouds", plot(&all), report(subject, &all));
    Ok(findings)
}

/// Width and height of the images, pixels.
const SIZE: [u64; 2] = [48, 27];

/// `K` of the ratios with a target.
const COMPARED: u64 = 1_000_000;

fn series(harness: &mut Harness, subject: &Subject, medium: Medium, kind: CloudKind) -> Result<Series, Error> {
    let effort = harness.effort;
    let counts = effort.of(
        vec![1_000, 4_000, 16_000],
        vec![100_000, 316_000, COMPARED, 4_000_000],
        vec![100_000, 316_000, COMPARED, 4_000_000],
    );
    let mut errors = Vec::new();
    let mut area = 0.0;
    for samples in counts {
        harness.say(&format!("clouds of {}, {}: {}, K {}", subject.name, medium.name, kind.name(), count(samples)));
        let more = vec!["--filter".into(), "point".into()];
        // Sums over all samples have no near field, which carries what few samples do not.
        let configuration = Configuration { summing: Summing::Exhaustive, ..harness.fine_on(kind) };
        let shot = Shot { samples, size: SIZE, more, ..harness.shot(subject, medium, configuration) };
        let mut pictures: Vec<Picture> = Vec::new();
        for cloud_seed in 1..=effort.of(3, 6, 6) {
            let taken = harness.take(&Shot { cloud_seed, ..shot.clone() })?;
            area = taken.sampling.number("surface_area_m2").unwrap_or(0.0);
            pictures.push(taken.picture);
        }
        errors.push((samples, spread(&pictures)));
    }
    let paths = bssrdf::built_in(medium.name).map_err(|e| Error::Usage(e.to_string()))?.mean_free_path();
    Ok(Series { kind, medium, errors, resolved: paths.map(|path| area / (path * path)) })
}

fn targets(all: &[Series]) -> Vec<Target> {
    let find = |kind: CloudKind, medium: Medium| all.iter().find(|s| s.kind == kind && s.medium == medium);
    let ratio = |medium: Medium, channel: Option<usize>| {
        let at = |kind| find(kind, medium)?.points(channel).into_iter().find(|(k, _)| *k == COMPARED as f64);
        Some(at(INDEPENDENT_AREA)?.1 / at(STRATIFIED_AREA)?.1)
    };
    let slope = |medium: Medium| (0..3).filter_map(|c| find(STRATIFIED_AREA, medium)?.slope(c)).reduce(f64::max);
    let text = "error of independent over stratified clouds, K = 1M";
    let slopes = "slope of log error against log K, stratified, where the mean free path is resolved, worst channel";
    vec![
        Target::at_least(format!("marble: {text}"), 2.5, ratio(MARBLE, None), "measured"),
        Target::at_least(format!("skim milk, red: {text}"), 5.0, ratio(SKIM_MILK, Some(0)), "measured"),
        Target::at_most(format!("marble: {slopes}"), -0.75, slope(MARBLE), "measured"),
        Target::at_most(format!("skim milk: {slopes}"), -0.75, slope(SKIM_MILK), "measured"),
    ]
}

fn plot(all: &[Series]) -> Plot {
    let curve = |s: &Series| {
        let points = s.points(None);
        Curve { label: format!("{}, {}", s.medium.name, s.kind.pattern), line: points.clone(), dots: points }
    };
    Plot {
        title: "Error of clouds alone".into(),
        x: "samples K".into(),
        y: "relative RMSE".into(),
        curves: all.iter().map(curve).collect(),
    }
}

fn report(subject: &Subject, all: &[Series]) -> String {
    let mut rows = Vec::new();
    for s in all {
        let names = [s.medium.name.to_owned(), s.kind.name()];
        for (k, e) in &s.errors {
            rows.push(names.iter().cloned().chain([count(*k)]).chain(e.map(percent)).collect());
        }
        let slopes = [0, 1, 2].map(|c| s.slope(c).map_or("–".into(), |x| format!("{x:.2}")));
        rows.push(names.into_iter().chain(["slope".into()]).chain(slopes).collect());
    }
    let resolved = |medium: Medium| {
        all.iter().find(|s| s.medium == medium).map_or("–".into(), |s| s.resolved.map(three).join(", "))
    };
    format!(
        "{}: relative RMSE over independent clouds, the same paths through the pixels' centers, sums over all samples, \
         without the near field. The mean free path is resolved where one sample's share of the surface is smaller than \
         its square: K above {} (marble: red, green, blue) and {} (skim milk); slopes are fitted from there.\n\n{}",
        subject.name,
        resolved(MARBLE),
        resolved(SKIM_MILK),
        table(&["medium", "cloud", "K", "red", "green", "blue"], &rows)
    )
}
