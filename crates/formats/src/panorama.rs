//! Pictures of light from all around: OpenEXR or Radiance HDR, told apart by their first bytes.

use crate::{
    Error, Image, ImageError,
    image::decode::{Outline, max_unpacked, outline, outline_of_file},
    memory::has_room,
};
use std::{fs::File, io::Read, path::Path};
use window::Overlap;

mod color;
mod radiance;
mod window;

/// Pixels of linear Rec. 709 red, green and blue; a number that is no radiance in the file is still in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row, top row first.
    pub pixels: Vec<[f32; 3]>,
    /// What the picture differs in from the numbers of the file, a sentence each.
    pub warnings: Vec<String>,
}

/// What the header of a picture says about its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PanoramaSize {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Most bytes that [`Panorama::read`] fills at a time.
    pub reading_bytes: u64,
}

/// Most pixels of a picture.
const MAX_PIXELS: usize = 1 << 27;
/// Bytes of a pixel.
const PIXEL_BYTES: u64 = 12;
/// Bytes of a file in which the header of an HDR picture ends.
const START: u64 = 1 << 20;

impl Panorama {
    /// Reads a file.
    ///
    /// Of OpenEXR, the display window is the picture: black where the data window has no pixels, without those that it
    /// has beyond. Colors of other `chromaticities`, or of other `PRIMARIES` of an HDR file, become Rec. 709, adapted to
    /// its white (Bradford); negative channels of colors outside of it become 0 with a warning. `R`, `G` and `B` are
    /// taken as they are beside an alpha channel, that is over black. `whiteLuminance`, `pixelAspectRatio`, `PIXASPECT` and
    /// `VIEW` change nothing; exposures and color corrections of an HDR file are undone. What has another
    /// projection or color model is refused.
    pub fn read(path: &Path) -> Result<Panorama, Error> {
        Panorama::size(path)?;
        let bytes = std::fs::read(path).map_err(|source| Error::read(path, source))?;
        Panorama::decode(&bytes).map_err(|what| Error::invalid(path, what))
    }

    /// Reads the header of a file; a picture of too many pixels is refused.
    pub fn size(path: &Path) -> Result<PanoramaSize, Error> {
        let file = std::fs::metadata(path).map_err(|source| Error::read(path, source))?;
        if !file.is_file() {
            return Err(Error::invalid(path, "not a regular file; give an OpenEXR or Radiance HDR image"));
        }
        let mut start = Vec::new();
        let opened = File::open(path).and_then(|file| file.take(START).read_to_end(&mut start));
        opened.map_err(|source| Error::read(path, source))?;
        let size = if start.starts_with(b"#?") {
            radiance::size(&start, file.len())
        } else {
            outline_of_file(path).map_err(of_open_exr).and_then(|outline| size(&outline, file.len()))
        };
        size.map_err(|what| Error::invalid(path, what))
    }

    fn decode(bytes: &[u8]) -> Result<Panorama, String> {
        if bytes.starts_with(b"#?") {
            return radiance::decode(bytes);
        }
        let length = bytes.len() as u64;
        let outline = outline(std::io::Cursor::new(bytes), bytes, length).map_err(of_open_exr)?;
        size(&outline, length)?;
        from_image(&Image::decode(bytes).map_err(of_open_exr)?, &outline)
    }
}

fn of_open_exr(error: ImageError) -> String {
    match error {
        ImageError::NotOpenExr => "neither an OpenEXR nor a Radiance HDR image; convert it to one".into(),
        error => error.to_string(),
    }
}

/// The size of an OpenEXR picture, whose pixels are not read yet.
fn size(outline: &Outline, length: u64) -> Result<PanoramaSize, String> {
    if outline.is_cube {
        return Err("envmap: it is a cube; convert it to latitude and longitude (`exrenvmap -l`)".into());
    }
    let [width, height] = outline.display.size;
    [outline.data.size, outline.display.size].into_iter().try_for_each(check_size)?;
    let bytes = PIXEL_BYTES.saturating_mul(width as u64).saturating_mul(height as u64);
    // A few bytes could ask for much black.
    if bytes / 3 > max_unpacked(length) {
        return Err(format!(
            "{width} x {height} pixels of display window are more than a file of {length} bytes can hold"
        ));
    }
    Overlap::of(outline)?;
    Ok(PanoramaSize { width, height, reading_bytes: outline.dimensions.reading_bytes.saturating_add(bytes) })
}

fn check_size([width, height]: [usize; 2]) -> Result<(), String> {
    match width.checked_mul(height) {
        Some(1..=MAX_PIXELS) => Ok(()),
        _ => Err(format!("{width} x {height} pixels; scale the picture down to at most {MAX_PIXELS}")),
    }
}

/// So many black pixels, if there is memory for them.
fn black(width: usize, height: usize) -> Result<Vec<[f32; 3]>, String> {
    let room = has_room(PIXEL_BYTES.saturating_mul((width * height) as u64));
    let scarce = || format!("not enough memory for {width} x {height} pixels; scale the picture down");
    room.then(|| vec![[0.0; 3]; width * height]).ok_or_else(scarce)
}

fn from_image(image: &Image, outline: &Outline) -> Result<Panorama, String> {
    let planes = planes(image)?;
    let [width, height] = outline.display.size;
    let mut pixels = black(width, height)?;
    let shown = Overlap::of(outline)?;
    for [from, to] in shown.rows(outline) {
        for (channel, plane) in planes.iter().enumerate() {
            pixels[to.clone()].iter_mut().zip(&plane[from.clone()]).for_each(|(pixel, x)| pixel[channel] = *x);
        }
    }
    let mut picture = Panorama { width, height, pixels, warnings: shown.warnings(outline) };
    if let Some(stated) = outline.chromaticities {
        let matrix = color::to_rec_709(stated.map(f64::from)).map_err(|e| format!("chromaticities: {e}"))?;
        let grey = planes[0].as_ptr() == planes[1].as_ptr();
        if let Some(matrix) = matrix.filter(|_| !grey) {
            color::convert(&mut picture, matrix);
        }
    }
    Ok(picture)
}

/// `R`, `G` and `B`, or `Y` alone, which is all three.
fn planes(image: &Image) -> Result<[&[f32]; 3], String> {
    let has = |name: &str| image.channel(name).is_some();
    if ["X", "Y", "Z"].into_iter().all(has) && !has("R") {
        return Err("channels: X, Y and Z are a color model that is not read; save R, G and B".into());
    }
    let grey = !["R", "G", "B", "RY", "BY"].into_iter().any(has);
    let plane = |name: &str| image.channel(if grey { "Y" } else { name });
    let (Some(r), Some(g), Some(b)) = (plane("R"), plane("G"), plane("B")) else {
        let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        return Err(format!("channels: R, G and B, or Y, are needed; it has {}", names.join(", ")));
    };
    Ok([r, g, b])
}

#[cfg(test)]
mod tests;
