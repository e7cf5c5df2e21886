//! Encodes OpenEXR.

use std::collections::HashMap;
use std::io::Cursor;
use std::num::NonZeroUsize;

use exr::block::{BlockIndex, UncompressedBlock, write, writer::ChunksWriter};
use exr::meta::{BlockDescription, attribute::Chromaticities, header::Header};
use exr::prelude::{AttributeValue, ChannelDescription, Compression, IntegerBounds, LayerAttributes, LineOrder};
use exr::prelude::{SampleType, SmallVec, Text, Vec2};

use super::header;
use super::parallel::parallel;
use super::types::{Attribute, Channel, Image, ImageError, MAX_SAMPLES, Window};

/// Blocks of 16 rows that a thread compresses at a time: enough to outweigh the start of the thread, and few enough for
/// memory.
const BLOCKS_PER_THREAD: usize = 4;
/// Longest name of a channel or attribute, bytes (OpenEXR file layout, "long names").
const MAX_NAME: usize = 255;
/// Longest name of a type, bytes. Only names of channels and attributes set the flag for long names.
const MAX_KIND: usize = 31;
/// Largest coordinate of a data window that OpenEXR libraries accept.
const MAX_COORDINATE: i64 = (i32::MAX / 2) as i64;

/// Encodes an image. Several threads compress the blocks, which takes most of the time; then they are written in order.
pub(super) fn encode(image: &Image, threads: NonZeroUsize) -> Result<Vec<u8>, ImageError> {
    check(image)?;
    let mut channels: Vec<&Channel> = image.channels.iter().collect();
    channels.sort_by(|a, b| a.name.as_bytes().cmp(b.name.as_bytes()));
    let header = describe(image, &channels);
    let mut file = Cursor::new(Vec::new());
    // The checks of the library are off: they refuse standard attributes for which it has fields.
    write(&mut file, SmallVec::from_iter([header]), false, |meta, writer| {
        let blocks: Vec<_> = meta.enumerate_ordered_header_block_indices().collect();
        for group in blocks.chunks(threads.get().saturating_mul(BLOCKS_PER_THREAD)) {
            let compress =
                |(position, index)| (position, block(image.width, &channels, index).compress_to_chunk(&meta.headers));
            for (position, chunk) in parallel(threads, group.to_vec(), compress) {
                writer.write_chunk(position, chunk?)?;
            }
        }
        Ok(())
    })
    .map_err(|error| ImageError::Unwritable(error.to_string()))?;
    let mut bytes = file.into_inner();
    header::sort(&mut bytes)?;
    Ok(bytes)
}

/// The samples of a block of whole rows as the file stores them: row by row, and in a row channel by channel.
fn block(width: usize, channels: &[&Channel], index: BlockIndex) -> UncompressedBlock {
    let first = index.pixel_position.y();
    let rows = first..first + index.pixel_size.height();
    let mut data = Vec::with_capacity(rows.len() * width * channels.len() * 4);
    for row in rows {
        for channel in channels {
            let samples = &channel.samples[row * width..(row + 1) * width];
            data.extend(samples.iter().flat_map(|sample| sample.to_ne_bytes()));
        }
    }
    UncompressedBlock { index, data }
}

fn describe(image: &Image, channels: &[&Channel]) -> Header {
    let list = channels.iter().map(|channel| ChannelDescription {
        name: text(&channel.name),
        sample_type: SampleType::F32,
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    });
    let bounds = |Window { position: [x, y], size: [w, h] }| IntegerBounds::new(Vec2(x, y), Vec2(w, h));
    let data = bounds(Window { position: image.window, size: [image.width, image.height] });
    let others = image.attributes.iter().filter(|(name, _)| !REQUIRED.contains(&name.as_str()));
    let attributes = LayerAttributes {
        layer_position: data.position,
        other: others.map(|(name, value)| (text(name), attribute(value))).collect::<HashMap<_, _>>(),
        ..LayerAttributes::default()
    };
    let mut header = Header::new(text(""), data.size, list.collect())
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_display_window(image.display.map_or(data, bounds))
        .with_attributes(attributes);
    require(&mut header, image);
    header
}

/// Attributes that every file has and for which the library has a field.
const REQUIRED: [&str; 3] = [header::PIXEL_ASPECT, header::SCREEN_CENTER, header::SCREEN_WIDTH];

/// Sets the required attributes that the image has; their types were checked.
fn require(header: &mut Header, image: &Image) {
    if let Some(Attribute::Float(aspect)) = image.attributes.get(header::PIXEL_ASPECT) {
        header.shared_attributes.pixel_aspect = *aspect;
    }
    if let Some(Attribute::Float(width)) = image.attributes.get(header::SCREEN_WIDTH) {
        header.own_attributes.screen_window_width = *width;
    }
    if let Some(Attribute::Other { value, .. }) = image.attributes.get(header::SCREEN_CENTER)
        && let [x, y] = value.as_chunks::<4>().0
    {
        header.own_attributes.screen_window_center = Vec2(f32::from_le_bytes(*x), f32::from_le_bytes(*y));
    }
}

