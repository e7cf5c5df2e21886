//! The random numbers of a pixel's paths that are spread evenly over all of them.

use crate::path_state::WalkStarts;
use near_field::Numbers;
use scene::{
    random::Stream,
    sequence::{Sequence, shuffled},
};

/// The dimension of the bits of an order, beyond those that scramble.
const ORDER: u64 = 1 << 16;

/// The streams of an image that the sequences of its pixels are of.
#[derive(Clone, Copy)]
pub struct Streams {
    pub places: Stream,
    pub lens: Option<Stream>,
    pub walks: Option<Stream>,
    /// The first four numbers of the points around exitant points, and the rest.
    pub near: Option<[Stream; 2]>,
}

/// The sequences of a pixel. Even and odd paths are independent: each half is spread by sequences of its own.
pub struct PixelNumbers {
    places: [Sequence; 2],
    /// Of each half, with the bits of its order: the place in the pixel and that on the lens must not go together.
    lens: Option<[(Sequence, u64); 2]>,
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
    /// The numbers of one pixel, with those of the lens, of walks and of points around exitant points if there are any.
    pub fn new(pixel: u64, streams: Streams) -> PixelNumbers {
        let Streams { places, lens, walks, near } = streams;
        let walks_of = |stream: Stream| {
            let of = |half: u64| {
                [0, 1, 2].map(|channel| Sequence::new(stream.item((2 * pixel + half) * 3 + channel), stream))
            };
            [0, 1].map(of)
        };
        let near_of = |streams: [Stream; 2]| streams.map(|stream| halves(stream, pixel));
        let order = |stream: Stream, half: u64| stream.item(2 * pixel + half).bits(ORDER);
        let lens = lens.map(|stream| {
            let [even, odd] = halves(stream, pixel);
            [(even, order(stream, 0)), (odd, order(stream, 1))]
        });
        PixelNumbers { places: halves(places, pixel), lens, walks: walks.map(walks_of), near: near.map(near_of) }
    }

    /// Where the path crosses the pixel, in pixels from its corner.
    pub fn place(&self, path: u32) -> [f64; 2] {
        let [x, y, ..] = self.places[path as usize % 2].point(path / 2);
        [x, y]
    }

    /// The numbers of the point where the path crosses the lens.
    pub fn lens(&self, path: u32) -> Option<[f64; 2]> {
        let (sequence, order) = &self.lens.as_ref()?[path as usize % 2];
        let [x, y, ..] = sequence.point(shuffled(path / 2, *order));
        Some([x, y])
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
