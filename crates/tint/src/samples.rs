//! The samples of a cloud, tinted: copies with another flux.

use crate::{Share, Tint};
use bssrdf::Medium;
use formats::cloud::{Cloud, Group, Node, Record, TILE, Tile, first_leaf};
use glam::DVec3;
use rayon::prelude::*;
use scene::{Hit, Rays, Scene};
use sums::samples::LitSamples;

/// The tinted samples of one material in all shards of a cloud.
pub struct Tinted {
    pub tint: Tint,
    /// The two halves of each shard.
    pub shards: Vec<[Half; 2]>,
    /// Samples that lie on no triangle of the material; they have the mean of the texture.
    pub lost: u64,
    /// The second of two media that the texture blends; the samples above are then those of the first.
    pub blend: Option<Box<Blend>>,
}

/// A second medium below a surface.
pub struct Blend {
    /// Where alpha is 1, where it is 0, and the one that light crosses from one to the other.
    pub first: Medium,
    pub second: Medium,
    pub between: Medium,
    /// The samples of the second.
    pub samples: Tinted,
}

/// The tinted samples of one half, with the tree over them.
pub struct Half {
    tiles: Vec<Tile>,
    nodes: Vec<Node>,
    samples: u64,
}

/// Samples are looked for this far from where they lie, in diagonals of the scene: positions in float32 are off by 1e-7 of
/// it. The second distance is for what the first one missed.
const REACH: [f64; 2] = [1e-6, 1e-4];

impl Tinted {
    /// Tints the samples of the sampled material `slot`.
    pub fn new(scene: &Scene, rays: &Rays, clouds: &[Cloud], slot: usize, tint: Tint) -> Tinted {
        let find = Find { scene, rays, diagonal: scene.mesh.diagonal(), tint: &tint };
        let mut lost = 0;
        let mut half = |cloud: &Cloud, group: &Group, material: u16| {
            let (half, missed) = find.half(cloud.group(group), group.samples, material);
            lost += missed;
            half
        };
        let of_cloud = |cloud: &Cloud| {
            let material = &cloud.meta().materials[slot];
            material.halves.each_ref().map(|group| half(cloud, group, material.index))
        };
        let shards = clouds.iter().map(of_cloud).collect();
        Tinted { tint, shards, lost, blend: None }
    }

    /// The same where the texture's alpha blends two media.
    pub fn blended(
        scene: &Scene,
        rays: &Rays,
        clouds: &[Cloud],
        (slot, tint): (usize, Tint),
        [first, second]: &[Medium; 2],
    ) -> Tinted {
        let own = |share: Share| Tinted::new(scene, rays, clouds, slot, tint.of(share));
        let (first, second, between) = (first.clone(), second.clone(), first.mixed(second, 0.5));
        let blend = Blend { first, second, between, samples: own(Share::Second) };
        Tinted { blend: Some(Box::new(blend)), ..own(Share::First) }
    }

    /// The samples, whose light enters a medium of relative index `eta`.
    pub fn samples(&self, eta: f64) -> Vec<[LitSamples<'_>; 2]> {
        self.shards.iter().map(|halves| halves.each_ref().map(|half| half.lit(eta))).collect()
    }
}

impl Half {
    fn lit(&self, eta: f64) -> LitSamples<'_> {
        LitSamples::of(&self.tiles, &self.nodes, self.samples as usize, eta)
    }
}

/// What samples are found with.
struct Find<'a> {
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    diagonal: f64,
    tint: &'a Tint,
}

impl Find<'_> {
    /// One half, and how many of its samples lie on no triangle.
    fn half(&self, (tiles, nodes): (&[Tile], &[Node]), samples: u64, material: u16) -> (Half, u64) {
        let mut tiles = tiles.to_vec();
        let tinted = |hits: &mut Vec<Hit>, tile: &mut Tile| {
            tile.iter_mut().map(|record| u64::from(!self.tinted(record, material, hits))).sum::<u64>()
        };
        let lost = tiles.par_iter_mut().map_init(Vec::new, tinted).sum();
        let mut nodes = nodes.to_vec();
        renew(&tiles, &mut nodes, samples as usize);
        (Half { tiles, nodes, samples }, lost)
    }

    /// Tints the flux of a record; false if it lies on no triangle.
    fn tinted(&self, record: &mut Record, material: u16, hits: &mut Vec<Hit>) -> bool {
        if record.flux == [0.0; 3] {
            return true;
        }
        let sample = record.sample();
        let hit = self.triangle(sample.position.as_dvec3(), sample.normal, material, hits);
        let entering = match &hit {
            Some(hit) => self.tint.entering(&self.scene.texture_color(hit.triangle, hit.weights)),
            None => DVec3::splat(self.tint.lost()),
        };
        for (flux, entering) in record.flux.iter_mut().zip(entering.to_array()) {
            *flux = (f64::from(*flux) * entering).min(f64::from(f32::MAX)) as f32;
        }
        hit.is_some()
    }

    /// The triangle of the material that is nearest to a point along its normal.
    fn triangle(&self, position: DVec3, normal: DVec3, material: u16, hits: &mut Vec<Hit>) -> Option<Hit> {
        let mesh = &self.scene.mesh;
        for reach in REACH.map(|reach| reach * self.diagonal) {
            self.rays.all_within(position + reach * normal, -normal, 2.0 * reach, hits);
            hits.retain(|hit| mesh.triangles[hit.triangle as usize].material == material);
            let from = |hit: &Hit| (hit.distance - reach).abs();
            let nearest = hits.iter().min_by(|a, b| from(a).total_cmp(&from(b)));
            if let Some(hit) = nearest {
                return Some(*hit);
            }
        }
        None
    }
}

/// Sum and scatter of the flux of samples, over channels.
#[derive(Clone, Copy, Default)]
struct Flux {
    count: f64,
    mean: f64,
    /// Sum of squared deviations.
    scatter: f64,
}

impl Flux {
    fn of(tile: &[Record]) -> Flux {
        let one = |r: &Record| Flux { count: 1.0, mean: r.flux.iter().map(|x| f64::from(*x)).sum(), scatter: 0.0 };
        tile.iter().map(one).fold(Flux::default(), Flux::with)
    }

    fn with(self, other: Flux) -> Flux {
        let count = self.count + other.count;
        if count == 0.0 {
            return self;
        }
        let (share, apart) = (other.count / count, other.mean - self.mean);
        let scatter = self.scatter + other.scatter + self.count * share * apart * apart;
        Flux { count, mean: self.mean + share * apart, scatter }
    }
}

/// Gives the nodes of a tree the flux of their samples; nothing else of them depends on it.
fn renew(tiles: &[Tile], nodes: &mut [Node], samples: usize) {
    let filled = |t: usize| samples.saturating_sub(t * TILE).min(TILE);
    let mut level: Vec<Flux> = tiles.iter().enumerate().map(|(t, tile)| Flux::of(&tile[..filled(t)])).collect();
    let mut first = first_leaf(tiles.len() as u64) as usize;
    while first > 0 && !level.is_empty() {
        for (node, flux) in nodes.iter_mut().skip(first).zip(&level) {
            node.flux = (flux.mean * flux.count).min(f64::from(f32::MAX)) as f32;
            let deviation = (flux.scatter / flux.count.max(1.0)).sqrt();
            node.flux_deviation = if flux.mean > 0.0 { (deviation / flux.mean) as f32 } else { 0.0 };
        }
        level = level.chunks(2).map(|pair| pair.iter().fold(Flux::default(), |sum, f| sum.with(*f))).collect();
        first /= 2;
    }
}
