//! Import of textures, from PNG, JPEG and WebP pictures.

use super::{
    container::Document,
    fault::{Fault, Result, get},
    jpeg,
};
use crate::texture::{Picture, Texture, Wrap};
use glam::{DMat2, DVec2};
use gltf::json::{
    self, Index,
    texture::{Info, MagFilter, Sampler, WrappingMode},
    validation::Checked,
};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use memmap2::MmapMut;
use std::{borrow::Cow, collections::BTreeMap, io::Cursor, path::PathBuf, sync::Arc};

/// Most texels of one picture and of all, because a small file can state a large picture.
const MAX_TEXELS: u64 = 1 << 26;
const MAX_TEXELS_OF_ALL: u64 = 1 << 28;

/// Pictures that may fail to be read before the rest are not tried.
const MAX_FAILURES: u32 = 8;

/// Reads textures. Each picture is read once, for any number of textures and images that name it.
pub(super) struct Textures<'a> {
    document: &'a Document,
    /// A picture that cannot be read is tried once, too.
    known: BTreeMap<Source, Result<Arc<Picture>>>,
    /// How many more may fail before the rest are not tried: a failure has cost as much as a picture.
    failures_left: u32,
    texels_left: u64,
    /// Bytes of buffers that are left for pictures.
    bytes_left: u64,
}

/// The source of a picture.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Source {
    /// Canonical path.
    File(PathBuf),
    /// Bytes of a buffer: address and length.
    View(usize, usize),
    /// The data URI of the image with this index.
    Own(usize),
}

impl<'a> Textures<'a> {
    pub fn new(document: &'a Document) -> Self {
        let bytes_left = document.buffer_bytes();
        Textures {
            document,
            known: BTreeMap::new(),
            failures_left: MAX_FAILURES,
            texels_left: MAX_TEXELS_OF_ALL,
            bytes_left,
        }
    }

    pub fn read(&mut self, info: &Info) -> Result<Texture> {
        let root = &self.document.root;
        let texture = get(&root.textures, &info.index, "index")?;
        let none = || format!("textures[{}] has no PNG, JPEG or WebP `source`; export it with one", info.index.value());
        let source = source_of(texture).ok_or_else(none)?;
        let sampler = texture.sampler.as_ref().map(|s| get(&root.samplers, s, "texture.sampler")).transpose()?;
        let image = get(&root.images, &source, "texture.source")?;
        let index = source.value();
        let picture = self.picture(index, image).map_err(|e| format!("{}: {e}", name_of(index, image)))?;
        let wrap = |mode: fn(&Sampler) -> Checked<WrappingMode>| match sampler.map(mode) {
            None | Some(Checked::Valid(WrappingMode::Repeat)) => Ok(Wrap::Repeat),
            Some(Checked::Valid(WrappingMode::MirroredRepeat)) => Ok(Wrap::Mirror),
            Some(Checked::Valid(WrappingMode::ClampToEdge)) => Ok(Wrap::Clamp),
            Some(Checked::Invalid) => Err(Fault::from("sampler: unknown wrap mode")),
        };
        let wrap = [wrap(|s| s.wrap_s)?, wrap(|s| s.wrap_t)?];
        let nearest = sampler.is_some_and(|s| s.mag_filter == Some(Checked::Valid(MagFilter::Nearest)));
        Ok(Texture { picture, wrap, nearest })
    }

    fn picture(&mut self, index: usize, image: &json::Image) -> Result<Arc<Picture>> {
        let view = image.buffer_view.as_ref().filter(|_| image.uri.is_none());
        let view = view.map(|view| self.document.view(view)).transpose()?;
        let source = match (&image.uri, view) {
            (Some(uri), _) if uri.starts_with("data:") => Source::Own(index),
            (Some(uri), _) => Source::File(self.document.files.borrow().locate(uri)?.1),
            (None, Some(bytes)) => Source::View(bytes.as_ptr() as usize, bytes.len()),
            (None, None) => return Err("the image has neither uri nor bufferView".into()),
        };
        if let Some(known) = self.known.get(&source) {
            return known.clone();
        }
        if self.failures_left == 0 {
            return Err(format!("it is not read, because {MAX_FAILURES} others cannot be"));
        }
        let picture = self.decoded(image, view).map(Arc::new);
        match &picture {
            Ok(picture) => self.texels_left -= picture.texels.len() as u64,
            Err(_) => self.failures_left -= 1,
        }
        self.known.insert(source, picture.clone());
        picture
    }

