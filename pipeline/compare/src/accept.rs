//! `--accept`: the test image becomes the reference, and the log beside it records when, why and what changed.

use std::io::Write;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use cli::{Failure, printable};
use compare::{ChannelReport, Judgement, LayerReport, Report};
use formats::{Error, atomic::Output};
use serde::Serialize;

use crate::arguments::Arguments;
use crate::inputs::{Source, read_bytes};
use crate::lock::{Lock, PATIENCE};

/// The version of the keys, which changes only when a key of the log changes its meaning or is removed.
const SCHEMA: u32 = 1;

/// One line of the log.
#[derive(Serialize)]
struct LogEntry<'a> {
    schema: u32,
    /// The time in seconds since 1970, or SOURCE_DATE_EPOCH.
    time: u64,
    reason: &'a str,
    reference: String,
    test: String,
    /// The BLAKE3 hashes of the file that was replaced, and of the file that replaced it.
    old: String,
    new: String,
    verdict: &'a str,
    gates: &'a [Judgement],
    metrics: Vec<Change<'a>>,
}

/// The change of a channel from the old reference to the new one.
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

/// Refuses to replace a file by itself, before any file is read.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.accept && cli::is_same_file(&arguments.reference, &arguments.test) {
        return Err(refused(&arguments.test, "--accept would replace the file by itself; give another test image"));
    }
    Ok(())
}

/// Locks the reference from before it is read until it is replaced, so that no other acceptance replaces it meanwhile.
pub(crate) fn lock(arguments: &Arguments) -> Result<Option<Lock>, Failure> {
    let take = || Lock::take(&arguments.reference, PATIENCE, |line| arguments.common.say(line));
    arguments.accept.then(take).transpose()
}

/// Replaces the reference by the test image that was judged, if they differ, and returns what was done in words.
///
/// Both files are complete before the first is renamed, and the log is renamed first: a superfluous line of the log can
/// be seen, a reference that changed without one cannot.
pub(crate) fn accept(
    arguments: &Arguments,
    [old, new]: [&Source; 2],
    report: &Report,
    verdict: &str,
) -> Result<String, Failure> {
    let Arguments { reference, test, .. } = arguments;
    let found = report.nonfinite.test;
    if found > 0 && !report.nonfinite.allowed {
        let what = format!("the image is not accepted, because {found} samples are not finite");
        return Err(refused(test, &format!("{what}; repair it, or give --allow-nonfinite")));
    }
    let shown = |path: &Path| printable(&path.display().to_string()).into_owned();
    if old.bytes == new.bytes {
        return Ok(format!("UNCHANGED {} has the same bytes already\n", shown(reference)));
    }
    let line = serde_json::to_string(&entry(arguments, report, verdict, &old.bytes, &new.bytes)?)?;
    let log = arguments.log();
    let before = if log.exists() { read_bytes(&log)? } else { Vec::new() };
    let outputs =
        [prepare(&log, &[&before, end_of_line(&before), line.as_bytes(), b"\n"])?, prepare(reference, &[&new.bytes])?];
    // A program that does not know the lock may have replaced the reference meanwhile.
    if read_bytes(reference)? != old.bytes {
        return Err(refused(reference, "the file changed while it was compared; nothing was accepted, run again"));
    }
    outputs.into_iter().try_for_each(Output::commit)?;
    Ok(format!("ACCEPTED {} as {}, logged in {}\n", shown(test), shown(reference), shown(&log)))
}

fn refused(path: &Path, why: &str) -> Failure {
    Failure::usage(format!("{}: {why}", path.display()))
}

/// The line break that the last line of a text lacks, if it lacks one.
fn end_of_line(text: &[u8]) -> &'static [u8] {
    if text.last().is_some_and(|byte| *byte != b'\n') { b"\n" } else { b"" }
}

fn prepare(path: &Path, texts: &[&[u8]]) -> Result<Output, Error> {
    let mut output = Output::create(path)?;
    texts.iter().try_for_each(|text| output.write_all(text)).map_err(|source| Error::write(path, source))?;
    Ok(output)
}

fn entry<'a>(
    arguments: &'a Arguments,
    report: &'a Report,
    verdict: &'a str,
    old: &[u8],
    new: &[u8],
) -> Result<LogEntry<'a>, Failure> {
    let digest = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
    let change = |layer: &'a str, ChannelReport { name, metrics }: &'a ChannelReport| Change {
        layer,
        channel: name,
        mean_old: metrics.mean_reference,
        mean_new: metrics.mean_test,
        bias: metrics.get("bias"),
        rmse: metrics.get("rmse"),
        relmse: metrics.get("relmse"),
        max: metrics.max.error,
    };
    let changes = |layer: &'a LayerReport| layer.channels.iter().map(move |channel| change(&layer.name, channel));
    Ok(LogEntry {
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

/// The time in seconds since 1970. SOURCE_DATE_EPOCH replaces the clock (reproducible-builds.org).
fn now() -> Result<u64, Failure> {
    match std::env::var_os("SOURCE_DATE_EPOCH") {
        Some(text) => text.to_str().and_then(|text| text.parse().ok()).ok_or_else(|| {
            Failure::usage("SOURCE_DATE_EPOCH: it is not a whole number of seconds since 1970; correct or unset it")
        }),
        None => Ok(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::num::NonZeroUsize;

    use clap::Parser;
    use compare::{Settings, compare};
    use formats::image::{Channel, Image};

    use super::*;

    fn gray(value: f32) -> Vec<u8> {
        let channel = |name: &str| Channel { name: name.to_owned(), samples: vec![value; 12] };
        Image { width: 4, height: 3, channels: ["R", "G", "B"].map(channel).into(), ..Image::default() }
            .encode()
            .unwrap()
    }

    /// Reads and judges both files, changes one of them, and accepts.
    fn after(change: &str, value: f32) -> (Result<String, Failure>, Vec<u8>, bool) {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("reference.exr"), gray(1.0)).unwrap();
        fs::write(path("test.exr"), gray(1.5)).unwrap();
        let [reference, test] = ["reference.exr", "test.exr"].map(|name| path(name).display().to_string());
        let arguments = Arguments::parse_from(["compare", &reference, &test, "--accept", "--reason", "brighter"]);
        let sources =
            [&arguments.reference, &arguments.test].map(|p| Source::read(p, NonZeroUsize::MIN, true).unwrap());
        let [old, new] = sources.each_ref();
        let report = compare(&old.image, &new.image, &Settings::default()).unwrap();
        fs::write(path(change), gray(value)).unwrap();
        let done = accept(&arguments, [old, new], &report, "PASS");
        (done, fs::read(path("reference.exr")).unwrap(), path("reference.exr.log").exists())
    }

    /// Seen to catch: TEST read a second time, by which an image that was never judged, all NaN, became the reference.
    #[test]
    fn what_was_judged_is_installed() {
        let (done, reference, logged) = after("test.exr", f32::NAN);
        assert!(done.unwrap().starts_with("ACCEPTED "));
        assert!(reference == gray(1.5) && logged);
    }

    /// Seen to catch: a reference that another program wrote meanwhile, replaced without having been compared.
    #[test]
    fn what_was_judged_is_replaced() {
        let (done, reference, logged) = after("reference.exr", 7.0);
        let message = done.unwrap_err().message;
        assert!(message.contains("reference.exr: the file changed while it was compared"), "{message}");
        assert!(reference == gray(7.0) && !logged);
    }
}
