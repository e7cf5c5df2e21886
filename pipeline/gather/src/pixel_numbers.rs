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
    /// The same of the first surface.
    surface: Option<[Ordered; 2]>,
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

/// Numbers at a surface: those that choose a direction towards a light, and those of a direction that is mirrored.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceNumbers {
    pub light: [f64; 2],
    pub mirrored: [f64; 2],
}

/// The first numbers of the walks of three channels.
pub type WalkStarts = [[f64; walks::FIRST]; 3];

/// A sequence in an order of its own, which random bits choose.
struct Ordered {
    sequence: Sequence,
    order: u64,
}

impl Ordered {
    fn halves(stream: Stream, pixel: u64) -> [Ordered; 2] {
        let [even, odd] = halves(stream, pixel);
        let order = |half: u64| stream.item(2 * pixel + half).bits(ORDER);
        [Ordered { sequence: even, order: order(0) }, Ordered { sequence: odd, order: order(1) }]
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
        let Streams { places, lens, walks, surface, .. } = streams;
        let walks_of = |stream: Stream| {
            let of = |half: u64| {
                [0, 1, 2].map(|channel| Sequence::new(stream.item((2 * pixel + half) * 3 + channel), stream))
            };
            [0, 1].map(of)
        };
        let [lens, surface] = [lens, surface].map(|stream| Some(Ordered::halves(stream?, pixel)));
        let places = halves(places, pixel);
        PixelNumbers { places, lens, surface, walks: walks.map(walks_of) }
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

    /// The numbers at the first surface of the path that has many directions.
    pub fn surface(&self, path: u32) -> Option<SurfaceNumbers> {
        let [a, b, c, d] = self.surface.as_ref()?[path as usize % 2].point(path / 2);
        Some(SurfaceNumbers { light: [a, b], mirrored: [c, d] })
    }

    /// The first numbers of the walks that the path begins.
    pub fn walks(&self, path: u32) -> Option<WalkStarts> {
        self.walks.as_ref().map(|by_half| by_half[path as usize % 2].map(|sequence| sequence.point(path / 2)))
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

    /// Of sixteen paths of a half, one chooses a light's direction in each of sixteen squares; so do the next sixteen.
    ///
    /// Seen to catch: numbers by the path instead of its place in the half.
    #[test]
    fn directions_at_the_first_surface_are_spread_over_paths() {
        let stream = Stream::new(1, Purpose::FirstSurface);
        let streams = Streams { places: stream, lens: None, walks: None, near: None, surface: Some(stream) };
        let numbers = PixelNumbers::new(7, streams);
        for (half, block) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let mut squares = [false; 16];
            for k in 0..16 {
                let of_path = numbers.surface(32 * block + 2 * k + half).expect("there is a stream");
                let [x, y] = of_path.light.map(|u| (4.0 * u) as usize);
                squares[4 * y + x] = true;
            }
            assert!(squares.iter().all(|hit| *hit), "half {half}, block {block}: {squares:?}");
        }
    }
}
