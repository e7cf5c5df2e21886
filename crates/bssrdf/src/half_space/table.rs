//! The table of the half-space model, interpolated for one medium and channel.

use super::boundary::exit_lobe;
use super::layout::{
    BYTES, COSINE_UNIT, ETAS, HEADER, MATCHED, PROFILES, RECORD, RINGS, RINGS_PER_OCTAVE, STEPS, TERMS, UNIT,
    eta_coordinate, forward,
};

/// The file, which `make half-space-table` writes.
static FILE: &[u8; BYTES] = include_bytes!("table.bin");

/// The corrections of the images for one albedo and index, in powers of two (docs/method.md 15.6).
#[derive(Clone, Debug)]
pub struct Corrections {
    /// The terms at the middles of the rings.
    terms: [[f64; RINGS]; TERMS],
    /// The coefficients of `m³` and `m⁴`.
    pub high: [f64; 2],
}

impl Corrections {
    /// Interpolates the table; `absorbed` is `1 − α'`.
    pub fn new(absorbed: f64, eta: f64) -> Corrections {
        let steps = weights(&STEPS, absorbed.sqrt());
        let etas = weights_of_eta(&ETAS, MATCHED, eta);
        let mut sum = [0.0; RECORD];
        for (index, of_index) in etas {
            for (step, of_step) in &steps {
                let record = index * STEPS.len() + step;
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += of_index * of_step * number(record * RECORD + k);
                }
            }
        }
        let at = TERMS * RINGS;
        Corrections {
            terms: std::array::from_fn(|t| std::array::from_fn(|r| sum[t * RINGS + r] * UNIT)),
            high: [sum[at] * UNIT, sum[at + 1] * UNIT],
        }
    }

    /// The terms at `octave = log₂(r/FIRST)`, by cubic interpolation between the rings; constant beyond the last one.
    pub fn at(&self, octave: f64) -> [f64; TERMS] {
        let place = (octave * RINGS_PER_OCTAVE - 0.5).min((RINGS - 1) as f64);
        let first = (place.floor().max(0.0) as usize).min(RINGS - 2);
        let t = place - first as f64;
        // Catmull and Rom 1974, with the ends continued as straight lines.
        let value = |term: &[f64; RINGS]| {
            let (b, c) = (term[first], term[first + 1]);
            let a = if first > 0 { term[first - 1] } else { 2.0 * b - c };
            let d = if first + 2 < RINGS { term[first + 2] } else { 2.0 * c - b };
            if t < 0.0 {
                return b + t * (c - b);
            }
            b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
        };
        std::array::from_fn(|k| value(&self.terms[k]))
    }
}

/// `b` of the light that leaves in proportion to `T21 (a + b μ)` (docs/method.md 15.8). It is interpolated instead of the
/// mean cosine, of which it is a steep function where little light leaves but along the normal, at small indices.
pub fn lobe_slope(absorbed: f64, eta: f64) -> f64 {
    let steps = weights(&STEPS, absorbed.sqrt());
    let of_index = |(index, weight): (usize, f64)| {
        let number = |(step, weight): &(usize, f64)| weight * number((index * STEPS.len() + step + 1) * RECORD - 1);
        let cosine = steps.iter().map(number).sum::<f64>() * COSINE_UNIT;
        weight * exit_lobe(ETAS[index], cosine)[1]
    };
    weights_of_eta(&ETAS, MATCHED, eta).into_iter().map(of_index).sum()
}

/// The polynomial in `m`, of degree 2, that is `log₂` of the reflectance of Henyey and Greenstein's phase function over
/// that by similarity (docs/method.md 15.11).
pub fn forward_ratio(absorbed: f64, asymmetry: f64, eta: f64) -> [f64; 3] {
    if asymmetry == 0.0 {
        return [0.0; 3];
    }
    let mut values = [0.0; forward::PLACES.len()];
    for (index, of_index) in weights_of_eta(&forward::ETAS, forward::MATCHED, eta) {
        for (g, of_g) in weights_of_asymmetry(asymmetry) {
            for (step, of_step) in weights(&forward::STEPS, absorbed.sqrt()) {
                for (place, value) in values.iter_mut().enumerate() {
                    *value += of_index * of_g * of_step * forward_number(index, g, step, place);
                }
            }
        }
    }
    parabola(&forward::PLACES, &values)
}

