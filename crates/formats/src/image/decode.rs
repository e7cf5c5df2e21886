//! Decodes OpenEXR. The bytes are not trusted.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::num::NonZeroUsize;
use std::path::Path;

use exr::block::{UncompressedBlock, read, reader::ChunksReader};
use exr::compression::Compression::{PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::meta::{BlockDescription, header::Header};
use exr::prelude::{Error as ExrError, IntegerBounds, SampleType, Vec2, f16};

use super::header;
use super::parallel::parallel;
use super::types::{Channel, Image, ImageError, MAX_SAMPLES, Window};
use crate::memory::zeros;

/// First bytes of every OpenEXR file.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// A file may unpack to this many times its length, beyond what is always allowed. Deflate reaches 1032.
const MAX_EXPANSION: u64 = 2048;
/// Unpacked bytes that a thread makes before it waits for the others, and the largest number of blocks.
const BYTES_PER_THREAD: usize = 4 << 20;
const MAX_BLOCKS_PER_THREAD: usize = 256;
/// Unpacked bytes that any file may have, however short.
const ALWAYS_ALLOWED: u64 = 64 << 20;
/// Bytes at the start of a file in which its compression is found for a refusal.
const START: u64 = 1 << 20;

/// The size of an OpenEXR file as its header states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions {
    /// Pixels per row of the data window.
    pub width: usize,
    /// Rows of the data window.
    pub height: usize,
    /// Channels of all parts.
    pub channels: usize,
    /// Largest memory of [`Image::read`], including the file. Each further thread of [`Image::decode_with`] takes 12
    /// MiB or three blocks more.
    pub reading_bytes: u64,
}

impl Image {
    /// Reads the header of an OpenEXR file. Refuses what [`Image::read`] refuses because of its size or kind.
    pub fn dimensions(path: &Path) -> Result<Dimensions, ImageError> {
        outline_of_file(path).map(|outline| outline.dimensions).map_err(|e| e.of_file(path))
    }
}

/// The facts of a header about its pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    pub dimensions: Dimensions,
    /// The data window.
    pub data: Window,
    /// The display window.
    pub display: Window,
    /// True if the attribute `envmap` states the six sides of a cube instead of latitude and longitude.
    pub is_cube: bool,
    /// CIE x and y of red, green, blue and white.
    pub chromaticities: Option<[f32; 8]>,
}

/// Reads the outline of a file without its pixels.
pub(crate) fn outline_of_file(path: &Path) -> Result<Outline, ImageError> {
    let meta = std::fs::metadata(path)?;
    if !meta.is_file() {
        return Err(ImageError::NotAFile);
    }
    let mut start = Vec::new();
    File::open(path)?.take(START).read_to_end(&mut start)?;
    outline(BufReader::new(File::open(path)?), &start, meta.len())
}

/// Reads the outline of a file of this length that begins with `start`.
pub(crate) fn outline(file: impl Read + Seek, start: &[u8], length: u64) -> Result<Outline, ImageError> {
    if !start.starts_with(&MAGIC) {
        return Err(ImageError::NotOpenExr);
    }
    let reader = read(file, false).map_err(|error| refusal(error, start))?;
    let headers = reader.headers();
    check_size(headers, length)?;
    let (_, data) = common_window(headers)?;
    let first = headers.first().ok_or_else(|| damaged("it has no part"))?;
    let channels = headers.iter().map(|part| part.channels.list.len()).sum();
    let [width, height] = data.size;
    let samples = (width as u64).saturating_mul(height as u64).saturating_mul(channels as u64);
    let blocks = largest_block(headers).max(BYTES_PER_THREAD) as u64;
    let reading_bytes = length.saturating_add(samples.saturating_mul(4)).saturating_add(blocks.saturating_mul(3));
    Ok(Outline {
        dimensions: Dimensions { width, height, channels, reading_bytes },
        data,
        display: window(first.shared_attributes.display_window),
        is_cube: headers.iter().any(|part| part.own_attributes.environment_map == Some(EnvironmentMap::Cube)),
        chromaticities: first.shared_attributes.chromaticities.map(numbers),
    })
}

/// CIE x and y of red, green, blue and white.
fn numbers(Chromaticities { red, green, blue, white }: Chromaticities) -> [f32; 8] {
    [red.0, red.1, green.0, green.1, blue.0, blue.1, white.0, white.1]
}

