//! The random numbers of a pixel's paths that are spread evenly over all of them.

use crate::path_state::WalkStarts;
use near_field::Numbers;
use scene::{random::Stream, sequence::Sequence};

/// The sequences of a pixel. Even and odd paths are independent: each half is spread by sequences of its own.
pub struct PixelNumbers {
    places: [Sequence; 2],
    /// Of each half, the channels' walks.
    walks: Option<[[Sequence; 3]; 2]>,
    /// The first four numbers of the points around exitant points, and the rest.
    near: Option<[[Sequence; 2]; 2]>,
}

/// The sequences of the halves of a pixel.
pub fn halves(stream: Stream, pixel: u64) -> [Sequence; 2] {
    [0, 1].map(|half| Sequence::new(stream.item(2 * pixel + half), stream))
}

impl PixelNumbers {
    /// The numbers of one pixel, with those of walks and of points around exitant points if there are any.
    pub fn new(pixel: u64, places: Stream, walks: Option<Stream>, near: Option<[Stream; 2]>) -> PixelNumbers {
        let walks_of = |stream: Stream| {
            let of = |half: u64| {
                [0, 1, 2].map(|channel| Sequence::new(stream.item((2 * pixel + half) * 3 + channel), stream))
            };
            [0, 1].map(of)
        };
        let near_of = |streams: [Stream; 2]| streams.map(|stream| halves(stream, pixel));
        PixelNumbers { places: halves(places, pixel), walks: walks.map(walks_of), near: near.map(near_of) }
    }

    /// Where the path crosses the pixel, in pixels from its corner.
    pub fn place(&self, path: u32) -> [f64; 2] {
        let [x, y, ..] = self.places[path as usize % 2].point(path / 2);
        [x, y]
    }

    /// The first numbers of the walks that the path begins.
    pub fn walks(&self, path: u32) -> Option<WalkStarts> {
        self.walks.as_ref().map(|by_half| by_half[path as usize % 2].map(|sequence| sequence.point(path / 2)))
    }

    /// The numbers of the points around the path's first exitant point.
    pub fn near(&self, path: u32) -> Option<Numbers> {
        let by_stream = self.near.as_ref()?;
        let [[radius, azimuth, l1, l2], [axis, light, ..]] =
            by_stream.each_ref().map(|by_half| by_half[path as usize % 2].point(path / 2));
        Some([radius, azimuth, axis, light, l1, l2])
    }
}
