//! Time against error of every configuration, on one scene with one medium.

use crate::{
    error::Error,
    markdown::{count, percent, table, three, time},
    speed::{
        behavior::{Case, CloudFacts, behavior, cloud_facts, falls},
        configuration::{Configuration, MARBLE, Medium, SKIM_MILK, Subject},
        findings::{Findings, Target},
        harness::Harness,
        measure,
        model::{Behavior, Spending},
        plot::{Curve, Plot},
        reference::{Quality, reference},
        shot::Shot,
    },
};

/// A run with the samples and paths that the model chose.
struct Run {
    samples: u64,
    spp: u64,
    seconds: f64,
    error: f64,
    /// Prediction of the model for the same samples and paths.
    predicted: Spending,
}

/// A configuration in the race.
struct Runner {
    configuration: Configuration,
    behavior: Behavior,
    runs: Vec<Run>,
}

/// Measures all configurations on one scene with one medium.
pub fn race(harness: &mut Harness, subject: &Subject, medium: Medium) -> Result<Findings, Error> {
    let effort = harness.effort;
    // Smaller images suffice for media without a target.
    let side = effort.of(64, 256, if is_target(subject, medium) { 512 } else { 192 });
    let shot = Shot { size: [side; 2], ..harness.shot(subject, medium, harness.all()) };
    let quality = Quality { clouds: 4, samples: effort.of(20_000, 4_000_000, 4_000_000), spp: effort.of(4, 8, 8) };
    let converged = reference(harness, &shot, quality)?;
    harness.forget_clouds();
    let mut case = Case { subject, medium, side, reference: &converged, falls: 1.0 };
    case.falls = falls(harness, &case)?;
    let mut clouds = Vec::new();
    for kind in harness.kinds() {
        harness.say(&format!("{} {}: error of clouds, {}", subject.name, medium.name, kind.name()));
        clouds.push(cloud_facts(harness, &case, kind)?);
    }
    let mut runners = Vec::new();
    for configuration in harness.configurations.clone() {
        let Some(cloud) = clouds.iter().find(|c| c.kind == configuration.cloud) else { continue };
        harness.say(&format!("{} {}: paths of `{}`", subject.name, medium.name, configuration.name));
        let behavior = behavior(harness, &case, configuration, cloud)?;
        let mut runner = Runner { configuration, behavior, runs: Vec::new() };
        check(harness, &case, &mut runner, cloud)?;
        runners.push(runner);
    }
    let mut findings = Findings::default();
    if is_target(subject, medium) {
        for (error, wanted) in [(0.02, 300.0), (0.01, 1000.0)] {
            findings.targets.push(time_to(harness, &case, &mut runners, error, wanted)?);
        }
    }
    harness.forget_clouds();
    let title = format!("{}, {}: {side} x {side}", subject.name, medium.name);
    let (name, plot) = (format!("{}-{}", subject.name, medium.name), plot(&case, &runners));
    findings.plotted(title, name, plot, report(&case, &clouds, &runners));
    Ok(findings)
}

/// Whether there are target times for this scene and medium.
fn is_target(subject: &Subject, medium: Medium) -> bool {
    subject.name != "dragon" && (medium == MARBLE || medium == SKIM_MILK)
}

/// Runs a configuration with the samples and paths that the model finds best for a given time, within the range of
/// measured clouds.
fn check(harness: &mut Harness, case: &Case, runner: &mut Runner, cloud: &CloudFacts) -> Result<(), Error> {
    let most = cloud.errors.iter().map(|(k, _)| *k).fold(0.0, f64::max);
    for seconds in harness.effort.of(vec![0.5], vec![4.0], vec![4.0]) {
        let best = runner.behavior.best_within(seconds, most);
        if let Some(spending) = best {
            let run = run(harness, case, runner, spending, seconds as u64)?;
            runner.runs.push(run);
        }
    }
    Ok(())
}

