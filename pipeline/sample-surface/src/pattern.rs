//! The uniform numbers that samples are made of: well spread over surface and light together, or independent.
//!
//! The samples are two independent halves, even and odd ones: what they differ by tells the error of both.

use crate::choice::TriangleChoice;
pub use formats::cloud::Pattern;
use scene::{
    random::{BELOW_ONE, Item, Purpose, Stream, unit},
    sequence::Sequence,
    warp,
};
use std::ops::Range;

/// Dimensions of a sample's independent numbers.
mod dimension {
    pub const TRIANGLE: u64 = 0;
    pub const POINT: [u64; 2] = [1, 2];
    pub const LIGHT: [u64; 3] = [3, 4, 5];
}

/// Where one sample lies, and the numbers for its light.
pub struct Place {
    pub triangle: u32,
    /// Barycentric.
    pub weights: [f64; 3],
    /// Samples per area over samples of all, 1/m²: the density that makes the estimate unbiased.
    pub pdf_area: f64,
    pub light: [f64; 3],
    /// More of them, for light by way of another surface.
    pub bounce: Item,
}

/// The numbers of all samples of a cloud.
pub struct Numbers {
    pattern: Pattern,
    stream: Stream,
    bounces: Stream,
    halves: [Half; 2],
}

/// What the stratified samples of one half have in common.
struct Half {
    light: Sequence,
    /// Samples.
    count: f64,
    /// Where the first one lies: in its interval of the ribbons, in [0, 1), and across, in 2^-64.
    along: f64,
    across: u64,
}

impl Numbers {
    pub fn new(pattern: Pattern, seed: u64, samples: u64) -> Numbers {
        let stream = Stream::new(seed, Purpose::Surface);
        let scrambles = Stream::new(seed, Purpose::Scramble);
        let half = |k: u64, count: u64| {
            let light = Sequence::new(scrambles.item(2 * k), Stream::new(seed, Purpose::Remainder(k)));
            let start = scrambles.item(2 * k + 1);
            Half { light, count: count as f64, along: start.uniform(0), across: start.bits(1) }
        };
        let bounces = Stream::new(seed, Purpose::Bounce);
        Numbers { pattern, stream, bounces, halves: [half(0, samples.div_ceil(2)), half(1, samples / 2)] }
    }

    /// The places of these samples, and the half that each belongs to.
    pub fn places(&self, choice: &TriangleChoice, range: Range<u64>) -> impl Iterator<Item = (usize, Place)> {
        range.map(move |index| {
            let half = (index & 1) as usize;
            let bounce = self.bounces.item(index);
            let place = match self.pattern {
                Pattern::Independent => independent(choice, self.stream.item(index), bounce),
                Pattern::Stratified => self.halves[half].place(choice, index >> 1, bounce),
            };
            (half, place)
        })
    }
}

fn independent(choice: &TriangleChoice, random: Item, bounce: Item) -> Place {
    let chosen = choice.choose(random.uniform(dimension::TRIANGLE));
    Place {
        triangle: chosen.triangle,
        weights: warp::triangle(dimension::POINT.map(|d| random.uniform(d))),
        pdf_area: chosen.pdf_area,
        light: dimension::LIGHT.map(|d| random.uniform(d)),
        bounce,
    }
}

/// The golden ratio's fraction, in 2^-64.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

impl Half {
    /// Sample `index` of the half. The samples divide the ribbons evenly along, and go round across by the golden ratio:
    /// a lattice without gaps or clusters, whatever its density and the ribbon's width.
    fn place(&self, choice: &TriangleChoice, index: u64, bounce: Item) -> Place {
        let along = ((index as f64 + self.along) / self.count).min(BELOW_ONE);
        let across = unit(self.across.wrapping_add(index.wrapping_mul(GOLDEN)));
        let (chosen, weights) = choice.on_ribbon(along, across);
        let [l0, l1, l2, _] = self.light.point(index as u32);
        Place { triangle: chosen.triangle, weights, pdf_area: chosen.pdf_area, light: [l0, l1, l2], bounce }
    }
}
