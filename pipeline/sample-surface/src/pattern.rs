//! The uniform numbers that samples are made of: well spread over surface and light together, or independent.
//!
//! The samples are two independent halves, even and odd ones, each with a scramble of its own: what they differ by tells
//! the error of both.

use crate::choice::TriangleChoice;
use clap::ValueEnum;
use scene::{
    Mesh,
    random::{Item, Purpose, Stream},
    sequence::Sequence,
    warp,
};

/// How the samples are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Pattern {
    /// Evenly: one scrambled sequence along a curve through all triangles, its other dimensions for the light.
    Stratified,
    /// Independently, as in the note.
    Independent,
}

impl Pattern {
    pub fn name(self) -> &'static str {
        match self {
            Pattern::Stratified => "stratified",
            Pattern::Independent => "independent",
        }
    }
}

/// Dimensions of a sample's independent numbers.
mod dimension {
    pub const TRIANGLE: u64 = 0;
    pub const POINT: [u64; 2] = [1, 2];
    pub const LIGHT: [u64; 3] = [3, 4, 5];
}

/// Pieces that a triangle is cut into for each sample that is expected on it.
const PIECES_PER_SAMPLE: f64 = 8.0;

/// Where one sample lies, and the numbers for its light.
pub struct Place {
    pub triangle: u32,
    /// Barycentric.
    pub weights: [f64; 3],
    /// Density per area, 1/m².
    pub pdf_area: f64,
    pub light: [f64; 3],
}

/// The numbers of all samples of a cloud.
pub struct Numbers {
    pattern: Pattern,
    stream: Stream,
    halves: [Sequence; 2],
    /// Samples of a half.
    samples: f64,
}

impl Numbers {
    pub fn new(pattern: Pattern, seed: u64, samples: u64) -> Numbers {
        let stream = Stream::new(seed, Purpose::Surface);
        let scrambles = Stream::new(seed, Purpose::Scramble);
        // The bits that the sequences leave open are of items that no independent sample uses.
        let half = |k: u64| Sequence::new(scrambles.item(k), Stream::new(seed, Purpose::Remainder(k)));
        Numbers { pattern, stream, halves: [half(0), half(1)], samples: samples as f64 / 2.0 }
    }

    /// The place of sample `index`.
    pub fn place(&self, mesh: &Mesh, choice: &TriangleChoice, index: u64) -> Place {
        let random = self.stream.item(index);
        match self.pattern {
            Pattern::Independent => {
                let chosen = choice.choose(random.uniform(dimension::TRIANGLE));
                let weights = warp::triangle(dimension::POINT.map(|d| random.uniform(d)));
                let light = dimension::LIGHT.map(|d| random.uniform(d));
                Place { triangle: chosen.triangle, weights, pdf_area: chosen.pdf_area, light }
            }
            Pattern::Stratified => self.stratified(mesh, choice, index, random),
        }
    }

    fn stratified(&self, mesh: &Mesh, choice: &TriangleChoice, index: u64, random: Item) -> Place {
        let [along, l0, l1, l2] = self.halves[(index & 1) as usize].point((index >> 1) as u32);
        let chosen = choice.choose(along);
        let pieces = self.samples * chosen.probability * PIECES_PER_SAMPLE;
        let levels = pieces.max(1.0).log2().ceil() as u32;
        let xi = dimension::POINT.map(|d| random.uniform(d));
        let weights = warp::triangle_along_curve(chosen.rest, levels, xi);
        // The curve halves the edge from its first to its second corner: the longest, so that pieces stay compact.
        let first = longest_edge(mesh, chosen.triangle);
        let mut turned = [0.0; 3];
        (0..3).for_each(|k| turned[(first + k) % 3] = weights[k]);
        Place { triangle: chosen.triangle, weights: turned, pdf_area: chosen.pdf_area, light: [l0, l1, l2] }
    }
}

/// The corner that the longest edge of a triangle starts at.
fn longest_edge(mesh: &Mesh, triangle: u32) -> usize {
    let [a, b, c] = mesh.corners(triangle as usize);
    let [ab, bc, ca] = [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()];
    match (ab >= bc && ab >= ca, bc >= ca) {
        (true, _) => 0,
        (false, true) => 1,
        (false, false) => 2,
    }
}
