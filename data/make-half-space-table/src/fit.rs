//! The terms of the table from walks and exact reflectances (docs/method.md 15.6).

use crate::{
    grid::{ALBEDOS, ANGLES, PLACES, STEPS, back, cosines},
    linear::{smooth, solve},
    reflectance::Exact,
    single::Single,
    walks::Tally,
};
use bssrdf::half_space::{
    Images, forwardness,
    layout::{self, FIRST, LARGEST_POWER, LARGEST_SQUARE, RINGS, RINGS_PER_OCTAVE, TERMS},
};
use rayon::prelude::*;
use std::f64::consts::{LN_2, PI};

/// The terms at all distances.
pub type Terms = [[f64; RINGS]; TERMS];

/// The numbers of one index and albedo.
pub struct Record {
    pub terms: Terms,
    /// The coefficients of `m³` and `m⁴`, the same at all distances.
    pub high: [f64; 2],
    /// The mean cosine of the light that leaves.
    pub cosine: f64,
}

/// What the walks of one index say.
pub struct Measured {
    pub eta: f64,
    pub walks: Tally,
    pub single: Single,
}

const AZIMUTHS: usize = 48;

/// The middle of a ring.
pub fn middle(ring: usize) -> f64 {
    FIRST * ((ring as f64 + 0.5) / RINGS_PER_OCTAVE).exp2()
}

/// Area of a ring, for functions that are nearly powers of the distance.
fn area(ring: usize) -> f64 {
    2.0 * PI * middle(ring).powi(2) * LN_2 / RINGS_PER_OCTAVE
}

/// The coefficients of the azimuth at one distance, `p` and `q`.
type Azimuth = [f64; 2];

/// The carrier at one distance and angle, for each azimuth.
struct Carrier([Direction; AZIMUTHS]);

/// The carrier in one direction.
struct Direction {
    exitance: f64,
    /// `sin θ12 cos φ`, and 1 if light that leaves here goes [`back`].
    along: f64,
    back: f64,
    /// `W` and `w²`.
    functions: Azimuth,
}

impl Carrier {
    fn new(images: &Images, cosine: f64, r: f64) -> Carrier {
        let sine = (1.0 - cosine * cosine).sqrt();
        Carrier(std::array::from_fn(|k| {
            let azimuth = (PI * (k as f64 + 0.5) / AZIMUTHS as f64).cos();
            let along = sine * azimuth;
            let w = along * r / r.hypot(FIRST);
            let exitance = images.exitance(r * r, r * along, 0.0, cosine);
            Direction { exitance, along, back: back(azimuth), functions: [forwardness(w), w * w] }
        }))
    }

    /// The means over the azimuth of the exitance, of its product with the cosine to the beam and of what goes back.
    fn means(&self, [p, q]: Azimuth) -> [f64; 3] {
        let mut means = [0.0; 3];
        for direction in &self.0 {
            let [forward, square] = direction.functions;
            let value = direction.exitance * (p * forward + q * square).exp2() / AZIMUTHS as f64;
            means[0] += value;
            means[1] += value * direction.along;
            means[2] += value * direction.back;
        }
        means
    }

    /// The `p` with which the mean cosine is this.
    fn slope(&self, mean: f64, q: f64) -> f64 {
        zero([-LARGEST_POWER, LARGEST_POWER], |p| {
            let [all, first, _] = self.means([p, q]);
            mean - first / all
        })
    }
}

/// Where a function falls through zero.
fn zero([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Angles at one distance, but for the one along the normal: what the walks say of the azimuth, and the carriers.
struct Azimuths<'a> {
    /// `sin² θ12`: so much do the angles count.
    weights: [f64; ANGLES - 1],
    /// The mean cosine to the beam, and the share of the light that goes back.
    targets: [[f64; 2]; ANGLES - 1],
    carriers: &'a [Carrier; ANGLES],
}

impl Azimuths<'_> {
    fn mean(&self, of_angle: impl Fn(usize) -> f64) -> f64 {
        let sum: f64 = (0..ANGLES - 1).map(|k| self.weights[k] * of_angle(k)).sum();
        sum / self.weights.iter().sum::<f64>()
    }

    /// The mean `p` of the angles.
    fn slope(&self, q: f64) -> f64 {
        self.mean(|k| self.carriers[k].slope(self.targets[k][0], q))
    }

    /// `q` is such that as much light goes back as it should, with the `p` that belongs to it.
    fn fit(&self) -> Azimuth {
        let q = zero([-LARGEST_SQUARE, LARGEST_SQUARE], |q| {
            let p = self.slope(q);
            self.mean(|k| {
                let [all, _, back] = self.carriers[k].means([p, q]);
                self.targets[k][1] - back / all
            })
        });
        [self.slope(q), q]
    }
}

impl Measured {
    /// Power over `α` in a ring, its mean of `w`, and its share that goes back; `albedo` is none for the limit of no
    /// scattering.
    fn ring(&self, angle: usize, ring: usize, albedo: Option<usize>) -> [f64; 3] {
        let sine = (1.0 - cosines(self.eta)[angle].powi(2)).sqrt();
        let mut sums = self.single.rings[angle][ring];
        if let Some(k) = albedo {
            let walks = &self.walks.0[angle][ring];
            sums = [0, 1, 2].map(|i| sums[i] + walks[i][k]);
        }
        [sums[0], sine * sums[1] / sums[0], sums[2] / sums[0]]
    }

