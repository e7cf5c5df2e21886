//! note: [roulette] The note's acceptance by distance: `V(ξ, d) = [ξ < p(d)]`, weight `1/p`; method.md section 7.
//!
//! The acceptance is decided with 64 random bits where 32 do not settle it, so that its probability is `p` however
//! small `p` is. The float32 pass over all samples only proposes; what lies within its rounding is decided in float64.

use super::{Accumulator, Sum};
use crate::samples::{Exit, LitSamples};
use bssrdf::{
    lanes::{LANES, Lane, LaneModel, exp_negative},
    simd::Kernel,
};

/// What `p` is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// `p = ⅓ Σ_c exp(−σ_tr,c d)`: no weighted channel grows by more than 3 (7.2).
    Mixture,
    /// `p = exp(−σ̄ d)` with the mean of `σ_tr` over the channels: the note's.
    Mean,
    /// `p = exp(−d min_c σ_tr,c)`.
    Min,
}

impl Rule {
    pub fn name(self) -> &'static str {
        match self {
            Rule::Mixture => "mixture",
            Rule::Mean => "mean",
            Rule::Min => "min",
        }
    }

    /// Decay rates of the rule's terms, 1/m: one term, or three of equal weight. `transport` is `σ_tr` per channel.
    pub fn rates(self, transport: [f64; 3]) -> Rates {
        let [r, g, b] = transport;
        match self {
            Rule::Mixture => Rates::Three(transport),
            Rule::Mean => Rates::One((r + g + b) / 3.0),
            Rule::Min => Rates::One(r.min(g).min(b)),
        }
    }
}

/// Decay rates of `p(d)`, 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rates {
    One(f64),
    Three([f64; 3]),
}

/// `p(d)` from its decay rates, each of the `N` terms with weight 1/N.
#[derive(Clone, Copy)]
struct Acceptance<const N: usize> {
    rates: [f64; N],
    rates_f32: [f32; N],
}

impl<const N: usize> Acceptance<N> {
    fn new(rates: [f64; N]) -> Self {
        Acceptance { rates, rates_f32: rates.map(|r| r as f32) }
    }

    #[inline(always)]
    fn quick(&self, distance: f32) -> f32 {
        let sum = self.rates_f32.iter().fold(0.0, |sum, rate| sum + exp_negative(-rate * distance));
        sum * (1.0 / N as f32)
    }

    fn exact(&self, distance: f64) -> f64 {
        self.rates.iter().map(|rate| (-rate * distance).exp()).sum::<f64>() / N as f64
    }
}

/// Evaluates the samples that the roulette accepts.
pub struct Roulette<'a, M> {
    pub model: &'a M,
    pub samples: &'a LitSamples<'a>,
    pub exit: &'a Exit,
    pub rates: Rates,
}

impl<M: LaneModel> Kernel for Roulette<'_, M> {
    type Output = Sum;

    #[inline(always)]
    fn run(self) -> Sum {
        match self.rates {
            Rates::One(rate) => self.scan(&Acceptance::new([rate])),
            Rates::Three(rates) => self.scan(&Acceptance::new(rates)),
        }
    }
}

/// Relative and absolute room for rounding in the float32 proposal: `p` is good to 10⁻⁶ there, and 32 bits of ξ to
/// 2⁻³².
const MARGIN: f32 = 1e-5;
const STEP: f64 = 1.0 / 4_294_967_296.0;