/// Renders with the samples and paths of `spending`, rounded, and with its own seeds.
fn run(harness: &mut Harness, case: &Case, runner: &Runner, spending: Spending, seed: u64) -> Result<Run, Error> {
    let (samples, spp) = (round(spending.samples), spending.spp.ceil() as u64);
    let name = runner.configuration.name;
    let predicted = runner.behavior.spending(samples as f64, spp as f64);
    harness.say(&format!("  {name}: K {}, {spp} paths, about {}", count(samples), time(predicted.seconds)));
    let seed = 100 + seed;
    let shot = case.shot(harness, runner.configuration);
    let taken = harness.take(&Shot { samples, spp, cloud_seed: seed, gather_seed: seed, ..shot })?;
    let error = measure::root(case.reference.squared_error(&taken.picture));
    harness.judge(&taken, error, Some(case.reference.bias(&taken.picture)));
    Ok(Run { samples, spp, seconds: taken.seconds(), error, predicted })
}

/// Rounds to two significant digits.
fn round(samples: f64) -> u64 {
    let unit = 10f64.powf(samples.log10().floor() - 1.0);
    ((samples / unit).round() * unit) as u64
}

/// The time of the note's settings to reach an error over that of ours, which is measured if it does not take too
/// long.
fn time_to(
    harness: &mut Harness,
    case: &Case,
    runners: &mut [Runner],
    error: f64,
    wanted: f64,
) -> Result<Target, Error> {
    let what = format!("{} {}: the note's time to {} % over ours", case.subject.name, case.medium.name, 100.0 * error);
    let seconds = |r: &Runner| r.behavior.cheapest(error).map_or(f64::INFINITY, |s| s.seconds);
    let note = runners.iter().find(|r| r.configuration.name == "note").and_then(|r| r.behavior.cheapest(error));
    let all = |r: &&mut Runner| r.configuration.name.starts_with("all") || r.configuration == harness.all();
    let ours = runners.iter_mut().filter(all).min_by(|a, b| seconds(a).total_cmp(&seconds(b)));
    let (Some(note), Some(ours)) = (note, ours) else {
        return Ok(Target::at_least(what, wanted, None, "out of reach"));
    };
    let predicted = seconds(ours);
    let (seconds, how) = match reach(harness, case, ours, error)? {
        Some(run) => (run.seconds, format!("measured at {}", percent(run.error))),
        None => (predicted, "predicted".into()),
    };
    if seconds.is_infinite() {
        return Ok(Target::at_least(what, wanted, None, "ours out of reach"));
    }
    let at = format!("K {:.1e}, {:.0} paths", note.samples, note.spp);
    let basis = format!("note {} (extrapolated: {at}), ours {} ({how})", time(note.seconds), time(seconds));
    Ok(Target::at_least(what, wanted, Some(note.seconds / seconds), basis))
}

/// The cheapest run that reaches an error, found by several attempts that approach it.
fn reach<'a>(harness: &mut Harness, case: &Case, ours: &'a mut Runner, error: f64) -> Result<Option<&'a Run>, Error> {
    let mut aim = 0.98 * error;
    for attempt in 0..5 {
        let spending = ours.behavior.cheapest(aim);
        let Some(spending) = spending.filter(|s| s.seconds <= harness.effort.longest_run()) else { break };
        let run = run(harness, case, ours, spending, 200 + attempt)?;
        let found = run.error;
        ours.runs.push(run);
        if (0.93 * error..=error).contains(&found) {
            break;
        }
        aim *= 0.98 * error / found.max(0.5 * error);
    }
    let reached = ours.runs.iter().filter(|r| r.error <= error);
    Ok(reached.min_by(|a, b| a.seconds.total_cmp(&b.seconds)))
}