    /// The record of one albedo of the grid.
    fn record(&self, albedo: Option<usize>) -> Record {
        let step = albedo.map_or(1.0, |k| STEPS[k]);
        let images = Images::new(step * step, self.eta);
        let cosines = cosines(self.eta);
        let rings: Vec<[[f64; 3]; ANGLES]> =
            (0..RINGS).map(|b| std::array::from_fn(|k| self.ring(k, b, albedo))).collect();
        let carriers: Vec<[Carrier; ANGLES]> =
            (0..RINGS).map(|b| cosines.map(|c| Carrier::new(&images, c, middle(b)))).collect();
        let share = |b: usize| rings[b][2][0] / rings.iter().map(|r| r[2][0]).sum::<f64>();
        let shares: [f64; RINGS] = std::array::from_fn(share);
        let weights = std::array::from_fn(|k| 1.0 - cosines[k] * cosines[k]);
        let azimuth = |b: usize| {
            let targets = std::array::from_fn(|k| [rings[b][k][1], rings[b][k][2]]);
            Azimuths { weights, targets, carriers: &carriers[b] }.fit()
        };
        let azimuths: [Azimuth; RINGS] = std::array::from_fn(azimuth);
        let [p, q] = [0, 1].map(|i| smooth(&azimuths.map(|azimuth| azimuth[i]), &shares));
        let mut terms = [[0.0; RINGS]; TERMS];
        for b in 0..RINGS {
            let logarithm = |k: usize| (rings[b][k][0] / area(b) / carriers[b][k].means([p[b], q[b]])[0]).log2();
            let fitted = quadratic(&std::array::from_fn(logarithm));
            for (term, value) in terms.iter_mut().zip(fitted) {
                term[b] = value;
            }
        }
        for term in &mut terms[..3] {
            *term = smooth(term, &shares);
        }
        (terms[3], terms[4]) = (p, q);
        let mut record = Record { terms, high: [0.0; 2], cosine: 0.0 };
        self.normalize(&mut record, step, &images);
        record
    }

    /// Makes the reflectances of a record the exact ones.
    fn normalize(&self, record: &mut Record, step: f64, images: &Images) {
        let exact = Exact::new(step * step, self.eta);
        let cosines = cosines(self.eta);
        let error = |k: usize| {
            let value = reflectance(&record.terms, images, cosines[k], PLACES[k]);
            (exact.leaving(cosines[k]).reflectance / value).log2()
        };
        let correction = polynomial(&std::array::from_fn(error));
        for (term, correction) in record.terms.iter_mut().zip(&correction[..3]) {
            term.iter_mut().for_each(|value| *value += correction);
        }
        record.high = [correction[3], correction[4]];
        record.cosine = exact.leaving(cosines[2]).cosine;
    }

    /// The records of all albedos of the table.
    pub fn records(&self) -> Vec<Record> {
        let measured: Vec<Record> = (0..ALBEDOS).into_par_iter().map(|k| self.record(Some(k))).collect();
        let mut records = vec![self.without_absorption(&measured)];
        records.extend(measured.into_iter().skip(1));
        records.push(self.record(None));
        assert_eq!(records.len(), layout::STEPS.len());
        records
    }

    /// `α' = 1`, where walks do not end: the parabola through `s` = 0.025, 0.05, 0.1.
    fn without_absorption(&self, measured: &[Record]) -> Record {
        const NODES: [(usize, f64); 3] = [(0, 8.0 / 3.0), (1, -2.0), (3, 1.0 / 3.0)];
        let mut terms = [[0.0; RINGS]; TERMS];
        for (k, weight) in NODES {
            for (sum, term) in terms.iter_mut().flatten().zip(measured[k].terms.iter().flatten()) {
                *sum += weight * term;
            }
        }
        let mut record = Record { terms, high: [0.0; 2], cosine: 0.0 };
        self.normalize(&mut record, 0.0, &Images::new(0.0, self.eta));
        record
    }
}

/// The reflectance over `α` of these terms.
fn reflectance(terms: &Terms, images: &Images, cosine: f64, place: f64) -> f64 {
    let value = |b: usize| {
        let ratio = (terms[0][b] + place * (terms[1][b] + place * terms[2][b])).exp2();
        ratio * Carrier::new(images, cosine, middle(b)).means([terms[3][b], terms[4][b]])[0]
    };
    // The value at the first ring holds within it; beyond the last one the exitance falls as r⁻³ at least.
    let inner = PI * FIRST * FIRST * value(0);
    let last = middle(RINGS - 1) * (0.5 / RINGS_PER_OCTAVE).exp2();
    let outer: f64 = (0..400)
        .map(|k| {
            let r = last * ((k as f64 + 0.5) / 40.0).exp2();
            let ratio = (terms[0][RINGS - 1] + place * (terms[1][RINGS - 1] + place * terms[2][RINGS - 1])).exp2();
            2.0 * PI * r * r * LN_2 / 40.0
                * ratio
                * Carrier::new(images, cosine, r).means([terms[3][RINGS - 1], terms[4][RINGS - 1]])[0]
        })
        .sum();
    inner + (0..RINGS).map(|b| area(b) * value(b)).sum::<f64>() + outer
}

/// The parabola in `m` next to the values at the angles.
fn quadratic(values: &[f64; ANGLES]) -> [f64; 3] {
    least_squares(values)
}

/// The polynomial in `m` with the values at the angles.
fn polynomial(values: &[f64; ANGLES]) -> [f64; ANGLES] {
    least_squares(values)
}

fn least_squares<const N: usize>(values: &[f64; ANGLES]) -> [f64; N] {
    let mut matrix = [[0.0; N]; N];
    let mut right = [0.0; N];
    for k in 0..ANGLES {
        for i in 0..N {
            for j in 0..N {
                matrix[i][j] += PLACES[k].powi((i + j) as i32);
            }
            right[i] += PLACES[k].powi(i as i32) * values[k];
        }
    }
    solve(matrix, right)
}
