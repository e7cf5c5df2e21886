//! Areas and means of images that are too large to embed.

/// A rectangle of an image in pixels from its top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rectangle {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

impl Rectangle {
    /// The rectangle around a pixel with sides of at most `2 * radius` pixels, within an image of this size.
    pub fn around(pixel: [usize; 2], radius: usize, size: [usize; 2]) -> Rectangle {
        let start = |i: usize| pixel[i].saturating_sub(radius);
        let length = |i: usize| (pixel[i] + radius).min(size[i]).saturating_sub(start(i));
        Rectangle { x: start(0), y: start(1), width: length(0), height: length(1) }
    }
}

/// The smallest power of two for which the image has at most `limit` blocks of this side in pixels.
pub(super) fn block_for(size: [usize; 2], limit: usize) -> usize {
    let fits = |block: usize| size.iter().try_fold(1, |n: usize, side| n.checked_mul(side.div_ceil(block)));
    (0..usize::BITS).map(|bit| 1 << bit).find(|block| fits(*block).is_some_and(|n| n <= limit)).unwrap_or(1)
}

/// The means over the blocks of a rectangle, row after row. Blocks at the right and bottom end may be smaller. The mean
/// of one pixel has the bits of the pixel; the mean of a block with a value that is not finite is not finite.
pub(super) fn means(samples: &[f32], row: usize, area: Rectangle, block: usize) -> Vec<f32> {
    let at = |x: usize, y: usize| samples[(area.y + y) * row + area.x + x];
    let mut means = Vec::with_capacity(area.width.div_ceil(block) * area.height.div_ceil(block));
    for top in (0..area.height).step_by(block) {
        let bottom = (top + block).min(area.height);
        for left in (0..area.width).step_by(block) {
            let right = (left + block).min(area.width);
            let pixels = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
            let sum: f64 = pixels.map(|(x, y)| f64::from(at(x, y))).sum();
            let count = (right - left) * (bottom - top);
            means.push(if count == 1 { at(left, top) } else { (sum / count as f64) as f32 });
        }
    }
    means
}
