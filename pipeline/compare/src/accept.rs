//! `--accept`: the test image becomes the reference, and a log beside it tells when, why, and what changed.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use cli::Failure;
use compare::{ChannelReport, Judgement, LayerReport, Report};
use formats::Error;
use formats::atomic::Output;
use serde::Serialize;

use crate::arguments::Arguments;

/// Changes only when a key of the log changes its meaning or goes.
const SCHEMA: u32 = 1;

/// One line of the log.
#[derive(Serialize)]
struct Entry<'a> {
    schema: u32,
    /// Seconds since 1970, or SOURCE_DATE_EPOCH.
    time: u64,
    reason: &'a str,
    reference: String,
    test: String,
    /// BLAKE3 of the whole file that was replaced, and of the one that replaced it.
    old: String,
    new: String,
    verdict: &'a str,
    gates: &'a [Judgement],
    metrics: Vec<Change<'a>>,
}

/// A channel, from the old reference to the new one.
#[derive(Serialize)]
struct Change<'a> {
    layer: &'a str,
    channel: &'a str,
    mean_old: f64,
    mean_new: f64,
    bias: f64,
    rmse: f64,
    relmse: f64,
    max: f64,
}

/// What must be so before any file is read: one cannot replace a file by itself.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.accept && cli::is_same_file(&arguments.reference, &arguments.test) {
        let path = arguments.test.display();
        return Err(Failure::usage(format!(
            "{path}: --accept would replace the file by itself; give another test image"
        )));
    }
    Ok(())
}

/// Copies the test image over the reference, if they differ, and says what was done.
///
/// Both files are complete before the first takes its place, and the log does so first: a line too many can be seen, a
/// reference that changed without one cannot.
pub(crate) fn accept(arguments: &Arguments, report: &Report, verdict: &str) -> Result<String, Failure> {
    let Arguments { reference, test, .. } = arguments;
    let found = report.nonfinite.test;
    if found > 0 && !report.nonfinite.allowed {
        let test = test.display();
        return Err(Failure::usage(format!(
            "{test}: not accepted: {found} samples are not finite; repair it, or let them with --allow-nonfinite"
        )));
    }
    let (old, new) = (read(reference)?, read(test)?);
    if old == new {
        return Ok(format!("UNCHANGED {} has the same bytes already\n", reference.display()));
    }
    let line = serde_json::to_string(&entry(arguments, report, verdict, &old, &new)?)?;
    let log = arguments.log();
    let before = if log.exists() { read(&log)? } else { Vec::new() };
    let outputs =
        [prepare(&log, &[&before, end_of_line(&before), line.as_bytes(), b"\n"])?, prepare(reference, &[&new])?];
    outputs.into_iter().try_for_each(Output::commit)?;
    Ok(format!("ACCEPTED {} as {}, logged in {}\n", test.display(), reference.display(), log.display()))
}

/// What a last line without an end lacks.
fn end_of_line(text: &[u8]) -> &'static [u8] {
    if text.last().is_some_and(|byte| *byte != b'\n') { b"\n" } else { b"" }
}

fn prepare(path: &Path, texts: &[&[u8]]) -> Result<Output, Error> {
    let mut output = Output::create(path)?;
    texts.iter().try_for_each(|text| output.write_all(text)).map_err(|source| Error::write(path, source))?;
    Ok(output)
}

fn read(path: &Path) -> Result<Vec<u8>, Error> {
    let fail = |source| Error::read(path, source);
    if !fs::metadata(path).map_err(fail)?.is_file() {
        return Err(fail(io::Error::other("not a regular file")));
    }
    fs::read(path).map_err(fail)
}

fn entry<'a>(
    arguments: &'a Arguments,
    report: &'a Report,
    verdict: &'a str,
    old: &[u8],
    new: &[u8],
) -> Result<Entry<'a>, Failure> {
    let digest = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
    let changes = |layer: &'a LayerReport| layer.channels.iter().map(|channel| change(&layer.name, channel));
    Ok(Entry {
        schema: SCHEMA,
        time: now()?,
        reason: arguments.reason.as_deref().unwrap_or_default(),
        reference: arguments.reference.display().to_string(),
        test: arguments.test.display().to_string(),
        old: digest(old),
        new: digest(new),
        verdict: verdict.trim_end(),
        gates: &report.gates,
        metrics: report.layers.iter().flat_map(changes).collect(),
    })
}

fn change<'a>(layer: &'a str, channel: &'a ChannelReport) -> Change<'a> {
    let metrics = &channel.metrics;
    Change {
        layer,
        channel: &channel.name,
        mean_old: metrics.mean_reference,
        mean_new: metrics.mean_test,
        bias: metrics.bias,
        rmse: metrics.rmse,
        relmse: metrics.relmse,
        max: metrics.max.error,
    }
}

/// Seconds since 1970. SOURCE_DATE_EPOCH replaces the clock (reproducible-builds.org).
fn now() -> Result<u64, Failure> {
    match std::env::var_os("SOURCE_DATE_EPOCH") {
        Some(text) => text.to_str().and_then(|text| text.parse().ok()).ok_or_else(|| {
            Failure::usage("SOURCE_DATE_EPOCH: not a whole number of seconds since 1970; correct or unset it")
        }),
        None => Ok(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())),
    }
}
