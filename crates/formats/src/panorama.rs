//! Environment maps, from OpenEXR or Radiance HDR files; the first bytes tell which.

use crate::{
    Error, Image, ImageError,
    image::decode::{Outline, max_unpacked, outline, outline_of_file},
};
use pixels::{PIXEL_BYTES, black, check_size};
pub use pixels::{Panorama, PanoramaSize};
use std::{fs::File, io::Read, path::Path};
use window::Overlap;

mod color;
mod pixels;
mod radiance;
mod window;

/// Bytes of a file in which the header of an HDR picture ends.
const START: u64 = 1 << 20;

impl Panorama {
    /// Reads a file.
    ///
    /// The display window of an OpenEXR file is the picture: it is black where the data window has no pixels, and
    /// pixels outside it are dropped. Colors with other `chromaticities`, or other `PRIMARIES` of an HDR file, are
    /// converted to Rec. 709 and adapted to its white (Bradford); negative channels of colors outside its gamut become
    /// 0, with a warning. `R`, `G` and `B` beside an alpha channel are taken over black. `whiteLuminance`,
    /// `pixelAspectRatio`, `PIXASPECT` and `VIEW` are ignored. Exposures and color corrections of an HDR file are
    /// undone. Other projections and color models are refused.
    pub fn read(path: &Path) -> Result<Panorama, Error> {
        Panorama::size(path)?;
        let bytes = std::fs::read(path).map_err(|source| Error::read(path, source))?;
        Panorama::decode(&bytes).map_err(|what| Error::invalid(path, what))
    }

    /// Reads the header of a file. A picture with too many pixels is refused.
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

    /// The picture of a file's bytes.
    pub fn decode(bytes: &[u8]) -> Result<Panorama, String> {
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

/// The size of an OpenEXR picture from its header.
fn size(outline: &Outline, length: u64) -> Result<PanoramaSize, String> {
    if outline.is_cube {
        return Err("envmap: the map is a cube; convert it to latitude and longitude (`exrenvmap -l`)".into());
    }
    let [width, height] = outline.display.size;
    [outline.data.size, outline.display.size].into_iter().try_for_each(check_size)?;
    let bytes = PIXEL_BYTES.saturating_mul(width as u64).saturating_mul(height as u64);
    // A short file could state a large black display window.
    if bytes / 3 > max_unpacked(length) {
        return Err(format!(
            "{width} x {height} pixels of display window are more than a file of {length} bytes can hold"
        ));
    }
    Overlap::of(outline)?;
    Ok(PanoramaSize { width, height, reading_bytes: outline.dimensions.reading_bytes.saturating_add(bytes) })
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
        let gray = planes[0].as_ptr() == planes[1].as_ptr();
        if let Some(matrix) = matrix.filter(|_| !gray) {
            color::convert(&mut picture, matrix);
        }
    }
    Ok(picture)
}

/// The planes `R`, `G` and `B`, or `Y` three times.
fn planes(image: &Image) -> Result<[&[f32]; 3], String> {
    let has = |name: &str| image.channel(name).is_some();
    if ["X", "Y", "Z"].into_iter().all(has) && !has("R") {
        return Err("channels: X, Y and Z are a color model that is not supported; save R, G and B".into());
    }
    let gray = !["R", "G", "B", "RY", "BY"].into_iter().any(has);
    let plane = |name: &str| image.channel(if gray { "Y" } else { name });
    let (Some(r), Some(g), Some(b)) = (plane("R"), plane("G"), plane("B")) else {
        let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        return Err(format!("channels: R, G and B, or Y, are needed; the file has {}", names.join(", ")));
    };
    Ok([r, g, b])
}

#[cfg(test)]
mod tests;