fn plot(case: &Case, runners: &[Runner]) -> Plot {
    let curve = |runner: &Runner| {
        let errors = (0..=80).map(|step| 10f64.powf(-2.3 + f64::from(step) * 0.0225));
        let spendings = errors.filter_map(|e| runner.behavior.cheapest(e));
        Curve {
            label: runner.configuration.name.into(),
            line: spendings.map(|s| (s.seconds, s.error)).filter(|p| p.1 >= 0.005).collect(),
            dots: runner.runs.iter().map(|r| (r.seconds, r.error)).collect(),
        }
    };
    Plot {
        title: format!("{}, {}", case.subject.name, case.medium.name),
        x: "seconds of both programs (lines: model, dots: runs)".into(),
        y: "relative RMSE of the whole image".into(),
        curves: runners.iter().map(curve).collect(),
    }
}

/// The two tables of a race.
fn report(case: &Case, clouds: &[CloudFacts], runners: &[Runner]) -> String {
    let (own, falls) = (percent(case.reference.own_error()), case.falls);
    let note = runners.iter().find(|r| r.configuration.name == "note").map(|r| r.behavior);
    let cells = |r: &Runner| {
        let (b, name) = (&r.behavior, r.configuration.name.to_owned());
        let to = |e: f64| b.cheapest(e).map_or("out of reach".into(), |s| time(s.seconds));
        let gain = |e: f64| {
            let pair = note.and_then(|n| n.cheapest(e)).zip(b.cheapest(e));
            pair.map_or("–".into(), |(n, s)| three(n.seconds / s.seconds))
        };
        let per_path = |k: f64| (b.spending(k, 2.0).seconds - b.spending(k, 1.0).seconds) / b.pixels;
        let nano = |k: f64| three(1e9 * per_path(k));
        let paths = three(b.paths.at(1e-6).sqrt());
        vec![name, paths, nano(1e4), nano(1e6), to(0.05), to(0.02), to(0.01), gain(0.02), gain(0.01)]
    };
    let header = [
        "configuration",
        "error of one path a pixel",
        "ns a path, K = 10k",
        "K = 1M",
        "time to 5 %",
        "2 %",
        "1 %",
        "gain at 2 %",
        "1 %",
    ];
    let rows: Vec<_> = runners.iter().map(cells).collect();
    format!(
        "The reference's own error is {own}, subtracted. Times here are the model's, for {} x {} pixels; the squared \
         error of the paths falls with their number to the power of -{falls:.2}.\n\n{}\n\
         Error of the cloud alone, relative RMSE:\n\n{}\n\
         Runs at points that the model chose:\n\n{}",
        case.side,
        case.side,
        table(&header, &rows),
        cloud_table(clouds),
        run_table(runners)
    )
}

fn cloud_table(clouds: &[CloudFacts]) -> String {
    let counts: Vec<String> = clouds[0].errors.iter().map(|(k, _)| format!("K = {}", count(*k as u64))).collect();
    let mut header = vec!["cloud"];
    header.extend(counts.iter().map(String::as_str));
    header.extend(["slope", "sampling, s per 1M"]);
    let row = |c: &CloudFacts| {
        let mut cells = vec![c.kind.name()];
        cells.extend(c.errors.iter().map(|(_, e)| percent(*e)));
        cells.extend([format!("{:.2}", c.law.exponent), three(1e6 * c.sampling.slope)]);
        cells
    };
    table(&header, &clouds.iter().map(row).collect::<Vec<_>>())
}

fn run_table(runners: &[Runner]) -> String {
    let header = ["configuration", "K", "paths a pixel", "seconds", "model's", "error", "model's"];
    let row = |name: &str, r: &Run| {
        let p = &r.predicted;
        vec![
            name.to_owned(),
            count(r.samples),
            r.spp.to_string(),
            three(r.seconds),
            three(p.seconds),
            percent(r.error),
            percent(p.error),
        ]
    };
    let rows: Vec<_> = runners.iter().flat_map(|r| r.runs.iter().map(|run| row(r.configuration.name, run))).collect();
    table(&header, &rows)
}