/// Decodes a file. The blocks are unpacked by threads of this crate and not by the library's pool, so that a program
/// keeps to its number of threads.
pub(super) fn decode(bytes: &[u8], threads: NonZeroUsize) -> Result<Image, ImageError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(ImageError::NotOpenExr);
    }
    let reader = read(Cursor::new(bytes), false).map_err(|error| refusal(error, bytes))?;
    check_size(reader.headers(), bytes.len() as u64)?;
    let mut image = empty_image(reader.headers())?;
    let several = reader.headers().len() > 1;
    let mut parts: Vec<Part> = reader.headers().iter().map(Part::new).collect::<Result<_, _>>()?;
    let mut chunks = reader.filter_chunks(false, |_, tile, _| tile.level_index == Vec2(0, 0)).map_err(fault)?;
    let meta = chunks.meta_data().clone();
    let unpack = |chunk: exr::error::Result<_>| UncompressedBlock::decompress_chunk(chunk?, &meta, true);
    let group = blocks_at_a_time(&meta.headers, threads);
    loop {
        let packed: Vec<_> = chunks.by_ref().take(group).collect();
        if packed.is_empty() {
            break;
        }
        for block in parallel(threads, packed, unpack) {
            let block = block.map_err(fault)?;
            let part = parts.get_mut(block.index.layer).ok_or_else(|| damaged("a block belongs to no part"))?;
            part.store(&block)?;
        }
    }
    for part in parts {
        image.channels.extend(part.finish(several)?);
    }
    image.channels.sort_by(|a, b| a.name.as_bytes().cmp(b.name.as_bytes()));
    if let Some([twice, _]) = image.channels.array_windows().find(|[a, b]| a.name == b.name) {
        return Err(damaged(&format!("channel `{}` occurs twice", twice.name)));
    }
    image.attributes = header::attributes(bytes).ok_or_else(|| damaged("the header ends early"))?;
    Ok(image)
}

/// Blocks for all threads together: enough to outweigh the start of the threads, and few enough for memory.
fn blocks_at_a_time(headers: &[Header], threads: NonZeroUsize) -> usize {
    (BYTES_PER_THREAD / largest_block(headers)).clamp(1, MAX_BLOCKS_PER_THREAD).saturating_mul(threads.get())
}

/// Unpacked bytes of the largest block, at least 1.
fn largest_block(headers: &[Header]) -> usize {
    let bytes = |part: &Header| {
        let (block, all) = (part.max_block_pixel_size(), part.layer_size);
        let pixels = block.0.min(all.0).saturating_mul(block.1.min(all.1));
        pixels.saturating_mul(part.channels.bytes_per_pixel)
    };
    headers.iter().map(bytes).max().unwrap_or(0).max(1)
}

fn window(bounds: IntegerBounds) -> Window {
    Window { position: [bounds.position.0, bounds.position.1], size: [bounds.size.0, bounds.size.1] }
}

/// The display window and the data window, which all parts must share.
fn common_window(headers: &[Header]) -> Result<(Window, Window), ImageError> {
    // The other compressions lose data, and the library's decoders for them panic at damaged files.
    let trusted = |compression| matches!(compression, Uncompressed | RLE | ZIP1 | ZIP16 | PIZ | PXR24);
    if let Some(part) = headers.iter().find(|part| !trusted(part.compression)) {
        return Err(ImageError::Unsupported(part.compression.to_string()));
    }
    let first = headers.first().ok_or_else(|| damaged("it has no part"))?;
    if headers.iter().any(|part| part.data_window() != first.data_window()) {
        return Err(ImageError::Unsupported("its parts have different data windows".to_owned()));
    }
    Ok((window(first.shared_attributes.display_window), window(first.data_window())))
}

/// An image with the windows of all parts and no channels.
fn empty_image(headers: &[Header]) -> Result<Image, ImageError> {
    let (display, data) = common_window(headers)?;
    let display = (display != data).then_some(display);
    let [width, height] = data.size;
    Ok(Image { width, height, window: data.position, display, ..Image::default() })
}

/// Most bytes of pixels that a file of this length may state.
pub(crate) fn max_unpacked(file_length: u64) -> u64 {
    ALWAYS_ALLOWED.saturating_add(file_length.saturating_mul(MAX_EXPANSION))
}

/// Refuses sizes that need much more memory than the file, before any is allocated.
fn check_size(headers: &[Header], file_length: u64) -> Result<(), ImageError> {
    let allowed = max_unpacked(file_length);
    let mut samples = 0_u64;
    for part in headers {
        let Vec2(width, height) = part.layer_size;
        let channels = part.channels.list.len();
        if width == 0 || height == 0 || channels == 0 {
            return Err(damaged(&format!("{width} x {height} pixels with {channels} channels")));
        }
        // Data windows end below 2^30, so that width times height fits 64 bits; the channels may overflow.
        let pixels = (width as u64).saturating_mul(height as u64);
        samples = samples.saturating_add(pixels.saturating_mul(channels as u64));
        let too_large = |limit| Err(ImageError::TooLarge { width, height, channels, limit });
        if samples > MAX_SAMPLES {
            return too_large(format!("{MAX_SAMPLES} samples"));
        }
        if samples * 4 > allowed {
            return too_large(format!("a file of {file_length} bytes can hold"));
        }
        if let BlockDescription::Tiles(tiles) = part.blocks {
            let Vec2(width, height) = tiles.tile_size;
            let tile = (width as u64).saturating_mul(height as u64).saturating_mul(channels as u64);
            if tile > MAX_SAMPLES {
                return Err(damaged(&format!("tiles of {width} x {height} pixels")));
            }
        }
    }
    Ok(())
}

/// A part while its blocks are unpacked.
struct Part {
    layer: Option<String>,
    width: usize,
    channels: Vec<(SampleType, Channel)>,
    block: Vec2<usize>,
    blocks_per_row: usize,
    seen: Vec<bool>,
}

