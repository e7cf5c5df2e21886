//! Parts of an image.

/// A part of an image, pixels: its left column, its upper row, its width and height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

impl Crop {
    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }

    /// Column and row in the whole image of a pixel of the part, whose index counts row by row.
    pub fn pixel(&self, index: usize) -> [usize; 2] {
        [self.x + index % self.width, self.y + index / self.width]
    }
}
