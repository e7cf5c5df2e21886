//! The records of a cloud: samples in tiles of sixteen, and the tree over the tiles.

use super::Sample;
use crate::octahedral;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Samples in a tile.
pub const TILE: usize = 16;

/// One stored sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Record {
    /// m, relative to the cloud's origin.
    pub position: [f32; 3],
    /// Octahedral codes: x in the low half, y in the high one.
    pub normal: u32,
    pub direction: u32,
    /// W.
    pub flux: [f32; 3],
}

/// Sixteen samples that lie near each other.
pub type Tile = [Record; TILE];

/// What is known of the samples of a power of two of neighbouring tiles.
///
/// The tree is a heap: node 1 is the root, nodes `2i` and `2i + 1` are the children of `i`; over `T` tiles the leaf of
/// tile `t` is node `2^d + t` with the least `2^d ≥ T`. Node 0 is not used; nodes without tiles are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// Mean position, m.
    pub centre: [f32; 3],
    /// Root mean square distance from the centre, m.
    pub spread: f32,
    /// No sample is farther from the centre, m.
    pub radius: f32,
    /// Sum of the flux over samples and channels, W.
    pub flux: f32,
    /// Standard deviation of the flux relative to its mean.
    pub flux_deviation: f32,
    /// Root mean square deviation of directions and normals from their means.
    pub turn: f32,
}

/// The number of the first leaf over `tiles` tiles.
pub fn first_leaf(tiles: u64) -> u64 {
    tiles.next_power_of_two()
}

/// Nodes stored for `tiles` tiles.
pub fn node_count(tiles: u64) -> u64 {
    if tiles == 0 { 0 } else { first_leaf(tiles) + tiles }
}

impl Record {
    /// A sample as it is stored.
    pub fn new(sample: &Sample) -> Record {
        let code = |v| {
            let [x, y] = octahedral::encode(v);
            u32::from(x as u16) | u32::from(y as u16) << 16
        };
        Record {
            position: sample.position.to_array(),
            normal: code(sample.normal),
            direction: code(sample.direction),
            flux: sample.flux.to_array(),
        }
    }

    /// What was stored.
    pub fn sample(&self) -> Sample {
        let decode = |code: u32| octahedral::decode([code as u16 as i16, (code >> 16) as u16 as i16]);
        Sample {
            position: Vec3::from_array(self.position),
            normal: decode(self.normal),
            direction: decode(self.direction),
            flux: Vec3::from_array(self.flux),
        }
    }
}

/// Up to sixteen samples; what is missing repeats the last one without flux.
pub fn tile(records: &[Record]) -> Tile {
    let filler = records.last().map_or(Record::default(), |last| Record { flux: [0.0; 3], ..*last });
    std::array::from_fn(|lane| records.get(lane).copied().unwrap_or(filler))
}
