//! `compare REFERENCE TEST`: metrics, verdict, exit code 0, 1 or 2.

use std::path::{Path, PathBuf};

use clap::Parser;
use cli::Failure;
use compare::{Choice, Gate, Report, Settings, compare};
use formats::image::Image;
use serde::Serialize;

/// Compare two OpenEXR images.
///
/// Prints metrics per layer, then one line with the verdict. Exit code: 0 passed, 1 the images differ beyond a
/// gate or hold values that are not finite, 2 could not judge.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// Image that is right
    reference: PathBuf,
    /// Image to judge
    test: PathBuf,
    /// Largest relative difference of the means, of every channel (0.01 is one per cent)
    #[arg(long, value_name = "R", value_parser = limit)]
    max_bias: Option<f64>,
    /// Largest mean of (test - reference)^2 / (reference^2 + 0.01), of every channel
    #[arg(long, value_name = "R", value_parser = limit)]
    max_relmse: Option<f64>,
    /// Largest root of the mean squared error, of every channel, in units of the channel
    #[arg(long, value_name = "R", value_parser = limit)]
    max_rmse: Option<f64>,
    /// Largest absolute error of any sample, in units of the channel
    #[arg(long, value_name = "R", value_parser = limit)]
    max_abs: Option<f64>,
    /// At most N pixels may differ by more than T, in units of the channel
    #[arg(long, value_name = "N@T", value_parser = outliers)]
    max_outliers: Option<Gate>,
    /// Every bit must be equal; looks at all layers unless --layer says otherwise
    #[arg(long)]
    exact: bool,
    /// Layer that the gates look at (beauty is R, G and B), or `all` [default: beauty]
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// Let NaN and infinity pass; gates on their channel still fail
    #[arg(long)]
    allow_nonfinite: bool,
    /// Compare images of different clouds or scenes
    #[arg(long)]
    ignore_meta: bool,
    /// Write all metrics and gates as JSON
    #[arg(short = 'o', long, visible_alias = "output", value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    common: cli::Common,
}

/// The report with the names of its files.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    report: &'a Report,
    reference: String,
    test: String,
    verdict: &'a str,
}

fn main() {
    cli::run("compare", || judge(&Arguments::parse()))
}

fn judge(arguments: &Arguments) -> Result<u8, Failure> {
    let (reference, test) = (Image::read(&arguments.reference)?, Image::read(&arguments.test)?);
    let report = compare(&reference, &test, &settings(arguments)).map_err(|mismatch| {
        let (test, reference) = (arguments.test.display(), arguments.reference.display());
        Failure::usage(format!("{test}: {mismatch} (the reference is {reference})"))
    })?;
    let name = arguments.test.file_name().unwrap_or_default().to_string_lossy();
    let verdict = report.verdict(&name);
    if let Some(path) = &arguments.json {
        write_json(path, arguments, &report, &verdict)?;
    }
    if !arguments.common.quiet {
        cli::print(&report.table())?;
    }
    cli::print(&verdict)?;
    Ok(if report.pass { 0 } else { 1 })
}

fn settings(arguments: &Arguments) -> Settings {
    let gates = [
        arguments.max_bias.map(Gate::Bias),
        arguments.max_relmse.map(Gate::RelMse),
        arguments.max_rmse.map(Gate::Rmse),
        arguments.max_abs.map(Gate::Abs),
        arguments.max_outliers,
        arguments.exact.then_some(Gate::Exact),
    ];
    Settings {
        gates: gates.into_iter().flatten().collect(),
        choice: match arguments.layer.as_deref() {
            None => Choice::Default,
            Some("all") => Choice::All,
            Some(name) => Choice::Named(name.to_owned()),
        },
        allow_nonfinite: arguments.allow_nonfinite,
        ignore_meta: arguments.ignore_meta,
    }
}

fn write_json(path: &Path, arguments: &Arguments, report: &Report, verdict: &str) -> Result<(), Failure> {
    let inputs = [&arguments.reference, &arguments.test];
    let same = |input: &PathBuf| matches!((input.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if inputs.into_iter().any(same) {
        return Err(Failure::usage(format!("{}: --json would replace an image; give another name", path.display())));
    }
    let document = Document {
        report,
        reference: arguments.reference.display().to_string(),
        test: arguments.test.display().to_string(),
        verdict: verdict.trim_end(),
    };
    let text = serde_json::to_string_pretty(&document)?;
    Ok(formats::atomic::write(path, (text + "\n").as_bytes())?)
}

fn limit(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(limit) if limit.is_finite() && limit >= 0.0 => Ok(limit),
        _ => Err("not a finite number of at least 0".to_owned()),
    }
}

fn outliers(text: &str) -> Result<Gate, String> {
    let parse = || {
        let (count, threshold) = text.split_once('@')?;
        Some(Gate::Outliers { count: count.parse().ok()?, threshold: limit(threshold).ok()? })
    };
    parse()
        .ok_or_else(|| "not N@T with a whole number of pixels N and an error T of at least 0, as in 3@0.5".to_owned())
}