/// Text of the library. OpenEXR defines no encoding, and its tools show UTF-8.
fn text(value: &str) -> Text {
    Text::from_bytes_unchecked(SmallVec::from_slice(value.as_bytes()))
}

fn attribute(value: &Attribute) -> AttributeValue {
    match value {
        Attribute::Text(value) => AttributeValue::Text(text(value)),
        Attribute::Float(value) => AttributeValue::F32(*value),
        Attribute::Double(value) => AttributeValue::F64(*value),
        Attribute::Int(value) => AttributeValue::I32(*value),
        Attribute::Vector([x, y, z]) => AttributeValue::FloatVec3((*x, *y, *z)),
        Attribute::Matrix(value) => AttributeValue::Matrix4x4(*value),
        Attribute::Chromaticities(value) => AttributeValue::Chromaticities(Chromaticities {
            red: Vec2(value[0], value[1]),
            green: Vec2(value[2], value[3]),
            blue: Vec2(value[4], value[5]),
            white: Vec2(value[6], value[7]),
        }),
        Attribute::Texts(values) => AttributeValue::TextVector(values.iter().map(|value| text(value)).collect()),
        Attribute::Other { kind, value } => {
            AttributeValue::Custom { kind: text(kind), bytes: SmallVec::from_slice(value) }
        }
    }
}

fn check(image: &Image) -> Result<(), ImageError> {
    let (width, height, channels) = (image.width, image.height, image.channels.len());
    let samples = [width, height, channels].iter().try_fold(1_u64, |n, m| n.checked_mul(*m as u64));
    if samples.is_none_or(|samples| samples > MAX_SAMPLES) {
        return Err(ImageError::TooLarge { width, height, channels, limit: format!("{MAX_SAMPLES} samples") });
    }
    if samples == Some(0) {
        return unwritable(format!("{width} x {height} pixels with {channels} channels are empty"));
    }
    check_window("data", Window { position: image.window, size: [width, height] })?;
    image.display.map_or(Ok(()), |display| check_window("display", display))?;
    check_channels(image)?;
    image.attributes.iter().try_for_each(|(name, value)| check_attribute(name, value))
}

fn check_window(which: &str, window: Window) -> Result<(), ImageError> {
    for (origin, length) in window.position.into_iter().zip(window.size) {
        let end = i64::try_from(length).ok().and_then(|length| length.checked_add(i64::from(origin)));
        if length == 0 || i64::from(origin) <= -MAX_COORDINATE || end.is_none_or(|end| end >= MAX_COORDINATE) {
            return unwritable(format!("{which} window {origin} + {length} lies beyond {MAX_COORDINATE}"));
        }
    }
    Ok(())
}

fn check_channels(image: &Image) -> Result<(), ImageError> {
    let mut names = std::collections::HashSet::new();
    for Channel { name, samples } in &image.channels {
        check_name("channel", name)?;
        if !names.insert(name) {
            return unwritable(format!("channel `{name}` occurs twice"));
        }
        if samples.len() != image.width * image.height {
            let (width, height, found) = (image.width, image.height, samples.len());
            return unwritable(format!("channel `{name}` has {found} samples, not {width} x {height}"));
        }
    }
    Ok(())
}

fn check_attribute(name: &str, value: &Attribute) -> Result<(), ImageError> {
    check_name("attribute", name)?;
    if let Attribute::Other { kind, .. } = value {
        check_kind(name, kind)?;
    }
    if header::LAYOUT.contains(&name) {
        return unwritable(format!("attribute `{name}` describes the layout of the file"));
    }
    let value = attribute(value);
    let kind = header::text(value.kind_name());
    match header::standard_kind(name) {
        Some(expected) if expected != kind => {
            unwritable(format!("attribute `{name}` must be of type {expected}, not {kind}"))
        }
        _ => Ok(()),
    }
}

/// Checks the name of a type: the library panics at an empty one.
fn check_kind(name: &str, kind: &str) -> Result<(), ImageError> {
    if kind.is_empty() || kind.len() > MAX_KIND || kind.contains('\0') {
        return unwritable(format!(
            "attribute `{name}` is of type {kind:?}, not of 1 to {MAX_KIND} bytes without a zero"
        ));
    }
    Ok(())
}

fn check_name(what: &str, name: &str) -> Result<(), ImageError> {
    if name.is_empty() || name.len() > MAX_NAME || name.contains('\0') {
        return unwritable(format!("{what} name {name:?} is not of 1 to {MAX_NAME} bytes without a zero"));
    }
    Ok(())
}

fn unwritable<T>(fault: String) -> Result<T, ImageError> {
    Err(ImageError::Unwritable(fault))
}

#[cfg(test)]
mod tests;
