//! The lit samples of one material and half, as the estimators read them from the tiles of the file.

use bssrdf::{
    RoughEntry,
    lanes::{Block, EntryRefraction, LANES, Lane},
    simd,
};
use formats::{
    cloud::{Cloud, Group, Node, Record, TILE, Tile},
    octahedral::integer_directions,
};
use glam::DVec3;

const _: () = assert!(LANES == TILE, "a tile is evaluated as one block");

/// Samples whose light enters one medium.
#[derive(Clone, Debug)]
pub struct LitSamples<'a> {
    pub(crate) tiles: &'a [Tile],
    /// The tree over the tiles, see [`Node`].
    pub(crate) nodes: &'a [Node],
    len: usize,
    entry: EntryRefraction,
    /// The power of two that scales the total flux to about 1. Squares and sums of fluxes then neither overflow nor
    /// vanish in float32, however strong or weak the light is, and a power of two rounds nothing.
    pub(crate) scale: f32,
}

/// The exitant point of a sum.
#[derive(Clone, Copy, Debug)]
pub struct Exit {
    /// `x_o` rounded to float32, m.
    high: [f32; 3],
    /// The remainder of `x_o`, m, with which `x_o − x_i` has the precision of float64.
    low: [f32; 3],
    /// `n_o`.
    pub normal: [f32; 3],
    /// Selects the random numbers of the sum.
    pub key: u64,
    /// Light that leaves there besides the sum, summed over channels, W/(m² sr): errors are relative to both.
    pub besides: f32,
}

impl Exit {
    pub fn new(position: DVec3, normal: DVec3, key: u64) -> Exit {
        let high = position.as_vec3();
        let low = (position - high.as_dvec3()).as_vec3();
        Exit { high: high.to_array(), low: low.to_array(), normal: normal.as_vec3().to_array(), key, besides: 0.0 }
    }

    /// This point where light leaves besides the sum, W/(m² sr); an estimate below 0 is none.
    pub fn besides(self, light: DVec3) -> Exit {
        Exit { besides: light.element_sum().max(0.0) as f32, ..self }
    }

    /// This point with random numbers for one of several shards; the first shard keeps the point's own.
    pub fn of_shard(&self, shard: usize) -> Exit {
        Exit { key: self.key.wrapping_add((shard as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)), ..*self }
    }

    /// `x_o − x_i`, m.
    #[inline(always)]
    pub fn offset(&self, position: [f32; 3]) -> [f32; 3] {
        let mut offset = [0.0; 3];
        for c in 0..3 {
            offset[c] = (self.high[c] - position[c]) + self.low[c];
        }
        offset
    }
}

impl<'a> LitSamples<'a> {
    /// The samples of one group of a cloud; their light enters a medium of relative index `eta`.
    pub fn new(cloud: &'a Cloud, group: &Group, eta: f64) -> LitSamples<'a> {
        let (tiles, nodes) = cloud.group(group);
        LitSamples::of(tiles, nodes, group.samples as usize, eta)
    }

    /// The first `len` samples of the tiles, or all if there are fewer, with the tree over them.
    pub fn of(tiles: &'a [Tile], nodes: &'a [Node], len: usize, eta: f64) -> LitSamples<'a> {
        let scale = nodes.get(1).map_or(1.0, |root| unit_of(root.flux));
        LitSamples { tiles, nodes, len: len.min(tiles.len() * TILE), entry: EntryRefraction::new(eta), scale }
    }

    /// The same samples behind an interface that may be rough.
    pub fn behind(self, rough: Option<&RoughEntry>) -> LitSamples<'a> {
        match rough {
            None => self,
            Some(rough) => LitSamples { entry: self.entry.behind(rough), ..self },
        }
    }

    /// The number of samples, without the fillers of the last tile.
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The number of tiles.
    pub fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// One sample as it is stored.
    pub fn record(&self, index: usize) -> &Record {
        &self.tiles.as_flattened()[index]
    }

    /// The positions of one tile, m.
    #[inline(always)]
    pub fn positions(&self, index: usize) -> [Lane; 3] {
        let tile = &self.tiles[index];
        let mut positions = [[0.0; LANES]; 3];
        for c in 0..3 {
            for i in 0..LANES {
                positions[c][i] = tile[i].position[c];
            }
        }
        positions
    }

    /// The samples of one tile as seen from `exit`, with their flux `T12 Φ`, W.
    #[inline(always)]
    pub fn block(&self, index: usize, exit: &Exit) -> (Block, [Lane; 3]) {
        let mut words = Words::default();
        let tile = &self.tiles[index];
        for i in 0..LANES {
            words.put(i, &tile[i]);
        }
        self.enter(&words, exit)
    }

    /// Any sixteen samples as seen from `exit`, with their flux `T12 Φ`, W.
    #[inline(always)]
    pub fn pick(&self, indices: &[u32; LANES], exit: &Exit) -> (Block, [Lane; 3]) {
        let records = self.tiles.as_flattened();
        let mut words = Words::default();
        for i in 0..LANES {
            words.put(i, &records[indices[i] as usize]);
        }
        self.enter(&words, exit)
    }

    /// Prefetches a sample that will be picked soon.
    #[inline(always)]
    pub fn prefetch(&self, index: u32) {
        simd::prefetch(&self.tiles.as_flattened()[index as usize]);
    }

    #[inline(always)]
    fn enter(&self, words: &Words, exit: &Exit) -> (Block, [Lane; 3]) {
        let [normal, direction] = [&words.normal, &words.direction].map(integer_directions);
        let entered = self.entry.enter(&normal, &direction);
        let (mut offset, mut flux) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for c in 0..3 {
            for i in 0..LANES {
                offset[c][i] = (exit.high[c] - words.position[c][i]) + exit.low[c];
                flux[c][i] = words.flux[c][i] * entered.transmittance[i];
            }
        }
        if let Some(gains) = self.entry.gains(&normal, &direction) {
            flux.iter_mut().flatten().zip(gains.iter().flatten()).for_each(|(flux, gain)| *flux *= gain);
        }
        (Block { offset, normal_in: entered.normal, refracted: entered.refracted }, flux)
    }
}

/// The power of two that scales a number into [1, 2), within the exponents of normal float32 numbers.
fn unit_of(number: f32) -> f32 {
    let exponent = ((number.to_bits() >> 23) & 0xFF) as i32 - 127;
    2f32.powi(-exponent.clamp(-126, 126))
}

/// Sixteen records, component by component.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
struct Words {
    position: [Lane; 3],
    normal: [u32; LANES],
    direction: [u32; LANES],
    flux: [Lane; 3],
}

impl Words {
    #[inline(always)]
    fn put(&mut self, lane: usize, record: &Record) {
        for c in 0..3 {
            self.position[c][lane] = record.position[c];
            self.flux[c][lane] = record.flux[c];
        }
        self.normal[lane] = record.normal;
        self.direction[lane] = record.direction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: an exponent outside those of normal numbers, whose power is infinite or 0.
    #[test]
    fn the_unit_of_any_number_is_a_power_of_two() {
        for number in [1.0, 1.5, 3e-20, 3e20, 1e38] {
            let (unit, bits) = (unit_of(number), unit_of(number).to_bits());
            assert!((1.0..2.0).contains(&(number * unit)) && bits << 9 == 0, "{number}: {unit}");
        }
        for number in [0.0, -1.0, 1e-45, f32::MAX, f32::INFINITY, f32::NAN] {
            assert!(unit_of(number).is_normal() && unit_of(number) > 0.0, "{number}");
        }
    }
}