    fn decoded(&mut self, image: &json::Image, view: Option<&[u8]>) -> Result<Picture> {
        let Some(bytes) = view else {
            let bytes = self.document.files.borrow_mut().resolve(image.uri.as_deref().unwrap_or_default())?;
            return decode(&bytes, self.texels_left);
        };
        // Pictures that do not overlap never exceed this. A short file could name one picture many times, each time a
        // byte longer.
        let left = self.bytes_left.checked_sub(bytes.len() as u64);
        self.bytes_left = left.ok_or("the bufferViews of the images overlap; export them apart")?;
        decode(bytes, self.texels_left)
    }
}

/// The image of a texture: the PNG or JPEG one, or else that of EXT_texture_webp.
pub(super) fn source_of(texture: &json::Texture) -> Option<Index<json::Image>> {
    if texture.source.value() != u32::MAX as usize {
        return Some(texture.source);
    }
    let webp = texture.extensions.as_ref()?.others.get("EXT_texture_webp")?.get("source")?.as_u64()?;
    u32::try_from(webp).ok().map(Index::new)
}

fn name_of(index: usize, image: &json::Image) -> String {
    let file = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    match file.or(image.name.as_deref()) {
        Some(name) => format!("images[{index}] `{name}`"),
        None => format!("images[{index}]"),
    }
}

/// A PNG without the chunks of compressed text and profiles, which are not used and may be a thousand times as long
/// when decompressed.
fn without_compressed_chunks(bytes: &[u8]) -> Cow<'_, [u8]> {
    const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
    const PACKED: [&[u8]; 3] = [b"iCCP", b"zTXt", b"iTXt"];
    let mut kept = Cow::Borrowed(bytes);
    let Some(mut rest) = bytes.strip_prefix(SIGNATURE) else { return kept };
    // A chunk is length, name, content and checksum. The decoder refuses a shorter one.
    while let Some((size, after)) = rest.split_first_chunk::<4>() {
        let length = (u32::from_be_bytes(*size) as usize).saturating_add(12);
        let Some((chunk, next)) = rest.split_at_checked(length) else { break };
        let offset = bytes.len() - rest.len();
        let packed = PACKED.iter().any(|name| after.starts_with(name));
        match &mut kept {
            Cow::Borrowed(_) if packed => kept = Cow::Owned(bytes[..offset].to_vec()),
            Cow::Owned(kept) if !packed => kept.extend(chunk),
            _ => {}
        }
        rest = next;
    }
    if let Cow::Owned(kept) = &mut kept {
        kept.extend(rest);
    }
    kept
}

/// Whether a RIFF file, such as a WebP picture, has all bytes that its header states.
fn is_whole_riff(bytes: &[u8]) -> bool {
    let size = bytes.get(4..8).and_then(|b| b.try_into().ok()).map_or(0, u32::from_le_bytes);
    bytes.len() as u64 >= 8 + u64::from(size)
}