/// `log₂` of a ratio; `g` counts 0 as well.
fn forward_number(index: usize, g: usize, step: usize, place: usize) -> f64 {
    if g == forward::ISOTROPIC || step == 0 {
        return 0.0;
    }
    let g = g - usize::from(g > forward::ISOTROPIC);
    let row = (index * forward::ASYMMETRIES.len() + g) * (forward::STEPS.len() - 1) + step - 1;
    number(PROFILES + row * forward::PLACES.len() + place) * UNIT
}

/// The places of asymmetries, 0 included, around one, and their weights.
fn weights_of_asymmetry(asymmetry: f64) -> Vec<(usize, f64)> {
    let mut nodes = forward::ASYMMETRIES.to_vec();
    nodes.insert(forward::ISOTROPIC, 0.0);
    // The coordinate falls as the asymmetry grows.
    let nodes: Vec<f64> = nodes.into_iter().map(|g| -forward::coordinate(g)).collect();
    weights(&nodes, -forward::coordinate(asymmetry))
}

/// The coefficients of the parabola through three points.
pub fn parabola(x: &[f64; 3], y: &[f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for k in 0..3 {
        let (a, b) = (x[(k + 1) % 3], x[(k + 2) % 3]);
        let scale = y[k] / ((x[k] - a) * (x[k] - b));
        sum = [sum[0] + scale * a * b, sum[1] - scale * (a + b), sum[2] + scale];
    }
    sum
}

/// The places of indices on the same side of 1 around `eta`, and their weights.
fn weights_of_eta(etas: &[f64], matched: usize, eta: f64) -> Vec<(usize, f64)> {
    let (first, side) = if eta >= 1.0 { (matched, &etas[matched..]) } else { (0, &etas[..=matched]) };
    let nodes: Vec<f64> = side.iter().map(|eta| eta_coordinate(*eta)).collect();
    weights(&nodes, eta_coordinate(eta)).into_iter().map(|(k, weight)| (first + k, weight)).collect()
}

/// A number of the file.
fn number(index: usize) -> f64 {
    let at = HEADER + 2 * index;
    f64::from(i16::from_le_bytes([FILE[at], FILE[at + 1]]))
}

/// The places of the four nodes around `x`, or of all if there are fewer, and the weights of their values: a polynomial
/// through them.
fn weights(nodes: &[f64], x: f64) -> Vec<(usize, f64)> {
    let count = nodes.len().min(4);
    let first = nodes.partition_point(|node| *node <= x).saturating_sub(2).min(nodes.len() - count);
    let near = first..first + count;
    let weight = |k: usize| near.clone().filter(|j| *j != k).map(|j| (x - nodes[j]) / (nodes[k] - nodes[j])).product();
    near.clone().map(|k| (k, weight(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::half_space::layout::{MAGIC, checksum};

    /// True if the file is what the program wrote that makes it.
    fn is_intact(file: &[u8]) -> bool {
        file.len() == BYTES && file.starts_with(MAGIC) && file[8..HEADER] == checksum(&file[HEADER..]).to_le_bytes()
    }

    /// Seen to catch: a byte of the payload changed; a file of another layout.
    #[test]
    fn the_file_is_intact() {
        assert!(is_intact(FILE));
        for at in [0, 9, HEADER, FILE.len() / 2, FILE.len() - 1] {
            let mut damaged = FILE.to_vec();
            damaged[at] ^= 1;
            assert!(!is_intact(&damaged), "{at}");
        }
        assert!(!is_intact(&FILE[..FILE.len() - 1]));
    }

    #[test]
    fn cubics_are_interpolated_exactly() {
        let nodes = [0.0, 0.05, 0.2, 0.3, 0.7, 1.0];
        let cubic = |x: f64| 1.0 - x + 3.0 * x * x - 2.0 * x * x * x;
        for k in 0..=100 {
            let x = f64::from(k) / 100.0;
            let value: f64 = weights(&nodes, x).into_iter().map(|(k, w)| w * cubic(nodes[k])).sum();
            assert!((value - cubic(x)).abs() < 1e-12, "{x}");
        }
    }
}
