//! Pictures that the file names: PNG and JPEG.

use super::{Fault, container::Document, get};
use crate::texture::{Picture, Texture, Wrap};
use glam::{DMat2, DVec2};
use gltf::json::{
    self,
    texture::{Info, MagFilter, Sampler, WrappingMode},
    validation::Checked,
};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::{collections::BTreeMap, hint::black_box, io::Cursor, sync::Arc};

/// Most texels of one picture, and of all: a small file can claim to be a large picture.
const MAX_TEXELS: u64 = 1 << 26;
const MAX_TEXELS_OF_ALL: u64 = 1 << 28;

/// Reads textures; each picture once, however many use it.
pub(super) struct Textures<'a> {
    document: &'a Document,
    known: BTreeMap<usize, Arc<Picture>>,
    texels_left: u64,
}

impl<'a> Textures<'a> {
    pub fn new(document: &'a Document) -> Self {
        Textures { document, known: BTreeMap::new(), texels_left: MAX_TEXELS_OF_ALL }
    }

    pub fn read(&mut self, info: &Info) -> Result<Texture, Fault> {
        let root = &self.document.root;
        let texture = get(&root.textures, &info.index, "index")?;
        if texture.source.value() == u32::MAX as usize {
            return Err(format!("textures[{}] has no PNG or JPEG `source`; export it with one", info.index.value()));
        }
        let sampler = texture.sampler.as_ref().map(|s| get(&root.samplers, s, "texture.sampler")).transpose()?;
        let image = get(&root.images, &texture.source, "texture.source")?;
        let index = texture.source.value();
        let picture = match self.known.get(&index) {
            Some(picture) => picture.clone(),
            None => Arc::new(self.picture(image).map_err(|e| format!("{}: {e}", name_of(index, image)))?),
        };
        self.known.insert(index, picture.clone());
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

    fn picture(&mut self, image: &json::Image) -> Result<Picture, Fault> {
        let picture = match (&image.uri, &image.buffer_view) {
            (Some(uri), _) => decode(&self.document.files.borrow_mut().resolve(uri)?, self.texels_left)?,
            (None, Some(view)) => decode(self.document.view(view)?, self.texels_left)?,
            (None, None) => return Err("it has neither uri nor bufferView".into()),
        };
        self.texels_left -= picture.texels.len() as u64;
        Ok(picture)
    }
}

fn name_of(index: usize, image: &json::Image) -> String {
    let file = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    match file.or(image.name.as_deref()) {
        Some(name) => format!("images[{index}] `{name}`"),
        None => format!("images[{index}]"),
    }
}

/// Decodes a picture of no more texels than there is room for.
fn decode(bytes: &[u8], room: u64) -> Result<Picture, Fault> {
    const WAY_OUT: &str = "export it as PNG or JPEG";
    let fault = |e: image::ImageError| format!("{e}; {WAY_OUT} again");
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err(format!("neither a PNG nor a JPEG picture; {WAY_OUT}"));
    }
    let decoder = reader.into_decoder().map_err(fault)?;
    let (width, height) = decoder.dimensions();
    let texels = u64::from(width) * u64::from(height);
    if texels == 0 || texels > MAX_TEXELS.min(room) {
        let limits = format!("1 to {MAX_TEXELS} texels are read, {MAX_TEXELS_OF_ALL} in all pictures of a scene");
        return Err(format!("{width} x {height} texels: {limits}; export it smaller"));
    }
    // Asked for and given back: what follows would end without a message where so much cannot be had.
    let mut space: Vec<u8> = Vec::new();
    let needed = decoder.total_bytes().saturating_add(8 * texels);
    let space = space.try_reserve_exact(needed as usize).map(|()| drop(black_box(space)));
    space.map_err(|_| format!("not enough memory for {width} x {height} texels; export it smaller"))?;
    let pixels = DynamicImage::from_decoder(decoder).map_err(fault)?.into_rgba8();
    Ok(Picture { width: width as usize, texels: pixels.into_raw().as_chunks().0.to_vec() })
}

/// Which texture coordinates of a primitive a texture takes, and where it puts them (KHR_texture_transform).
pub(super) struct Coordinates {
    pub set: u32,
    linear: DMat2,
    offset: DVec2,
}

impl Coordinates {
    pub fn new(info: &Info) -> Result<Self, Fault> {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone()).unwrap_or_default();
        let [offset, scale] = [transform.offset.0, transform.scale.0].map(|v| DVec2::from_array(v.map(f64::from)));
        let rotation = f64::from(transform.rotation.0);
        if !(offset.is_finite() && scale.is_finite() && rotation.is_finite()) {
            return Err("KHR_texture_transform: its numbers must be finite".into());
        }
        // Scaled, then turned, then moved; `v` points down, so that it turns against an angle.
        let linear = DMat2::from_angle(-rotation) * DMat2::from_diagonal(scale);
        Ok(Coordinates { set: transform.tex_coord.unwrap_or(info.tex_coord), linear, offset })
    }

    /// Coordinates in the picture.
    pub fn place(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        (self.linear * DVec2::new(f64::from(u), f64::from(v)) + self.offset).as_vec2().to_array()
    }
}
