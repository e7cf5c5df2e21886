//! `compare --replicates` and `--summarise`, which take folders of images instead of two images.

use std::path::PathBuf;

use cli::{Failure, Files, Need};
use compare::replicates::{Replicates, Summary, judge};
use formats::image::{Dimensions, Image};

use crate::arguments::{Arguments, NoiseArguments};
use crate::outputs::Document;

/// The exit code if the arguments ask for one of the two.
pub(crate) fn asked_for(arguments: &Arguments) -> Option<Result<u8, Failure>> {
    match arguments.noise {
        NoiseArguments { replicates: true, .. } => Some(test(arguments)),
        NoiseArguments { summarise: true, .. } => Some(summarise(arguments)),
        NoiseArguments { .. } => None,
    }
}

/// The bytes for each pixel besides those of an image, for sums of three channels and the pixels of a tile.
const PIXEL_BYTES: u64 = 40;

/// Refuses images that do not fit into the memory before they are read. Images are read one by one; a file with a
/// damaged header is left to the reading.
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
        formats::atomic::write(path, &Document::new(arguments, &report, &verdict).json()?)?;
    }
    if !arguments.common.quiet {
        cli::print(&report.table())?;
    }
    cli::print(&verdict)?;
    Ok(if report.pass { 0 } else { 1 })
}

/// Writes the summary of the replicates of one folder into another.
fn summarise(arguments: &Arguments) -> Result<u8, Failure> {
    check_memory(&Replicates::paths(&arguments.reference)?)?;
    Summary::check_target(&arguments.test)?;
    let replicates = Replicates::read(&arguments.reference)?;
    Summary::of(&replicates, &arguments.reference)?.write(&replicates, &arguments.test)?;
    Ok(0)
}
