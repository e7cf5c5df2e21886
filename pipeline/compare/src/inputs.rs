//! Both images. Each file is read once, so that what is judged is what `--accept` logs and installs.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

use cli::{Failure, Need};
use formats::ImageError;
use formats::image::{Dimensions, Image};

use crate::arguments::Arguments;

/// A file and the image in it.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) image: Image,
    /// All bytes of the file if it is to be accepted; else none.
    pub(crate) bytes: Vec<u8>,
}

/// The reference and the test image at once, each by half of the threads: much of reading a file is not shared among them.
pub(crate) fn read_both(arguments: &Arguments) -> Result<[Source; 2], Failure> {
    check_memory(arguments)?;
    let threads = arguments.threads();
    let read = |path, threads| Source::read(path, threads, arguments.accept);
    let Some(half) = NonZeroUsize::new(threads.get() / 2) else {
        return Ok([read(&arguments.reference, threads)?, read(&arguments.test, threads)?]);
    };
    std::thread::scope(|scope| {
        let beside = std::thread::Builder::new().spawn_scoped(scope, || read(&arguments.reference, half));
        let test = read(&arguments.test, half);
        let reference = match beside {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            // No thread is to be had.
            Err(_) => read(&arguments.reference, half),
        };
        Ok([reference?, test?])
    })
}

impl Source {
    pub(crate) fn read(path: &Path, threads: NonZeroUsize, keeps_bytes: bool) -> Result<Source, ImageError> {
        let name = |source| ImageError::File { path: path.to_owned(), source: Box::new(source) };
        let bytes = bytes(path).map_err(name)?;
        let image = Image::decode_with(&bytes, threads).map_err(name)?;
        Ok(Source { image, bytes: if keeps_bytes { bytes } else { Vec::new() } })
    }
}

/// All bytes of a regular file.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, ImageError> {
    if !fs::metadata(path)?.is_file() {
        return Err(ImageError::NotAFile);
    }
    Ok(fs::read(path)?)
}

/// Refuses what cannot fit before any of it is read. What a header does not say is left to the reading.
fn check_memory(arguments: &Arguments) -> Result<(), Failure> {
    let paths = [&arguments.reference, &arguments.test];
    let [Ok(reference), Ok(test)] = paths.map(|path| Image::dimensions(path)) else { return Ok(()) };
    let Dimensions { width, height, channels, .. } = test;
    let need = Need { held: need(arguments, reference, test), mapped: 0 };
    let what = format!("{}: comparing {width} x {height} pixels with {channels} channels", arguments.test.display());
    cli::require_memory(&what, need, "compare smaller images, or parts of them, or ask for fewer outputs")
}

/// Bytes of blocks that a thread unpacks, and of tiles that it measures.
const THREAD_BYTES: u64 = 16 << 20;
/// Bytes of the histograms of a channel.
const CHANNEL_BYTES: u64 = 1 << 20;
/// Bytes for each pixel of the maps of FLIP; 4 were measured.
const FLIP_BYTES: u64 = 8;
/// Bytes for each pixel of the heatmap and its file; 3 were measured.
const HEATMAP_BYTES: u64 = 8;
/// Bytes for each sample of the difference and its file, which is no longer than it.
const DIFFERENCE_BYTES: u64 = 8;
/// Bytes for each sample of the page, and the most of all: it has 100 MB, and is put together of copies.
const PAGE_BYTES: u64 = 8;
const MAX_PAGE_BYTES: u64 = 400 << 20;

/// Bytes at the worst moment: both images, and what they are read from or what is made of them.
fn need(arguments: &Arguments, reference: Dimensions, test: Dimensions) -> u64 {
    let product = |factors: &[u64]| factors.iter().copied().fold(1, u64::saturating_mul);
    let pixels = |size: Dimensions| product(&[size.width as u64, size.height as u64]);
    let samples = |size: Dimensions| product(&[pixels(size), size.channels as u64]);
    let images = product(&[4, samples(reference).saturating_add(samples(test))]);
    let reading = reference.reading_bytes.saturating_add(test.reading_bytes).saturating_sub(images);
    let may_need_flip = arguments.flip || arguments.max_flip.is_some() || arguments.limits.is_some();
    // One after the other.
    let made = [
        (may_need_flip, product(&[FLIP_BYTES, pixels(test)])),
        (arguments.heatmap.is_some(), product(&[HEATMAP_BYTES, pixels(test)])),
        (arguments.diff_exr.is_some(), product(&[DIFFERENCE_BYTES, samples(test)])),
        (arguments.html.is_some(), product(&[PAGE_BYTES, samples(test)]).min(MAX_PAGE_BYTES)),
    ];
    let made = made.into_iter().filter(|(asked, _)| *asked).map(|(_, bytes)| bytes).max().unwrap_or(0);
    let beside = if arguments.accept { reading.saturating_add(made) } else { reading.max(made) };
    // Threads that a small image does not keep busy take nothing.
    let threads = product(&[THREAD_BYTES, arguments.threads().get() as u64]).min(images);
    let histograms = product(&[CHANNEL_BYTES, test.channels as u64]);
    [images, beside, threads, histograms].into_iter().fold(0, u64::saturating_add)
}
