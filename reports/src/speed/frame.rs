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

/// The most seconds that the frame should take.
const SECONDS: f64 = 60.0;

/// Estimates for a cloud before the frame is rendered.
struct Trial {
    samples: u64,
    /// Squared estimated error that more paths do not reduce.
    floor: f64,
    /// Squared estimated error of one path a pixel, without that.
    one_path: f64,
    /// Seconds of both programs without paths, and per path a pixel.
    fixed: f64,
    per_path: f64,
    taken: Taken,
}

impl Trial {
    fn paths(&self) -> f64 {
        (self.one_path / (ERROR * ERROR - self.floor)).max(2.0)
    }

    fn seconds(&self) -> f64 {
        self.fixed + self.paths() * self.per_path
    }
}

/// Renders the frame, or predicts it where it would take too long.
pub fn frame(harness: &mut Harness, subject: &Subject) -> Result<Findings, Error> {
    let size = harness.effort.of([96, 54], [1920, 1080], [1920, 1080]);
    let shot = Shot { size, ..harness.shot(subject, MARBLE, DEFAULTS) };
    let mut findings = Findings::default();
    let title = format!("A frame of {} x {}", size[0], size[1]);
    let what = format!("{}, marble, {} x {}: seconds to 1 % estimated error", subject.name, size[0], size[1]);
    let Some(trial) = choose(harness, &shot)? else {
        let why = "out of reach: no cloud that was tried is good enough";
        findings.targets.push(Target::at_most(what, SECONDS, None, why));
        return Ok(findings);
    };
    let (taken, spp) = render(harness, &shot, trial)?;
    let (seconds, basis) = match taken {
        Ok(taken) => {
            let seconds = taken.seconds();
            findings.section(title, costs(&taken, spp, None));
            (seconds, format!("measured, {}", percent(estimate(&taken).sqrt())))
        }
        Err(trial) => {
            findings.section(title, costs(&trial.taken, 6, Some((spp, trial.seconds()))));
            (trial.seconds(), "predicted from 2 and 6 paths a pixel".into())
        }
    };
    harness.forget_clouds();
    findings.targets.push(Target::at_most(what, SECONDS, Some(seconds), basis));
    Ok(findings)
}

/// Finds the smallest cloud whose estimated error takes less than half of the squared target error.
fn choose(harness: &mut Harness, shot: &Shot) -> Result<Option<Trial>, Error> {
    let counts = harness.effort.of(
        vec![10_000],
        vec![1_000_000, 4_000_000, 16_000_000],
        vec![1_000_000, 4_000_000, 16_000_000, 64_000_000],
    );
    for samples in counts {
        harness.say(&format!("frame: trying K {}", count(samples)));
        let few = harness.take(&Shot { samples, spp: 2, ..shot.clone() })?;
        let more = harness.take(&Shot { samples, spp: 6, ..shot.clone() })?;
        let one_path = (estimate(&few) - estimate(&more)).max(0.0) / (1.0 / 2.0 - 1.0 / 6.0);
        // A floor within the noise of the two estimates counts as none.
        let floor = Some(estimate(&more) - one_path / 6.0).filter(|f| *f > 0.05 * one_path / 6.0).unwrap_or(0.0);
        let per_path = (more.gathering.wall - few.gathering.wall).max(0.0) / 4.0;
        let fixed = more.seconds() - 6.0 * per_path;
        if floor < 0.5 * ERROR * ERROR || harness.effort == crate::speed::effort::Effort::Tiny {
            return Ok(Some(Trial {
                samples,
                floor: floor.min(0.5 * ERROR * ERROR),
                one_path,
                fixed,
                per_path,
                taken: more,
            }));
        }
    }
    Ok(None)
}

/// Squared estimated error.
fn estimate(taken: &Taken) -> f64 {
    taken.gathering.number("estimated_relative_error").map_or(f64::NAN, |e| e * e)
}

/// Renders the frame; returns it with its paths a pixel, or the trial if the frame would take too long.
fn render(harness: &mut Harness, shot: &Shot, trial: Trial) -> Result<(Result<Taken, Trial>, u64), Error> {
    let mut spp = (1.02 * trial.paths()).ceil() as u64;
    if trial.seconds() > harness.effort.longest_run() {
        return Ok((Err(trial), spp));
    }
    harness.say(&format!("frame: {spp} paths a pixel, about {}", time(trial.seconds())));
    let taken = harness.take(&Shot { samples: trial.samples, spp, ..shot.clone() })?;
    if estimate(&taken) <= ERROR * ERROR || estimate(&taken).is_nan() {
        return Ok((Ok(taken), spp));
    }
    spp = (1.1 * spp as f64 * estimate(&taken) / (ERROR * ERROR)).ceil() as u64;
    let taken = harness.take(&Shot { samples: trial.samples, spp, ..shot.clone() })?;
    Ok((Ok(taken), spp))
}

/// The costs of the steps of both programs, the three largest first.
fn costs(taken: &Taken, spp: u64, predicted: Option<(u64, f64)>) -> String {
    let mut steps = Vec::new();
    for (program, spent) in [("sample-surface", &taken.sampling), ("gather", &taken.gathering)] {
        let seconds = spent.statistics["seconds"].as_object();
        let named = seconds.into_iter().flatten().filter(|(step, _)| *step != "total");
        steps.extend(named.map(|(step, s)| (format!("{program}: {step}"), s.as_f64().unwrap_or(0.0))));
    }
    steps.sort_by(|a, b| b.1.total_cmp(&a.1));
    let total = taken.seconds();
    let rows: Vec<_> = steps.iter().take(3).map(|(n, s)| vec![n.clone(), three(*s), percent(s / total)]).collect();
    let samples = taken.gathering.number("samples_drawn").unwrap_or(0.0) as u64;
    let error = percent(estimate(taken).sqrt());
    let run = format!("K = {}, {spp} paths a pixel: {}, estimated error {error}.", count(samples), time(total));
    let rest = predicted.map_or(String::new(), |(spp, s)| format!(" 1 % would take {spp} paths: {}.", time(s)));
    format!("{run}{rest} The three largest costs:\n\n{}", table(&["step", "seconds", "share"], &rows))
}
