//! The sheet: columns of cells, each of which is a picture with its title below.

use picture::{Picture, font};

/// The space between cells and around them, in pixels.
const GUTTER: usize = 10;
const PAPER: [u8; 3] = [24, 24, 26];
const INK: [[u8; 3]; 2] = [[235, 232, 225], [150, 148, 142]];

pub struct Cell {
    /// The lines of the title, of which the first is the brightest.
    pub title: Vec<String>,
    pub picture: Picture,
}

pub struct Sheet(Picture);

impl Sheet {
    /// Puts the cells into columns of `rows` cells, one column after the other.
    pub fn new(cells: &[Cell], rows: usize, side: usize) -> Sheet {
        let lines = cells.iter().map(|cell| cell.title.len()).max().unwrap_or(0);
        let (step_x, step_y) = (side + GUTTER, side + lines * font::LINE + 2 * GUTTER);
        let (columns, rows) = (cells.len().div_ceil(rows), rows.min(cells.len()));
        let mut sheet = Picture::new(columns * step_x + GUTTER, rows * step_y + GUTTER / 2, PAPER);
        for (k, cell) in cells.iter().enumerate() {
            let (left, top) = (GUTTER + k / rows * step_x, GUTTER + k % rows * step_y);
            let picture = &cell.picture;
            sheet.draw(picture, left + (side - picture.width) / 2, top + (side - picture.height) / 2);
            for (line, text) in cell.title.iter().enumerate() {
                let ink = INK[line.min(1)];
                let below = top + side + GUTTER / 2 + line * font::LINE;
                font::dots(text, side).for_each(|(x, y)| sheet.dot(left + x, below + y, ink));
            }
        }
        Sheet(sheet)
    }

    pub fn encode(&self) -> Result<Vec<u8>, png::EncodingError> {
        self.0.encode(png::Compression::High, &[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sheet has five pictures of one color each in columns of two. Seen to catch: cells along the rows.
    #[test]
    fn cells_go_down_the_columns() {
        let cell = |k: u8| Cell { title: vec!["a".into()], picture: Picture::new(20, 20, [k, 0, 0]) };
        let Sheet(sheet) = Sheet::new(&[1, 2, 3, 4, 5].map(cell), 2, 20);
        assert_eq!((sheet.width, sheet.height), (3 * 30 + 10, 2 * (40 + font::LINE) + 5));
        let at = |x: usize, y: usize| sheet.pixels[y * sheet.width + x];
        let below = 40 + font::LINE;
        assert_eq!([at(15, 15), at(15, 15 + below), at(45, 15)], [[1, 0, 0], [2, 0, 0], [3, 0, 0]]);
        assert_eq!([at(75, 15), at(75, 15 + below)], [[5, 0, 0], PAPER]);
        assert!(sheet.pixels.contains(&INK[0]));
    }
}
