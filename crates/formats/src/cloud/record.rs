//! The records of a cloud: samples in tiles of sixteen, and the nodes of the tree over the tiles.

use crate::octahedral;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

/// Samples in a tile.
pub const TILE: usize = 16;

/// A lit point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// m, relative to the cloud's origin.
    pub position: Vec3,
    /// Unit normal of the irradiance.
    pub normal: DVec3,
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// `Φ = E/pdf_area`, without 1/K, W.
    pub flux: Vec3,
}

/// A sample as it is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Record {
    /// m, relative to the cloud's origin.
    pub position: [f32; 3],
    /// Octahedral code: x in the low half, y in the high one.
    pub normal: u32,
    /// Octahedral code of the direction towards the light.
    pub direction: u32,
    /// W.
    pub flux: [f32; 3],
}

/// Sixteen neighboring samples.
pub type Tile = [Record; TILE];

/// Moments of the samples in 2^k neighboring tiles.
///
/// The tree is a heap: node 1 is the root, and nodes `2i` and `2i + 1` are the children of node `i`. Over `T` tiles,
/// the leaf of tile `t` is node `2^d + t` with the smallest `2^d ≥ T`. Node 0 is unused; nodes without tiles are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// Mean position, m.
    pub center: [f32; 3],
    /// Root mean square distance from the center, m.
    pub spread: f32,
    /// Largest distance of a sample from the center, m.
    pub radius: f32,
    /// Sum of the flux over samples and channels, W.
    pub flux: f32,
    /// Standard deviation of the flux relative to its mean.
    pub flux_deviation: f32,
    /// Root mean square deviation of directions and normals from their means.
    pub direction_deviation: f32,
}

/// Index of the first leaf over `tiles` tiles.
pub fn first_leaf(tiles: u64) -> u64 {
    tiles.next_power_of_two()
}

/// Nodes stored for `tiles` tiles.
pub fn node_count(tiles: u64) -> u64 {
    if tiles == 0 { 0 } else { first_leaf(tiles) + tiles }
}

impl Record {
    /// Encodes a sample.
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

    /// Decodes the sample.
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

/// A tile of up to sixteen samples; copies of the last one without flux fill it.
pub fn tile(records: &[Record]) -> Tile {
    let filler = records.last().map_or(Record::default(), |last| Record { flux: [0.0; 3], ..*last });
    std::array::from_fn(|lane| records.get(lane).copied().unwrap_or(filler))
}