/// Decodes a picture of at most `room` texels. Messages do not repeat those of the decoder, which show bytes, because a
/// link can make a picture of any file.
fn decode(bytes: &[u8], room: u64) -> Result<Picture> {
    const WAY_OUT: &str = "export it as PNG, JPEG or WebP";
    let fault = |_| format!("the picture is damaged or of a kind that is not supported; {WAY_OUT} again");
    let bytes = without_compressed_chunks(bytes);
    let reader = ImageReader::new(Cursor::new(&*bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let format = reader.format();
    if !matches!(format, Some(ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) {
        return Err(format!("neither a PNG, a JPEG nor a WebP picture; {WAY_OUT}"));
    }
    let decoder = reader.into_decoder().map_err(fault)?;
    let (width, height) = decoder.dimensions();
    let texels = u64::from(width) * u64::from(height);
    if texels == 0 || texels > MAX_TEXELS.min(room) {
        let limits = format!("1 to {MAX_TEXELS} texels are supported, {MAX_TEXELS_OF_ALL} in all pictures of a scene");
        return Err(format!("{width} x {height} texels: {limits}; export it smaller"));
    }
    // The system is asked for the memory first, because a failure of the decoder could not name the picture.
    let needed = decoder.total_bytes().saturating_add(8 * texels);
    let space = MmapMut::map_anon(needed as usize);
    space.map_err(|_| format!("not enough memory for {width} x {height} texels; export it smaller"))?;
    if format == Some(ImageFormat::WebP) && !is_whole_riff(&bytes) {
        return Err(format!("the WebP picture ends early; {WAY_OUT} again"));
    }
    if format == Some(ImageFormat::Jpeg) {
        jpeg::check(&bytes).map_err(|e| format!("{e}; {WAY_OUT} again"))?;
    }
    let pixels = DynamicImage::from_decoder(decoder).map_err(fault)?.into_rgba8();
    Ok(Picture { width: width as usize, texels: pixels.into_raw().as_chunks().0.to_vec() })
}

/// The set of texture coordinates that a texture uses, and their transform (KHR_texture_transform).
pub(super) struct Coordinates {
    pub set: u32,
    linear: DMat2,
    offset: DVec2,
}

impl Coordinates {
    pub fn new(info: &Info) -> Result<Self> {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone()).unwrap_or_default();
        let [offset, scale] = [transform.offset.0, transform.scale.0].map(|v| DVec2::from_array(v.map(f64::from)));
        let rotation = f64::from(transform.rotation.0);
        if !(offset.is_finite() && scale.is_finite() && rotation.is_finite()) {
            return Err("KHR_texture_transform: its numbers must be finite".into());
        }
        // Scale, then rotation, then offset. `v` points down, so that the rotation is clockwise.
        let linear = DMat2::from_angle(-rotation) * DMat2::from_diagonal(scale);
        Ok(Coordinates { set: transform.tex_coord.unwrap_or(info.tex_coord), linear, offset })
    }

    /// Transformed coordinates.
    pub fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        (self.linear * DVec2::new(f64::from(u), f64::from(v)) + self.offset).as_vec2().to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: lengths that are too short for the twelve bytes around the content.
    #[test]
    fn compressed_chunks_of_a_png_are_left_out() {
        let chunk = |name: &str, content: &[u8]| {
            [&(content.len() as u32).to_be_bytes(), name.as_bytes(), content, b"crc!"].concat()
        };
        let signature = b"\x89PNG\r\n\x1a\n".to_vec();
        let [header, data, end] = [chunk("IHDR", b"size"), chunk("IDAT", b"iCCP zTXt"), chunk("IEND", b"")];
        let plain = [&signature[..], &header, &data, &end].concat();
        assert!(matches!(without_compressed_chunks(&plain), Cow::Borrowed(bytes) if bytes == plain));
        for packed in [chunk("iCCP", b"bomb"), chunk("zTXt", b""), chunk("iTXt", &[0; 99])] {
            let bytes = [&signature[..], &header, &packed, &data, &packed, &packed, &end].concat();
            assert_eq!(&*without_compressed_chunks(&bytes), plain);
            let cut = [&signature[..], &header, &packed, &data[..7]].concat();
            assert_eq!(&*without_compressed_chunks(&cut), [&signature[..], &header, &data[..7]].concat());
        }
        let endless = [&signature[..], &u32::MAX.to_be_bytes(), b"iCCP"].concat();
        assert_eq!(&*without_compressed_chunks(&endless), endless);
        assert_eq!(&*without_compressed_chunks(b"\xff\xd8\xff"), b"\xff\xd8\xff");
    }
}
