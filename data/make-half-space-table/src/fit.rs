//! The terms of the table from walks and exact reflectances (docs/method.md 15.6).

use crate::{
    grid::{ALBEDOS, ANGLES, PLACES, STEPS, cosines},
    linear::{smooth, solve},
    reflectance::Exact,
    single::Single,
    walks::Tally,
};
use bssrdf::half_space::{
    Images, forwardness,
    layout::{self, FIRST, RINGS, RINGS_PER_OCTAVE, TERMS},
};
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

/// The carrier at one distance and angle: for each azimuth its exitance and `w = sin θ12 cos φ`.
struct Carrier([[f64; 3]; AZIMUTHS]);

impl Carrier {
    fn new(images: &Images, cosine: f64, r: f64) -> Carrier {
        let sine = (1.0 - cosine * cosine).sqrt();
        Carrier(std::array::from_fn(|k| {
            let w = sine * (PI * (k as f64 + 0.5) / AZIMUTHS as f64).cos();
            [images.exitance(r * r, r * w, 0.0, cosine), w, forwardness(w * r / r.hypot(FIRST))]
        }))
    }

    /// The means over the azimuth of the exitance and of its product with `w`, with the factor `2^{slope w}`.
    fn means(&self, slope: f64) -> [f64; 2] {
        let mut means = [0.0; 2];
        for [exitance, w, forward] in self.0 {
            let value = exitance * (slope * forward).exp2() / AZIMUTHS as f64;
            means[0] += value;
            means[1] += value * w;
        }
        means
    }

    /// The slope with which the mean of `w` is this.
    fn slope(&self, mean: f64) -> f64 {
        let (mut low, mut high) = (-12.0, 12.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            let [all, first] = self.means(middle);
            if first > mean * all { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    }
}

impl Measured {
    /// Power over `α` in a ring, and its mean of `w`; `albedo` is none for the limit of no scattering.
    fn ring(&self, angle: usize, ring: usize, albedo: Option<usize>) -> [f64; 2] {
        let sine = (1.0 - cosines(self.eta)[angle].powi(2)).sqrt();
        let mut sums = self.single.rings[angle][ring];
        if let Some(k) = albedo {
            let walks = &self.walks.0[angle][ring];
            sums = [sums[0] + walks[0][k], sums[1] + walks[1][k]];
        }
        [sums[0], sine * sums[1] / sums[0]]
    }

    /// The record of one albedo of the grid.
    fn record(&self, albedo: Option<usize>) -> Record {
        let step = albedo.map_or(1.0, |k| STEPS[k]);
        let images = Images::new(step * step, self.eta);
        let cosines = cosines(self.eta);
        let rings: Vec<[[f64; 2]; ANGLES]> =
            (0..RINGS).map(|b| std::array::from_fn(|k| self.ring(k, b, albedo))).collect();
        let carriers: Vec<[Carrier; ANGLES]> =
            (0..RINGS).map(|b| cosines.map(|c| Carrier::new(&images, c, middle(b)))).collect();
        let share = |b: usize| rings[b][2][0] / rings.iter().map(|r| r[2][0]).sum::<f64>();
        let shares: [f64; RINGS] = std::array::from_fn(share);
        let slope = |b: usize| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for k in 0..ANGLES - 1 {
                let w = 1.0 - cosines[k] * cosines[k];
                sum += w * carriers[b][k].slope(rings[b][k][1]);
                weight += w;
            }
            sum / weight
        };
        let slopes = smooth(&std::array::from_fn(slope), &shares);
        let mut terms = [[0.0; RINGS]; TERMS];
        for b in 0..RINGS {
            let logarithm = |k: usize| (rings[b][k][0] / area(b) / carriers[b][k].means(slopes[b])[0]).log2();
            let fitted = quadratic(&std::array::from_fn(logarithm));
            for (term, value) in terms.iter_mut().zip(fitted) {
                term[b] = value;
            }
        }
        for term in &mut terms[..3] {
            *term = smooth(term, &shares);
        }
        terms[3] = slopes;
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
        let measured: Vec<Record> = (0..ALBEDOS).map(|k| self.record(Some(k))).collect();
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
        ratio * Carrier::new(images, cosine, middle(b)).means(terms[3][b])[0]
    };
    // The value at the first ring holds within it; beyond the last one the exitance falls as r⁻³ at least.
    let inner = PI * FIRST * FIRST * value(0);
    let last = middle(RINGS - 1) * (0.5 / RINGS_PER_OCTAVE).exp2();
    let outer: f64 = (0..400)
        .map(|k| {
            let r = last * ((k as f64 + 0.5) / 40.0).exp2();
            let ratio = (terms[0][RINGS - 1] + place * (terms[1][RINGS - 1] + place * terms[2][RINGS - 1])).exp2();
            2.0 * PI * r * r * LN_2 / 40.0 * ratio * Carrier::new(images, cosine, r).means(terms[3][RINGS - 1])[0]
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
