//! `note: [roulette]` The note's acceptance by distance: `V(ξ, d) = [ξ < p(d)]`, weight `1/p`;
//! docs/method.md section 7.
//!
//! A pass in float32 over all samples proposes those that may be accepted, with 32 random bits each. Where rounding or
//! the number of bits could decide, the acceptance is decided in float64 and with 64 bits, so that its probability is
//! `p` however small `p` is.

use super::{
    random_bits::random_bits,
    sum::{Accumulator, Sum},
};
use crate::samples::{Exit, LitSamples};
use bssrdf::{
    lanes::{LANES, Lane, LaneModel, exp_negative},
    simd::Kernel,
};

/// How the acceptance probability `p` falls with the distance `d`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// `p = ⅓ Σ_c exp(−σ_tr,c d)`: the weight grows no channel by more than 3 (docs/method.md 7.2).
    Mixture,
    /// `p = exp(−σ̄ d)`, where `σ̄` is the mean of `σ_tr` over the channels: the note's rule.
    Mean,
    /// `p = exp(−d min_c σ_tr,c)`.
    Min,
}

impl Rule {
    /// All rules, the default one first.
    pub const ALL: [Rule; 3] = [Rule::Mixture, Rule::Mean, Rule::Min];

    /// The word that users type.
    pub fn name(self) -> &'static str {
        match self {
            Rule::Mixture => "mixture",
            Rule::Mean => "mean",
            Rule::Min => "min",
        }
    }

    /// The decay rates of `p`; `transport` is `σ_tr` of the three channels, 1/m.
    pub fn rates(self, transport: [f64; 3]) -> Rates {
        let [r, g, b] = transport;
        match self {
            Rule::Mixture => Rates::Three(transport),
            Rule::Mean => Rates::One((r + g + b) / 3.0),
            Rule::Min => Rates::One(r.min(g).min(b)),
        }
    }
}

/// Decay rates of `p(d)`, 1/m: one exponential, or the mean of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rates {
    One(f64),
    Three([f64; 3]),
}

/// `p(d)`: the mean of `N` exponentials.
#[derive(Clone, Copy)]
struct Acceptance<const N: usize> {
    rates: [f64; N],
    rates_f32: [f32; N],
}

impl<const N: usize> Acceptance<N> {
    fn new(rates: [f64; N]) -> Self {
        Acceptance { rates, rates_f32: rates.map(|r| r as f32) }
    }

    /// `p` in float32, with a relative error of 10⁻⁶.
    #[inline(always)]
    fn quick(&self, distance: f32) -> f32 {
        let sum = self.rates_f32.iter().fold(0.0, |sum, rate| sum + exp_negative(-rate * distance));
        sum * (1.0 / N as f32)
    }

    fn exact(&self, distance: f64) -> f64 {
        self.rates.iter().map(|rate| (-rate * distance).exp()).sum::<f64>() / N as f64
    }
}

/// Evaluates the accepted samples.
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

/// Proposals differ from acceptances by at most this share of `p`, ten times the error of float32.
const MARGIN: f32 = 1e-5;
/// The resolution of the first 32 bits of ξ, 2⁻³².
const STEP: f64 = 1.0 / 4_294_967_296.0;

impl<M: LaneModel> Roulette<'_, M> {
    #[inline(always)]
    fn scan<const N: usize>(&self, acceptance: &Acceptance<N>) -> Sum {
        let mut accepted = Accepted::default();
        let mut sum = Accumulator::new();
        for block in 0..self.samples.tiles.len() {
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

    /// Returns `p` and 32 bits of ξ for a block, and a mask of the lanes that may be accepted.
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
            let min_xi = bits[i] as f32 * STEP as f32;
            hits[i] = u32::from(min_xi <= p[i] * (1.0 + MARGIN) + STEP as f32) << i;
        }
        (p, bits, hits.iter().fold(0, |mask, hit| mask | hit))
    }

    /// The weight `1/p` of a proposed sample if it is accepted.
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

    /// Evaluates the accepted samples and clears their list.
    #[inline(always)]
    fn evaluate(&self, accepted: &mut Accepted, sum: &mut Accumulator) {
        if accepted.count == 0 {
            return;
        }
        // Unused lanes repeat a sample with weight 0.
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

/// Accepted samples, collected until they fill a block.
#[derive(Default)]
struct Accepted {
    indices: [u32; LANES],
    weights: Lane,
    count: usize,
    evaluations: u64,
}

impl Accepted {
    /// Adds a sample; true if the block is full then.
    #[inline(always)]
    fn push(&mut self, index: u32, weight: f32) -> bool {
        self.indices[self.count] = index;
        self.weights[self.count] = weight;
        self.count += 1;
        self.count == LANES
    }
}