impl Part {
    fn new(header: &Header) -> Result<Part, ImageError> {
        let Vec2(width, height) = header.layer_size;
        let count = header.channels.list.len();
        let scarce = || ImageError::OutOfMemory { width, height, channels: count };
        let block = header.max_block_pixel_size();
        let blocks_per_row = width.div_ceil(block.0);
        let channels = header.channels.list.iter().map(|channel| {
            let name = header::text(channel.name.as_slice());
            let samples = zeros(width * height)?;
            Some((channel.sample_type, Channel { name, samples }))
        });
        Ok(Part {
            layer: header.own_attributes.layer_name.as_ref().map(|name| header::text(name.as_slice())),
            width,
            channels: channels.collect::<Option<_>>().ok_or_else(scarce)?,
            block,
            blocks_per_row,
            seen: zeros(blocks_per_row.saturating_mul(height.div_ceil(block.1))).ok_or_else(scarce)?,
        })
    }

    /// Stores the samples of a block. Each block may come once: the offsets in the file could name one block twice and
    /// another never.
    fn store(&mut self, block: &UncompressedBlock) -> Result<(), ImageError> {
        let (Vec2(x, y), Vec2(width, height)) = (block.index.pixel_position, block.index.pixel_size);
        let number = y / self.block.1 * self.blocks_per_row + x / self.block.0;
        match self.seen.get_mut(number) {
            Some(seen) if !*seen && block.index.level == Vec2(0, 0) => *seen = true,
            _ => return Err(damaged("a block has the position of another")),
        }
        let mut rest = block.data.as_slice();
        for row in y..y + height {
            for (kind, channel) in &mut self.channels {
                let start = row * self.width + x;
                let target = channel.samples.get_mut(start..start + width);
                let source = rest.split_at_checked(width * kind.bytes_per_sample());
                let (Some(target), Some((line, next))) = (target, source) else {
                    return Err(damaged("a block is too short, or its position lies outside the image"));
                };
                if !convert(*kind, line, target) {
                    let what = format!("channel `{}` holds integers that float32 cannot represent", channel.name);
                    return Err(ImageError::Unsupported(what));
                }
                rest = next;
            }
        }
        Ok(())
    }

    /// The channels, with the name of the part as their layer if there are several parts.
    fn finish(self, several: bool) -> Result<impl Iterator<Item = Channel>, ImageError> {
        let missing = self.seen.iter().filter(|seen| !**seen).count();
        if missing > 0 {
            return Err(damaged(&format!("{missing} of {} blocks of pixels are missing", self.seen.len())));
        }
        let layer = self.layer.filter(|layer| several && !layer.is_empty()).map(|layer| layer + ".");
        Ok(self.channels.into_iter().map(move |(_, mut channel)| {
            if let Some(layer) = layer.as_ref().filter(|layer| !channel.name.starts_with(layer.as_str())) {
                channel.name.insert_str(0, layer);
            }
            channel
        }))
    }
}

/// Converts one row of one channel, in the byte order of this machine, to float32. False if a value is not exact.
fn convert(kind: SampleType, line: &[u8], target: &mut [f32]) -> bool {
    match kind {
        SampleType::F16 => fill(target, line, |bytes| f16::from_ne_bytes(bytes).to_f32()),
        SampleType::F32 => fill(target, line, f32::from_ne_bytes),
        SampleType::U32 => {
            fill(target, line, |bytes| u32::from_ne_bytes(bytes) as f32);
            // The comparison is in float64, which represents both: in uint32 the largest value would saturate and look
            // equal.
            let mut pairs = target.iter().zip(line.as_chunks().0);
            return pairs.all(|(value, bytes)| f64::from(*value) == f64::from(u32::from_ne_bytes(*bytes)));
        }
    }
    true
}

/// Sets each number from its bytes.
fn fill<const N: usize>(target: &mut [f32], line: &[u8], value: impl Fn([u8; N]) -> f32) {
    target.iter_mut().zip(line.as_chunks().0).for_each(|(target, bytes)| *target = value(*bytes));
}

/// The error of a file, with the names of compressions that are newer than the library.
fn refusal(error: ExrError, bytes: &[u8]) -> ImageError {
    match (fault(error), header::compression(bytes)) {
        (ImageError::Unsupported(_), Some(number @ 12..)) => ImageError::Unsupported(match number {
            12 => "LJ2K compression".to_owned(),
            13 => "ZSTD compression".to_owned(),
            _ => format!("compression number {number}"),
        }),
        (error, _) => error,
    }
}

fn fault(error: ExrError) -> ImageError {
    match error {
        ExrError::NotSupported(what) => ImageError::Unsupported(what.into_owned()),
        ExrError::Invalid(what) => ImageError::Damaged(what.into_owned()),
        ExrError::Io(error) => ImageError::Damaged(error.to_string()),
        ExrError::Aborted => ImageError::Damaged("reading was broken off".to_owned()),
    }
}

fn damaged(what: &str) -> ImageError {
    ImageError::Damaged(what.to_owned())
}

#[cfg(test)]
mod tests;
