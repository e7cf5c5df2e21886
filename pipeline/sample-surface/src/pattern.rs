//! The uniform numbers that samples are made of: well spread over surface and light together, or independent.
//!
//! The samples are two independent halves, even and odd ones: what they differ by tells the error of both.

use crate::choice::{BELOW_ONE, Chosen, TriangleChoice};
use clap::ValueEnum;
use glam::{DVec2, DVec3};
use scene::{
    Mesh,
    random::{Item, Purpose, Stream},
    sequence::Sequence,
    warp,
};
use std::ops::Range;

/// How the samples are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Pattern {
    /// Evenly: along a curve through all triangles, as a lattice on each, and with a scrambled sequence for the light.
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

/// Where one sample lies, and the numbers for its light.
pub struct Place {
    pub triangle: u32,
    /// Barycentric.
    pub weights: [f64; 3],
    /// Samples per area over samples of all, 1/m²: the density that makes the estimate unbiased.
    pub pdf_area: f64,
    pub light: [f64; 3],
}

/// The numbers of all samples of a cloud.
pub struct Numbers {
    pattern: Pattern,
    stream: Stream,
    halves: [Half; 2],
}

/// What the stratified samples of one half have in common.
struct Half {
    light: Sequence,
    /// Of the first points of the pieces.
    starts: Stream,
    /// Samples.
    count: f64,
    /// Where the first one lies in its interval of the curve, in [0, 1).
    shift: f64,
}

/// A piece of a triangle, with the point that was placed last.
struct Piece {
    triangle: u32,
    index: u64,
    /// Corners as weights of the triangle's.
    corners: [DVec3; 3],
    pdf_area: f64,
    /// Number in the half of the piece's first sample.
    first: u64,
    placed: u64,
    point: DVec2,
}

impl Numbers {
    pub fn new(pattern: Pattern, seed: u64, samples: u64) -> Numbers {
        let stream = Stream::new(seed, Purpose::Surface);
        let scrambles = Stream::new(seed, Purpose::Scramble);
        let half = |k: u64, count: u64| {
            let light = Sequence::new(scrambles.item(2 * k), Stream::new(seed, Purpose::Remainder(2 * k)));
            let starts = Stream::new(seed, Purpose::Remainder(2 * k + 1));
            Half { light, starts, count: count as f64, shift: scrambles.item(2 * k + 1).uniform(0) }
        };
        Numbers { pattern, stream, halves: [half(0, samples.div_ceil(2)), half(1, samples / 2)] }
    }

    /// The places of these samples, and the half that each belongs to.
    pub fn places(
        &self,
        mesh: &Mesh,
        choice: &TriangleChoice,
        range: Range<u64>,
    ) -> impl Iterator<Item = (usize, Place)> {
        let mut pieces = [None, None];
        range.map(move |index| {
            let half = (index & 1) as usize;
            let place = match self.pattern {
                Pattern::Independent => independent(choice, self.stream.item(index)),
                Pattern::Stratified => self.halves[half].place(mesh, choice, index >> 1, &mut pieces[half]),
            };
            (half, place)
        })
    }
}

fn independent(choice: &TriangleChoice, random: Item) -> Place {
    let chosen = choice.choose(random.uniform(dimension::TRIANGLE));
    Place {
        triangle: chosen.triangle,
        weights: warp::triangle(dimension::POINT.map(|d| random.uniform(d))),
        pdf_area: chosen.pdf_area,
        light: dimension::LIGHT.map(|d| random.uniform(d)),
    }
}

/// Most samples of a piece: larger triangles are cut.
const PIECE: f64 = 512.0;

/// Steps of the R2 sequence (Roberts 2018): powers of the inverse of the plastic number.
const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_2);

impl Half {
    /// Sample `index` of the half. The samples divide the curve through all triangles evenly; those that fall on one
    /// piece are a lattice with a random start.
    fn place(&self, mesh: &Mesh, choice: &TriangleChoice, index: u64, last: &mut Option<Piece>) -> Place {
        let chosen = choice.choose(((index as f64 + self.shift) / self.count).min(BELOW_ONE));
        let levels = (self.count * chosen.probability / PIECE).max(1.0).log2().ceil();
        let pieces = levels.exp2();
        let own = (chosen.rest * pieces).floor();
        let known = last.take().filter(|p| p.triangle == chosen.triangle && p.index == own as u64 && p.first <= index);
        let mut piece = known.unwrap_or_else(|| self.piece(mesh, &chosen, own, levels));
        let number = index.saturating_sub(piece.first);
        while piece.placed < number {
            piece.step();
        }
        let [a, b, c] = piece.corners;
        let DVec2 { x, y } = piece.point;
        let weights = (a * (1.0 - x - y) + b * x + c * y).max(DVec3::ZERO).to_array();
        let [l0, l1, l2, _] = self.light.point(index as u32);
        let place = Place { triangle: piece.triangle, weights, pdf_area: piece.pdf_area, light: [l0, l1, l2] };
        *last = Some(piece);
        place
    }

    /// A piece with its first point.
    fn piece(&self, mesh: &Mesh, chosen: &Chosen, own: f64, levels: f64) -> Piece {
        let pieces = levels.exp2();
        let number =
            |k: f64| (self.count * (chosen.before + chosen.probability * k / pieces) - self.shift).ceil().max(0.0);
        let (first, end) = (number(own), number(own + 1.0).min(self.count));
        let expected = self.count * chosen.probability / pieces;
        // A piece that has a sample for certain is weighed by how many it has: their number is then no noise.
        let density = if expected >= 1.0 { (end - first).max(1.0) / expected } else { 1.0 };
        // The curve halves the edge from its first to its second corner: the longest, so that pieces stay compact.
        let turn = longest_edge(mesh, chosen.triangle);
        let corners = warp::triangle_piece((own + 0.5) / pieces, levels as u32);
        let corners = corners.map(|w| DVec3::from_array([0, 1, 2].map(|k| w[(k + 3 - turn) % 3])));
        let random = self.starts.item((u64::from(chosen.triangle) << 32) + own as u64);
        let (x, y) = (random.uniform(0), random.uniform(1));
        let point = if x + y < 1.0 { DVec2::new(x, y) } else { DVec2::new(1.0 - x, 1.0 - y) };
        let pdf_area = chosen.pdf_area * density;
        let triangle = chosen.triangle;
        Piece { triangle, index: own as u64, corners, pdf_area, first: first as u64, placed: 0, point }
    }
}

impl Piece {
    /// The next point of the lattice on the parallelogram that lies on the triangle: the map from one such point to the
    /// next keeps the uniform distribution.
    fn step(&mut self) {
        loop {
            self.point = (self.point + STEP).fract();
            if self.point.x + self.point.y < 1.0 {
                break;
            }
        }
        self.placed += 1;
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
