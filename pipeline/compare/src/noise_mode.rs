//! `compare --replicates` and `--summarise`: folders of images instead of two.

use std::num::NonZeroU16;
use std::path::{Path, PathBuf};

use clap::Args;
use cli::{Failure, Files, Need};
use compare::replicates::{NoiseReport, Replicates, Summary, judge};
use formats::image::{Dimensions, Image};
use serde::Serialize;

use crate::Arguments;

/// What is asked of folders.
#[derive(Args, Debug)]
pub(crate) struct NoiseArguments {
    /// Both are folders of images, each from a cloud with a seed of its own (or what --summarise wrote): t-tests of
    /// few large means, which know that all pixels share the error of their cloud (docs/check.md)
    #[arg(long, conflicts_with_all = TWO_IMAGES)]
    replicates: bool,
    /// How many folders this run judges: their chance of a false alarm is 1e-3 together
    #[arg(long, value_name = "N", default_value = "1", requires = "replicates")]
    family: NonZeroU16,
    /// Write what --replicates needs of the folder REFERENCE, and its mean image, into the folder TEST, which holds no
    /// images
    #[arg(long, conflicts_with_all = TWO_IMAGES, conflicts_with_all = ["replicates", "json"])]
    summarise: bool,
}

/// Options that are about two images.
const TWO_IMAGES: [&str; 16] = [
    "max_bias",
    "max_relmse",
    "max_rmse",
    "max_abs",
    "max_outliers",
    "max_flip",
    "exact",
    "limits",
    "layer",
    "allow_nonfinite",
    "flip",
    "ignore_meta",
    "diff_exr",
    "heatmap",
    "html",
    "accept",
];

/// The exit code, if folders were meant.
pub(crate) fn asked_for(arguments: &Arguments) -> Option<Result<u8, Failure>> {
    match arguments.noise {
        NoiseArguments { replicates: true, .. } => Some(test(arguments)),
        NoiseArguments { summarise: true, .. } => Some(summarise(arguments)),
        NoiseArguments { .. } => None,
    }
}

/// The report with the names of its folders.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    report: &'a NoiseReport,
    reference: String,
    test: String,
    verdict: &'a str,
}

/// Bytes for each pixel, besides those of an image: sums of three channels, and the pixels of a part.
const PIXEL_BYTES: u64 = 40;

/// Refuses what cannot fit before any of it is read. Images are read one by one; what a header does not say is left to the
/// reading.
fn check_memory(images: &[PathBuf]) -> Result<(), Failure> {
    let sizes = images.iter().filter_map(|path| Some((path, Image::dimensions(path).ok()?)));
    let need = |size: &Dimensions| {
        let pixels = (size.width as u64).saturating_mul(size.height as u64);
        size.reading_bytes.saturating_add(pixels.saturating_mul(PIXEL_BYTES))
    };
    let Some((path, size)) = sizes.max_by_key(|(_, size)| need(size)) else { return Ok(()) };
    let what = format!("{}: an image of {} x {} pixels", path.display(), size.width, size.height);
    cli::require_memory(&what, Need { held: need(&size), mapped: 0 }, "render smaller replicates")
}

/// Tests the replicates of one folder against the reference of another.
fn test(arguments: &Arguments) -> Result<u8, Failure> {
    let (references, tests) = (Summary::paths(&arguments.reference)?, Replicates::paths(&arguments.test)?);
    let mut files = Files::default();
    references.iter().try_for_each(|path| files.reads("an image of REFERENCE", path))?;
    tests.iter().try_for_each(|path| files.reads("an image of TEST", path))?;
    arguments.json.iter().try_for_each(|path| files.writes("--json", path))?;
    check_memory(&references)?;
    check_memory(&tests)?;
    let reference = Summary::read(&arguments.reference)?;
    let report = judge(&reference, &Replicates::read(&arguments.test)?, usize::from(arguments.noise.family.get()))?;
    let name = arguments.test.file_name().unwrap_or_default().to_string_lossy();
    let verdict = report.verdict(&name);
    if let Some(path) = &arguments.json {
        write_json(path, arguments, &report, verdict.trim_end())?;
    }
    if !arguments.common.quiet {
        cli::print(&report.table())?;
    }
    cli::print(&verdict)?;
    Ok(if report.pass { 0 } else { 1 })
}

/// Writes what a reference folder stores of replicates.
fn summarise(arguments: &Arguments) -> Result<u8, Failure> {
    check_memory(&Replicates::paths(&arguments.reference)?)?;
    Summary::check_target(&arguments.test)?;
    let replicates = Replicates::read(&arguments.reference)?;
    Summary::of(&replicates, &arguments.reference)?.write(&replicates, &arguments.test)?;
    Ok(0)
}

fn write_json(path: &Path, arguments: &Arguments, report: &NoiseReport, verdict: &str) -> Result<(), Failure> {
    let document = Document {
        report,
        reference: arguments.reference.display().to_string(),
        test: arguments.test.display().to_string(),
        verdict,
    };
    let text = serde_json::to_string_pretty(&document)?;
    Ok(formats::atomic::write(path, (text + "\n").as_bytes())?)
}
