//! Writes the files that were asked for, each one whole and none over an input.

use std::{fmt::Display, path::Path};

use cli::{Failure, Files};
use compare::heatmap::heatmap;
use compare::{Report, Settings, difference, html};
use formats::{atomic::Group, image::Image};
use serde::Serialize;

use crate::arguments::Arguments;

/// A report with its inputs and its verdict.
#[derive(Serialize)]
pub(crate) struct Document<'a, R> {
    #[serde(flatten)]
    report: &'a R,
    reference: String,
    test: String,
    verdict: &'a str,
}

/// Refuses outputs that cannot be written, or that would replace an input or each other, before any work is done.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let mut files = Files::default();
    files.reads("REFERENCE", &arguments.reference)?;
    files.reads("TEST", &arguments.test)?;
    arguments.limits.iter().try_for_each(|path| files.reads("--limits", path))?;
    let log = arguments.accept.then(|| arguments.log());
    let outputs = [
        ("--json", arguments.json.as_ref()),
        ("--diff-exr", arguments.diff_exr.as_ref()),
        ("--heatmap", arguments.heatmap.as_ref()),
        ("--html", arguments.html.as_ref()),
        ("the log of --accept", log.as_ref()),
    ];
    outputs.into_iter().try_for_each(|(what, path)| path.map_or(Ok(()), |path| files.writes(what, path)))
}

/// Writes the outputs that were asked for, whatever the verdict.
pub(crate) fn write(
    arguments: &Arguments,
    settings: &Settings,
    [reference, test]: [&Image; 2],
    report: &Report,
    verdict: &str,
) -> Result<(), Failure> {
    // The difference comes first, so that nothing is written if there is none.
    let difference = arguments.diff_exr.is_some().then(|| difference(reference, test));
    let path = arguments.diff_exr.as_deref().unwrap_or(&arguments.test).display();
    let difference =
        difference.transpose().map_err(|error| Failure::numerical(format!("{path}: {error}; leave out --diff-exr")))?;
    let at = |path: &Path, error: &dyn Display| Failure::usage(format!("{}: {error}", path.display()));
    let mut group = Group::default();
    let document = Document::new(arguments, report, verdict);
    if let Some(path) = &arguments.json {
        group.write(path, &document.json()?)?;
    }
    if let Some(path) = &arguments.html {
        let page = arguments.common.in_pool(|| html::page(&document, report, reference, test))??;
        group.write(path, &page)?;
    }
    if let (Some(path), Some(difference)) = (&arguments.diff_exr, difference) {
        let bytes = difference.encode_with(arguments.common.thread_count());
        group.write(path, &bytes.map_err(|error| at(path, &error))?)?;
    }
    if let Some(path) = &arguments.heatmap {
        let png = heatmap(reference, test, &settings.choice, arguments.heatmap_max);
        group.write(path, &png.map_err(|error| at(path, &error))?)?;
    }
    Ok(group.commit()?)
}

impl<'a, R: Serialize> Document<'a, R> {
    pub(crate) fn new(arguments: &Arguments, report: &'a R, verdict: &'a str) -> Document<'a, R> {
        Document {
            report,
            reference: arguments.reference.display().to_string(),
            test: arguments.test.display().to_string(),
            verdict: verdict.trim_end(),
        }
    }

    /// The text of the JSON file.
    pub(crate) fn json(&self) -> serde_json::Result<Vec<u8>> {
        Ok((serde_json::to_string_pretty(self)? + "\n").into_bytes())
    }
}
