//! Reads both images. Each file is read once, so that the bytes that are judged are those that `--accept` installs.

use std::{fs, num::NonZeroUsize, path::Path};

use cli::{Failure, Need};
use formats::ImageError;
use formats::image::{Dimensions, Image};

use crate::arguments::Arguments;

/// A file and the image in it.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) image: Image,
    /// The bytes of the file if it may be accepted, else nothing.
    pub(crate) bytes: Vec<u8>,
}

/// Reads the reference and the test image at the same time, each with half of the threads, because much of the reading
/// of a file is serial.
pub(crate) fn read_both(arguments: &Arguments) -> Result<[Source; 2], Failure> {
    check_memory(arguments)?;
    let threads = arguments.common.thread_count();
    let read = |path, threads| Source::read(path, threads, arguments.accept);
    let Some(half) = NonZeroUsize::new(threads.get() / 2) else {
        return Ok([read(&arguments.reference, threads)?, read(&arguments.test, threads)?]);
    };
    std::thread::scope(|scope| {
        let reader = std::thread::Builder::new().spawn_scoped(scope, || read(&arguments.reference, half));
        let test = read(&arguments.test, half);
        let reference = match reader {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            // The operating system refused another thread.
            Err(_) => read(&arguments.reference, half),
        };
        Ok([reference?, test?])
    })
}

impl Source {
    pub(crate) fn read(path: &Path, threads: NonZeroUsize, keeps_bytes: bool) -> Result<Source, ImageError> {
        let bytes = read_bytes(path)?;
        let image = Image::decode_with(&bytes, threads).map_err(named(path))?;
        Ok(Source { image, bytes: if keeps_bytes { bytes } else { Vec::new() } })
    }
}

/// An error with the path of its file.
pub(crate) fn named(path: &Path) -> impl Fn(ImageError) -> ImageError {
    |source| ImageError::File { path: path.to_owned(), source: Box::new(source) }
}

/// Reads the bytes of a regular file.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, ImageError> {
    match fs::metadata(path) {
        Ok(facts) if !facts.is_file() => Err(named(path)(ImageError::NotAFile)),
        Ok(_) => fs::read(path).map_err(|error| named(path)(error.into())),
        Err(error) => Err(named(path)(error.into())),
    }
}

/// Refuses images that do not fit into the memory before they are read. A file with a damaged header is left to the
/// reading.
fn check_memory(arguments: &Arguments) -> Result<(), Failure> {
    let paths = [&arguments.reference, &arguments.test];
    let [Ok(reference), Ok(test)] = paths.map(|path| Image::dimensions(path)) else { return Ok(()) };
    let Dimensions { width, height, channels, .. } = test;
    let need = Need { held: need(arguments, reference, test), mapped: 0 };
    let what = format!("{}: comparing {width} x {height} pixels with {channels} channels", arguments.test.display());
    cli::require_memory(&what, need, "compare smaller images, or parts of them, or ask for fewer outputs")
}

/// The bytes of the blocks that a thread unpacks, and of the tiles that it measures.
const THREAD_BYTES: u64 = 16 << 20;
/// The bytes of the histograms of a channel.
const CHANNEL_BYTES: u64 = 1 << 20;
/// The bytes for each pixel of the maps of FLIP; 4 were measured.
const FLIP_BYTES: u64 = 8;
/// The bytes for each pixel of the heatmap and its file; 3 were measured.
const HEATMAP_BYTES: u64 = 8;
/// The bytes for each sample of the difference and of its file.
const DIFFERENCE_BYTES: u64 = 8;
/// The bytes for each sample of the page, and the bytes of the largest page, which has 100 MB and is made of copies.
const PAGE_BYTES: u64 = 8;
const MAX_PAGE_BYTES: u64 = 400 << 20;

/// The largest number of bytes in use at a time: both images, and the files that they are read from or the outputs.
fn need(arguments: &Arguments, reference: Dimensions, test: Dimensions) -> u64 {
    let product = |factors: &[u64]| factors.iter().copied().fold(1, u64::saturating_mul);
    let pixels = |size: Dimensions| product(&[size.width as u64, size.height as u64]);
    let samples = |size: Dimensions| product(&[pixels(size), size.channels as u64]);
    let images = product(&[4, samples(reference).saturating_add(samples(test))]);
    let reading = reference.reading_bytes.saturating_add(test.reading_bytes).saturating_sub(images);
    let may_need_flip =
        arguments.flip || arguments.limits.is_some() || arguments.gates.0.iter().any(|gate| gate.needs_flip());
    // The outputs are made one after the other, so only the largest counts.
    let made = [
        (may_need_flip, product(&[FLIP_BYTES, pixels(test)])),
        (arguments.heatmap.is_some(), product(&[HEATMAP_BYTES, pixels(test)])),
        (arguments.diff_exr.is_some(), product(&[DIFFERENCE_BYTES, samples(test)])),
        (arguments.html.is_some(), product(&[PAGE_BYTES, samples(test)]).min(MAX_PAGE_BYTES)),
    ];
    let made = made.into_iter().filter(|(asked, _)| *asked).map(|(_, bytes)| bytes).max().unwrap_or(0);
    let work = if arguments.accept { reading.saturating_add(made) } else { reading.max(made) };
    // Threads that a small image does not keep busy need no memory.
    let threads = product(&[THREAD_BYTES, arguments.common.thread_count().get() as u64]).min(images);
    let histograms = product(&[CHANNEL_BYTES, test.channels as u64]);
    [images, work, threads, histograms].into_iter().fold(0, u64::saturating_add)
}
