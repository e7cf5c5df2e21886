//! The display window of an OpenEXR picture is the whole sphere: pixels of the data window outside it are dropped, and
//! the rest of it is black.

use crate::image::decode::Outline;

/// The part of a data window that lies in the display window.
pub(super) struct Overlap {
    /// First column and row in the data window, and in the display window.
    from: [usize; 2],
    to: [usize; 2],
    /// Columns and rows.
    size: [usize; 2],
}

impl Overlap {
    /// The pixels that both windows share.
    pub fn of(outline: &Outline) -> Result<Overlap, String> {
        let (data, display) = (outline.data, outline.display);
        let mut overlap = Overlap { from: [0; 2], to: [0; 2], size: [0; 2] };
        for k in 0..2 {
            let [a, b] = [data, display].map(|w| i64::from(w.position[k]));
            let end = |start: i64, count: usize| start.saturating_add(count as i64);
            let (first, last) = (a.max(b), end(a, data.size[k]).min(end(b, display.size[k])));
            if first >= last {
                return Err(
                    "its data window lies outside its display window, which leaves no pixel; save it again".into()
                );
            }
            (overlap.from[k], overlap.to[k]) = ((first - a) as usize, (first - b) as usize);
            overlap.size[k] = (last - first) as usize;
        }
        Ok(overlap)
    }

    /// Tells what is cropped and what is black.
    pub fn warnings(&self, outline: &Outline) -> Vec<String> {
        let [data, display] = [outline.data, outline.display].map(|w| w.size);
        let mut list = Vec::new();
        if self.size != display {
            let [shown, all] = [self.size, display].map(|[w, h]| w as f64 * h as f64);
            let [w, h] = display;
            let share = 100.0 * shown / all;
            list.push(format!("its pixels cover {share:.1} % of its display window of {w} x {h}; the rest is black"));
        }
        if self.size != data {
            list.push(format!("its pixels outside the display window of {} x {} are left out", display[0], display[1]));
        }
        list
    }

    /// For each row, the ranges of its pixels in the data window and in the display window.
    pub fn rows(&self, outline: &Outline) -> impl Iterator<Item = [std::ops::Range<usize>; 2]> {
        let Overlap { from, to, size } = *self;
        let [data, display] = [outline.data.size[0], outline.display.size[0]];
        let range = move |[x, y]: [usize; 2], width: usize, row: usize| {
            let start = (y + row) * width + x;
            start..start + size[0]
        };
        (0..size[1]).map(move |row| [range(from, data, row), range(to, display, row)])
    }
}