impl<M: LaneModel> Roulette<'_, M> {
    #[inline(always)]
    fn scan<const N: usize>(&self, acceptance: &Acceptance<N>) -> Sum {
        let mut accepted = Accepted::default();
        let mut sum = Accumulator::new();
        for block in 0..self.samples.tiles().len() {
            let positions = self.samples.positions(block);
            let (p, bits, mut proposed) = self.propose(acceptance, block, &positions);
            while proposed != 0 {
                let lane = proposed.trailing_zeros() as usize;
                proposed &= proposed - 1;
                let index = (block * LANES + lane) as u32;
                if index as usize >= self.samples.len() {
                    break; // a filler
                }
                let position = [0, 1, 2].map(|c| positions[c][lane]);
                if let Some(weight) = self.decide(acceptance, index, position, p[lane], bits[lane])
                    && accepted.push(index, weight)
                {
                    self.evaluate(&mut accepted, &mut sum);
                }
            }
        }
        self.evaluate(&mut accepted, &mut sum);
        Sum { radiance: sum.total(), evaluations: accepted.evaluations, nodes: 0, predicted: 0.0 }
    }

    /// `p` and 32 bits of ξ for a block, and a bit for each lane that may be accepted.
    #[inline(always)]
    fn propose<const N: usize>(
        &self,
        acceptance: &Acceptance<N>,
        block: usize,
        positions: &[Lane; 3],
    ) -> (Lane, [u32; LANES], u32) {
        let (mut p, mut bits, mut hits) = ([0.0; LANES], [0; LANES], [0u32; LANES]);
        for i in 0..LANES {
            let [x, y, z] = self.exit.offset([positions[0][i], positions[1][i], positions[2][i]]);
            p[i] = acceptance.quick((x * x + y * y + z * z).sqrt());
            bits[i] = random_bits((block * LANES + i) as u32, self.exit.key);
            let least = bits[i] as f32 * STEP as f32;
            hits[i] = u32::from(least <= p[i] * (1.0 + MARGIN) + STEP as f32) << i;
        }
        (p, bits, hits.iter().fold(0, |mask, hit| mask | hit))
    }

    /// The weight 1/p of a proposed sample, if it is accepted.
    #[inline(always)]
    fn decide<const N: usize>(
        &self,
        acceptance: &Acceptance<N>,
        index: u32,
        position: [f32; 3],
        p: f32,
        bits: u32,
    ) -> Option<f32> {
        if (f64::from(bits) + 1.0) * STEP <= f64::from(p * (1.0 - MARGIN)) {
            return Some(1.0 / p);
        }
        let offset = self.exit.offset(position).map(f64::from);
        let exact = acceptance.exact(offset.iter().map(|x| x * x).sum::<f64>().sqrt());
        let more = random_bits(index ^ 0x5555_5555, self.exit.key.rotate_left(17));
        let xi = (f64::from(bits) + (f64::from(more) + 0.5) * STEP) * STEP;
        (xi < exact).then(|| (1.0 / exact) as f32)
    }

    /// Evaluates and forgets the accepted samples.
    #[inline(always)]
    fn evaluate(&self, accepted: &mut Accepted, sum: &mut Accumulator) {
        if accepted.count == 0 {
            return;
        }
        // Lanes left free repeat a sample with weight 0.
        for i in accepted.count..LANES {
            accepted.indices[i] = accepted.indices[0];
            accepted.weights[i] = 0.0;
        }
        let (block, flux) = self.samples.pick(&accepted.indices, self.exit);
        sum.add(&self.model.bare(&block, self.exit.normal), &flux, &accepted.weights);
        accepted.evaluations += accepted.count as u64;
        accepted.count = 0;
    }
}

/// Accepted samples that wait until there are enough for a block.
#[derive(Default)]
struct Accepted {
    indices: [u32; LANES],
    weights: Lane,
    count: usize,
    evaluations: u64,
}

impl Accepted {
    /// True if the block is full.
    #[inline(always)]
    fn push(&mut self, index: u32, weight: f32) -> bool {
        self.indices[self.count] = index;
        self.weights[self.count] = weight;
        self.count += 1;
        self.count == LANES
    }
}

/// 32 random bits for one sample in one gather: multiply and xor-shift rounds (constants of Wellons' search for
/// low-bias 32-bit mixers), keyed before each.
#[inline(always)]
pub fn random_bits(index: u32, key: u64) -> u32 {
    let mut x = index ^ key as u32;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x = (x ^ (x >> 16)).wrapping_add((key >> 32) as u32);
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}
