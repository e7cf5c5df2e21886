//! Order along Hilbert's curve: triangles that are close in the order are close in space.

use scene::{DVec3, Mesh};

/// Bits of each coordinate.
const BITS: u32 = 21;

/// Sorts triangles of a mesh along Hilbert's curve through their centroids.
pub fn sort(mesh: &Mesh, triangles: &mut [u32]) {
    let (low, high) = mesh.bounds();
    let size = (high - low).max_element();
    let steps = f64::from((1u32 << BITS) - 1);
    let cell = |p: DVec3| ((p - low) / size * steps).to_array().map(|x| x.clamp(0.0, steps) as u32);
    triangles.sort_by_cached_key(|k| {
        let [a, b, c] = mesh.corners(*k as usize);
        (index(cell((a + b + c) / 3.0)), *k)
    });
}

/// The index on Hilbert's curve of a cell of a grid with 2^21 cells a side (Skilling 2004).
fn index(cell: [u32; 3]) -> u64 {
    let mut x = cell;
    for bit in (1..BITS).rev() {
        let (q, below) = (1 << bit, (1 << bit) - 1);
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= below;
            } else {
                let swap = (x[0] ^ x[i]) & below;
                x[0] ^= swap;
                x[i] ^= swap;
            }
        }
    }
    // Gray code.
    x[1] ^= x[0];
    x[2] ^= x[1];
    let flip = (1..BITS).filter(|bit| x[2] >> bit & 1 == 1).fold(0, |flip, bit| flip ^ ((1 << bit) - 1));
    let x = x.map(|v| v ^ flip);
    (0..BITS).rev().fold(0, |all, bit| x.iter().fold(all, |all, v| all << 1 | u64::from(v >> bit & 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: a missing swap, which leaves jumps.
    #[test]
    fn neighbors_on_the_curve_are_neighbors_in_space() {
        // The curve's first 2^9 cells fill the corner cube of 8 cells a side.
        let mut cells: Vec<[u32; 3]> = (0..512).map(|k| [k & 7, k >> 3 & 7, k >> 6]).collect();
        cells.sort_by_key(|c| index(*c));
        assert!(cells.iter().enumerate().all(|(k, cell)| index(*cell) == k as u64));
        for pair in cells.windows(2) {
            let step: u32 = (0..3).map(|i| pair[0][i].abs_diff(pair[1][i])).sum();
            assert_eq!(step, 1, "{pair:?}");
        }
    }
}
