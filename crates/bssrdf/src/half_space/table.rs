//! The table of the half-space model, interpolated for one albedo and index.

use super::layout::{
    BYTES, COSINE_UNIT, ETAS, HEADER, MATCHED, RECORD, RINGS, RINGS_PER_OCTAVE, STEPS, TERMS, UNIT, eta_coordinate,
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
    /// The mean cosine of the light that leaves.
    pub cosine: f64,
}

impl Corrections {
    /// Interpolates the table; `absorbed` is `1 − α'`.
    pub fn new(absorbed: f64, eta: f64) -> Corrections {
        let steps = weights(&STEPS, absorbed.sqrt());
        let etas = if eta >= 1.0 { MATCHED..ETAS.len() } else { 0..MATCHED + 1 };
        let coordinates: Vec<f64> = ETAS[etas.clone()].iter().map(|eta| eta_coordinate(*eta)).collect();
        let mut sum = [0.0; RECORD];
        for (index, of_index) in weights(&coordinates, eta_coordinate(eta)) {
            for (step, of_step) in &steps {
                let record = (etas.start + index) * STEPS.len() + step;
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += of_index * of_step * number(record * RECORD + k);
                }
            }
        }
        let at = TERMS * RINGS;
        Corrections {
            terms: std::array::from_fn(|t| std::array::from_fn(|r| sum[t * RINGS + r] * UNIT)),
            high: [sum[at] * UNIT, sum[at + 1] * UNIT],
            cosine: sum[at + 2] * COSINE_UNIT,
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
        [0, 1, 2, 3].map(|k| value(&self.terms[k]))
    }
}

/// A number of the file.
fn number(index: usize) -> f64 {
    let at = HEADER + 2 * index;
    f64::from(i16::from_le_bytes([FILE[at], FILE[at + 1]]))
}

/// The places of up to four nodes around `x`, and the weights of their values: a cubic through them.
fn weights(nodes: &[f64], x: f64) -> Vec<(usize, f64)> {
    let next = nodes.partition_point(|node| *node <= x).clamp(2, nodes.len() - 2);
    let near = next - 2..next + 2;
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
