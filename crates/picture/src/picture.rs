//! Pictures of eight-bit sRGB.

use color::srgb;
use std::{
    fs::File,
    io::BufReader,
    ops::Range,
    path::{Path, PathBuf},
};

/// A picture that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The system cannot read the file.
    #[error("{}: cannot read: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// The file has another format or is damaged.
    #[error("{}: not a readable PNG picture: {source}", path.display())]
    Decode { path: PathBuf, source: png::DecodingError },
    /// The picture is gray, has alpha, or has another depth.
    #[error("{}: not red, green and blue of 8 bits", .0.display())]
    Kind(PathBuf),
}

/// Rows of pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rows from top to bottom.
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture of one color.
    pub fn new(width: usize, height: usize, color: [u8; 3]) -> Picture {
        Picture { width, height, pixels: vec![color; width * height] }
    }

    /// Reads a PNG file. The limit of the decoder bounds its memory.
    pub fn read(path: &Path) -> Result<Picture, PictureError> {
        let file = File::open(path).map_err(|source| PictureError::Read { path: path.into(), source })?;
        let fail = |source| PictureError::Decode { path: path.into(), source };
        let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(fail)?;
        let info = reader.info();
        let (width, height) = (info.width as usize, info.height as usize);
        let size = reader.output_buffer_size().filter(|n| *n == 3 * width * height);
        let wanted = (info.color_type, info.bit_depth) == (png::ColorType::Rgb, png::BitDepth::Eight);
        let size = size.filter(|_| wanted).ok_or_else(|| PictureError::Kind(path.into()))?;
        let mut bytes = vec![0; size];
        reader.next_frame(&mut bytes).map_err(fail)?;
        let pixels = bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
        Ok(Picture { width, height, pixels })
    }

    /// The picture scaled to fit a square of `side` pixels. Each pixel has the mean light of those that it replaces.
    pub fn fit(&self, side: usize) -> Picture {
        let longest = self.width.max(self.height);
        let scaled = |n: usize| (n * side / longest).max(1);
        let (width, height) = (scaled(self.width), scaled(self.height));
        let pixel = |x: usize, y: usize| {
            let columns = x * self.width / width..((x + 1) * self.width).div_ceil(width);
            let rows = y * self.height / height..((y + 1) * self.height).div_ceil(height);
            let count = (columns.len() * rows.len()) as f64;
            let inside = rows.flat_map(|row| columns.clone().map(move |column| row * self.width + column));
            let mut sum = [0.0; 3];
            inside.for_each(|k| (0..3).for_each(|c| sum[c] += srgb::decode_byte(self.pixels[k][c])));
            sum.map(|s| srgb::encode_byte(s / count))
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        Picture { width, height, pixels }
    }

    /// Draws `other` with its upper left corner at (`left`, `top`), clipped to this picture.
    pub fn draw(&mut self, other: &Picture, left: usize, top: usize) {
        for (k, color) in other.pixels.iter().enumerate() {
            self.dot(left + k % other.width, top + k / other.width, *color);
        }
    }

    /// Sets one pixel, if it lies in the picture.
    pub fn dot(&mut self, x: usize, y: usize, color: [u8; 3]) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = color;
        }
    }

    /// Fills a rectangle, clipped to the picture.
    pub fn fill(&mut self, columns: Range<usize>, rows: Range<usize>, color: [u8; 3]) {
        let columns = columns.start.min(self.width)..columns.end.min(self.width);
        for row in rows.start.min(self.height)..rows.end.min(self.height) {
            self.pixels[row * self.width..][columns.clone()].fill(color);
        }
    }

    /// The picture as a PNG file, with texts in Latin-1 by their keywords.
    pub fn encode(&self, pack: png::Compression, texts: &[(&str, &str)]) -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(pack);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        for (keyword, text) in texts {
            encoder.add_text_chunk((*keyword).to_owned(), (*text).to_owned())?;
        }
        encoder.write_header()?.write_image_data(self.pixels.as_flattened())?;
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half the light of white is 188 in sRGB, not 128.
    ///
    /// Seen to catch: a mean of the bytes.
    #[test]
    fn black_and_white_become_the_gray_of_half_the_light() {
        let pixels = vec![[0; 3], [255; 3], [255; 3], [0; 3]];
        let small = Picture { width: 2, height: 2, pixels }.fit(1);
        assert_eq!(small, Picture::new(1, 1, [188; 3]));
    }

    /// Seen to catch: rows and columns exchanged, no end at the border.
    #[test]
    fn a_rectangle_ends_at_the_border() {
        let mut picture = Picture::new(3, 2, [0; 3]);
        picture.fill(1..9, 1..5, [7; 3]);
        let set: Vec<bool> = picture.pixels.iter().map(|pixel| *pixel == [7; 3]).collect();
        assert_eq!(set, [false, false, false, false, true, true]);
    }

    #[test]
    fn a_wide_picture_keeps_its_shape_and_a_small_one_grows() {
        let wide = Picture::new(300, 100, [7, 8, 9]).fit(60);
        assert_eq!(wide, Picture::new(60, 20, [7, 8, 9]));
        assert_eq!(Picture::new(2, 2, [7, 8, 9]).fit(5), Picture::new(5, 5, [7, 8, 9]));
    }
}
