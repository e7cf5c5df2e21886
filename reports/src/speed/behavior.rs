//! Measures both errors and the times of a configuration, each separately where it is cheap to measure.

use crate::{
    error::Error,
    speed::{
        configuration::{CloudKind, Configuration, Medium, Subject, Summing},
        harness::Harness,
        measure::{self, Reference},
        model::{Behavior, Line, PathCost, PowerLaw},
        picture::Picture,
        shot::Shot,
    },
};

/// A scene, a medium and an image size to measure.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    pub subject: &'a Subject,
    pub medium: Medium,
    /// Width and height, pixels.
    pub side: u64,
    pub reference: &'a Reference,
    /// Exponent of the error of the paths: see [`Behavior`].
    pub falls: f64,
}

impl Case<'_> {
    /// A shot of this case.
    pub fn shot(&self, harness: &Harness, configuration: Configuration) -> Shot<'_> {
        Shot { size: [self.side; 2], ..harness.shot(self.subject, self.medium, configuration) }
    }
}

/// The error and the time of a kind of cloud, as measured and as fitted.
#[derive(Clone, Debug)]
pub struct CloudFacts {
    pub kind: CloudKind,
    /// `K` and relative RMSE of the cloud alone.
    pub errors: Vec<(f64, f64)>,
    pub law: PowerLaw,
    /// Seconds of `sample-surface`, of `K`.
    pub sampling: Line,
}

/// Images of several clouds, each gathered with both seeds.
pub fn crossed(harness: &mut Harness, shot: &Shot, clouds: u64) -> Result<Vec<[Picture; 2]>, Error> {
    let mut pictures = Vec::new();
    for cloud_seed in 1..=clouds {
        let mut take = |gather_seed| {
            let one = Shot { cloud_seed, gather_seed, ..shot.clone() };
            harness.take(&one).map(|taken| taken.picture)
        };
        pictures.push([take(1)?, take(2)?]);
    }
    Ok(pictures)
}

/// Measures the errors of one kind of cloud at the full size of the image: larger pixels would average some of it
/// away.
pub fn cloud_facts(harness: &mut Harness, case: &Case, kind: CloudKind) -> Result<CloudFacts, Error> {
    let effort = harness.effort;
    let counts = effort.of(vec![2_000, 8_000], vec![100_000, 400_000, 1_600_000], vec![100_000, 400_000, 1_600_000]);
    let (mut errors, mut seconds) = (Vec::new(), Vec::new());
    for samples in counts {
        let shot = case.shot(harness, harness.best_on(kind));
        let shot = Shot { samples, ..shot };
        let pictures = crossed(harness, &shot, effort.of(2, 2, 2))?;
        let parts = measure::parts(&pictures, case.reference.mean_square());
        errors.push((samples as f64, measure::root(parts.cloud.unwrap_or(0.0))));
        seconds.push((samples as f64, harness.cloud(&shot)?.1.wall));
    }
    let law = PowerLaw::fit(&errors).unwrap_or(PowerLaw { factor: f64::NAN, exponent: 0.0 });
    let sampling = Line::fit(&seconds).unwrap_or_default();
    Ok(CloudFacts { kind, errors, law, sampling })
}

/// Measures how the squared error of the paths falls with their number, on a small cloud.
pub fn falls(harness: &mut Harness, case: &Case) -> Result<f64, Error> {
    let samples = harness.effort.of(1_000, 30_000, 30_000);
    let mut points = Vec::new();
    for spp in [1, 4, 16] {
        let shot = Shot { samples, spp, ..case.shot(harness, harness.all()) };
        let pictures = crossed(harness, &shot, 1)?;
        points.push((spp as f64, measure::parts(&pictures, case.reference.mean_square()).paths));
    }
    // An exponent above 2 or below 1/2 is noise.
    Ok(PowerLaw::fit(&points).map_or(1.0, |law| (-law.exponent).clamp(0.5, 2.0)))
}

/// Measures variance and time of the paths of a configuration, and joins them with the facts of its clouds.
pub fn behavior(
    harness: &mut Harness,
    case: &Case,
    configuration: Configuration,
    cloud: &CloudFacts,
) -> Result<Behavior, Error> {
    let effort = harness.effort;
    let tree = matches!(configuration.summing, Summing::Cut(_));
    let counts = match tree {
        true => effort.of(vec![1_000, 10_000], vec![100_000, 1_000_000], vec![100_000, 1_000_000]),
        false => effort.of(vec![1_000, 4_000], vec![10_000, 60_000], vec![10_000, 60_000]),
    };
    let pixels = (case.side * case.side) as f64;
    let (mut paths, mut overhead, mut per_path) = (Vec::new(), Vec::new(), Vec::new());
    for samples in counts {
        let shot = Shot { samples, ..case.shot(harness, configuration) };
        let first = harness.take(&shot)?;
        let second = harness.take(&Shot { gather_seed: 2, ..shot.clone() })?;
        let wall = first.gathering.wall.min(second.gathering.wall);
        let render = match tree {
            true => more_paths(harness, &shot, wall)?,
            false => first.gathering.step("render").min(second.gathering.step("render")),
        };
        per_path.push((samples as f64, render / pixels));
        overhead.push((samples as f64, wall - render));
        let parts = measure::parts(&[[first.picture, second.picture]], case.reference.mean_square());
        paths.push((1.0 / samples as f64, parts.paths));
    }
    if !tree {
        paths.push(without_roulette(harness, case, configuration.cloud)?);
    }
    let cost = if tree {
        PathCost::Tree(PowerLaw::fit(&per_path).unwrap_or(PowerLaw { factor: f64::NAN, exponent: 0.0 }))
    } else {
        PathCost::Every(Line::fit(&per_path).unwrap_or_default())
    };
    Ok(Behavior {
        pixels,
        cloud: cloud.law,
        paths: Line::fit(&paths).unwrap_or_default(),
        falls: case.falls,
        sampling: cloud.sampling,
        overhead: Line::fit(&overhead).unwrap_or_default(),
        per_path: cost,
    })
}

/// 1/K and the squared error of one path on a cloud so large that the share of the roulette, which falls as 1/K, is
/// negligible. Another estimator stands for the roulette, which would take minutes.
fn without_roulette(harness: &mut Harness, case: &Case, kind: CloudKind) -> Result<(f64, f64), Error> {
    let samples = harness.effort.of(20_000, 1_000_000, 1_000_000);
    let shot = Shot { samples, ..case.shot(harness, harness.best_on(kind)) };
    let pictures = crossed(harness, &shot, 1)?;
    Ok((1.0 / samples as f64, measure::parts(&pictures, case.reference.mean_square()).paths))
}

/// Seconds of one path a pixel, from a second run with more paths than the one that took `wall` seconds, so that the
/// cost that is independent of the paths cancels.
fn more_paths(harness: &mut Harness, shot: &Shot, wall: f64) -> Result<f64, Error> {
    const MORE: u64 = 4;
    let long = harness.take(&Shot { spp: shot.spp + MORE, gather_seed: 3, ..shot.clone() })?;
    // Timing noise may hide the difference of short runs: the result is at least a tenth of the mean.
    let least = 0.1 * long.gathering.wall / (shot.spp + MORE) as f64;
    Ok(((long.gathering.wall - wall) / MORE as f64).max(least))
}
