//! The random numbers of a pixel's paths that are spread evenly over all of them.

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
    pub surface: Option<Stream>,
}

/// The sequences of a pixel. Even and odd paths are independent: each half is spread by sequences of its own.
pub struct PixelNumbers {
    places: [Sequence; 2],
    /// Of each half: the place in the pixel and that on the lens must not go together.
    lens: Option<[Ordered; 2]>,
    /// Of each half, the channels' walks.
    walks: Option<[[Sequence; 3]; 2]>,
}

/// The numbers of the points around the first exitant point of a path. Most paths meet none, so they are found when they
/// are used.
#[derive(Clone, Copy, Debug)]
pub struct NearNumbers {
    /// The first four numbers, and the rest.
    streams: [Stream; 2],
    pixel: u64,
    path: u32,
}

/// The numbers at the first surface of a path that has many directions. Most paths of some scenes meet none, so they are
/// found when they are used.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceNumbers {
    stream: Stream,
    pixel: u64,
    path: u32,
}

/// The first numbers of the walks of three channels.
pub type WalkStarts = [[f64; walks::FIRST]; 3];

/// A sequence in an order of its own, which random bits choose.
struct Ordered {
    sequence: Sequence,
    order: u64,
}

impl Ordered {
    fn new(stream: Stream, pixel: u64, index: u32) -> Ordered {
        let order = stream.item(2 * pixel + u64::from(index)).bits(ORDER);
        Ordered { sequence: half(stream, pixel, index), order }
    }

    fn point(&self, index: u32) -> [f64; 4] {
        self.sequence.point(shuffled(index, self.order))
    }
}

/// The sequences of the halves of a pixel.
pub fn halves(stream: Stream, pixel: u64) -> [Sequence; 2] {
    [0, 1].map(|index| half(stream, pixel, index))
}

/// The sequence of one half of a pixel.
fn half(stream: Stream, pixel: u64, half: u32) -> Sequence {
    Sequence::new(stream.item(2 * pixel + u64::from(half)), stream)
}

impl PixelNumbers {
    /// The numbers of one pixel, with those of the lens and of walks if there are any.
    pub fn new(pixel: u64, streams: Streams) -> PixelNumbers {
        let Streams { places, lens, walks, .. } = streams;
        let walks_of = |stream: Stream| {
            let of = |half: u64| {
                [0, 1, 2].map(|channel| Sequence::new(stream.item((2 * pixel + half) * 3 + channel), stream))
            };
            [0, 1].map(of)
        };
        let lens = lens.map(|stream| [0, 1].map(|half| Ordered::new(stream, pixel, half)));
        let places = halves(places, pixel);
        PixelNumbers { places, lens, walks: walks.map(walks_of) }
    }

    /// Where the path crosses the pixel, in pixels from its corner.
    pub fn place(&self, path: u32) -> [f64; 2] {
        let [x, y, ..] = self.places[path as usize % 2].point(path / 2);
        [x, y]
    }

    /// The numbers of the point where the path crosses the lens.
    pub fn lens(&self, path: u32) -> Option<[f64; 2]> {
        let [x, y, ..] = self.lens.as_ref()?[path as usize % 2].point(path / 2);
        Some([x, y])
    }

    /// The first numbers of the walks that the path begins.
    pub fn walks(&self, path: u32) -> Option<WalkStarts> {
        self.walks.as_ref().map(|by_half| by_half[path as usize % 2].map(|sequence| sequence.point(path / 2)))
    }
}

/// Directions towards each light at the first surface of a path that has many. Of one to sixteen, eight have the least error
/// for their time over the scenes of data/ together (docs/method.md 13).
const LIGHT_TRIES: usize = 8;

impl SurfaceNumbers {
    pub fn new(stream: Stream, pixel: u64, path: u32) -> SurfaceNumbers {
        SurfaceNumbers { stream, pixel, path }
    }

    /// The numbers of the path's half.
    fn half(&self) -> Ordered {
        Ordered::new(self.stream, self.pixel, self.path % 2)
    }

    /// Those that choose directions towards lights.
    pub fn lights(&self) -> [[f64; 2]; LIGHT_TRIES] {
        let (half, first) = (self.half(), self.path / 2 * LIGHT_TRIES as u32);
        std::array::from_fn(|k| {
            let [x, y, ..] = half.point(first + k as u32);
            [x, y]
        })
    }

    /// Those of the direction that is mirrored.
    pub fn mirrored(&self) -> [f64; 2] {
        let [.., x, y] = self.half().point(self.path / 2);
        [x, y]
    }
}

impl NearNumbers {
    pub fn new(streams: [Stream; 2], pixel: u64, path: u32) -> NearNumbers {
        NearNumbers { streams, pixel, path }
    }

    pub fn numbers(&self) -> Numbers {
        let of = |stream| half(stream, self.pixel, self.path % 2).point(self.path / 2);
        let [[radius, azimuth, l1, l2], [axis, light, ..]] = self.streams.map(of);
        [radius, azimuth, axis, light, l1, l2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::Purpose;

    /// Of sixteen directions towards a light in a half, which belong to two paths, one is in each of sixteen squares; so
    /// are the next sixteen, and those of sixteen paths that are mirrored.
    ///
    /// Seen to catch: numbers by the path instead of its place in the half; the same directions for each path.
    #[test]
    fn directions_at_the_first_surface_are_spread_over_paths() {
        let numbers = |path| SurfaceNumbers::new(Stream::new(1, Purpose::FirstSurface), 7, path);
        let all_squares = |points: Vec<[f64; 2]>| {
            let mut squares = [false; 16];
            points.iter().map(|p| p.map(|u| (4.0 * u) as usize)).for_each(|[x, y]| squares[4 * y + x] = true);
            squares.iter().all(|hit| *hit)
        };
        for (half, block) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let lights = (0..2).flat_map(|k| numbers(4 * block + 2 * k + half).lights()).collect();
            let mirrored = (0..16).map(|k| numbers(32 * block + 2 * k + half).mirrored()).collect();
            assert!(all_squares(lights) && all_squares(mirrored), "half {half}, block {block}");
        }
    }
}
