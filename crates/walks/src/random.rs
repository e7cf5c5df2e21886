//! The random numbers of one walk: a sequence, since a walk does not know how many it needs.

use glam::DVec3;
use scene::random::{Item, mix, unit};

/// A sequence that starts at random bits of a counter-based stream, so that a walk is the same in any thread. It is
/// SplitMix64 (Steele, Lea and Flood 2014), whose state is a counter.
#[derive(Clone, Debug)]
pub struct Sequence {
    state: u64,
    first: Option<[f64; FIRST]>,
}

/// Numbers that a caller may choose for a walk: its first free path, the cosine and the azimuth of its first
/// scattering, and its second free path. They decide most about its light.
pub const FIRST: usize = 4;

impl Sequence {
    /// The sequence of one item (a walk) of a stream.
    pub fn new(item: Item) -> Sequence {
        Sequence::of_dimension(item, 0)
    }

    /// The sequence that starts at one dimension of an item.
    pub fn of_dimension(item: Item, dimension: u64) -> Sequence {
        Sequence { state: item.bits(dimension), first: None }
    }

    /// The same sequence for a walk whose first numbers are given, such as a well-spread point.
    pub fn beginning_with(self, first: [f64; FIRST]) -> Sequence {
        Sequence { first: Some(first), ..self }
    }

    /// The first numbers, if they are given, once.
    pub(crate) fn take_first(&mut self) -> Option<[f64; FIRST]> {
        self.first.take()
    }

    /// The next uniform number in [0, 1).
    #[inline(always)]
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        unit(mix(self.state))
    }

    /// The next exponential number of mean 1.
    #[inline(always)]
    pub fn exponential(&mut self) -> f64 {
        -(1.0 - self.uniform()).ln()
    }

    /// A uniform point of the unit disc and its squared distance from the center, above 0 (von Neumann's rejection: no
    /// sine and cosine).
    #[inline(always)]
    fn disc(&mut self) -> (f64, f64, f64) {
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = x * x + y * y;
            if square < 1.0 && square > 0.0 {
                return (x, y, square);
            }
        }
    }

    /// A uniform direction (Marsaglia 1972).
    #[inline(always)]
    pub fn direction(&mut self) -> DVec3 {
        let (x, y, square) = self.disc();
        let root = 2.0 * (1.0 - square).sqrt();
        DVec3::new(x * root, y * root, 1.0 - 2.0 * square)
    }

    /// The cosine and the sine of a uniform angle.
    #[inline(always)]
    pub fn angle(&mut self) -> (f64, f64) {
        let (x, y, square) = self.disc();
        let inverse = 1.0 / square.sqrt();
        (x * inverse, y * inverse)
    }
}
