//! The uniform numbers that samples are made of: well spread over surface and light together, or independent.
//!
//! Even and odd samples are two independent halves of a cloud, whose difference estimates the error.

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

/// The point of one sample on the surface, and the numbers for its light.
pub struct SamplePoint {
    pub triangle: u32,
    /// Barycentric weights.
    pub weights: [f64; 3],
    /// Density of the samples over the surface, 1/m².
    pub pdf_area: f64,
    /// Uniform numbers for the light.
    pub light: [f64; 3],
    /// Further uniform numbers, for light that another surface reflects.
    pub bounce: Item,
}

/// The uniform numbers of all samples of a cloud.
pub struct Numbers {
    pattern: Pattern,
    stream: Stream,
    bounces: Stream,
    halves: [Half; 2],
}

/// The parameters that all stratified samples of one half share.
struct Half {
    light: Sequence,
    /// Number of samples.
    count: f64,
    /// Offset of the first sample along the ribbons, as a share of the distance between samples.
    along: f64,
    /// Offset of the first sample across the ribbon, in 2^-64 of the width.
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

    /// The points of these samples, each with the half that it belongs to.
    pub fn points(&self, choice: &TriangleChoice, range: Range<u64>) -> impl Iterator<Item = (usize, SamplePoint)> {
        range.map(move |index| {
            let half = (index & 1) as usize;
            let bounce = self.bounces.item(index);
            let point = match self.pattern {
                Pattern::Independent => independent(choice, self.stream.item(index), bounce),
                Pattern::Stratified => self.halves[half].point(choice, index >> 1, bounce),
            };
            (half, point)
        })
    }
}

fn independent(choice: &TriangleChoice, random: Item, bounce: Item) -> SamplePoint {
    let chosen = choice.choose(random.uniform(dimension::TRIANGLE));
    SamplePoint {
        triangle: chosen.triangle,
        weights: warp::triangle(dimension::POINT.map(|d| random.uniform(d))),
        pdf_area: chosen.pdf_area,
        light: dimension::LIGHT.map(|d| random.uniform(d)),
        bounce,
    }
}

/// The fractional part of the golden ratio, in 2^-64.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

impl Half {
    /// Sample `index` of the half. The samples are equidistant along the ribbons, and each is offset across by the
    /// golden ratio from the one before: a lattice without gaps or clusters, whatever its density and the ribbon's
    /// width.
    fn point(&self, choice: &TriangleChoice, index: u64, bounce: Item) -> SamplePoint {
        let along = ((index as f64 + self.along) / self.count).min(BELOW_ONE);
        let across = unit(self.across.wrapping_add(index.wrapping_mul(GOLDEN)));
        let (chosen, weights) = choice.on_ribbon(along, across);
        let [l0, l1, l2, _] = self.light.point(index as u32);
        SamplePoint { triangle: chosen.triangle, weights, pdf_area: chosen.pdf_area, light: [l0, l1, l2], bounce }
    }
}
