//! The spatial order of the samples, and the tree that is stored with them.
//!
//! The samples of a group are split recursively across the longest side of their bounding box, at a power of two of
//! tiles, down to single samples. The order, and with it every node, depends on the samples alone and not on threads.

use formats::cloud::{Node, Record, TILE, Tile, first_leaf, node_count, tile};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// The largest number of samples that one task orders.
const ALONE: usize = 1 << 13;

/// A sample's position, and its index in the list of records.
#[derive(Clone, Copy)]
struct OrderedSample {
    position: Vec3,
    index: u32,
}

/// Orders samples into tiles with a tree over them.
pub fn build(records: &[Record]) -> (Vec<Tile>, Vec<Node>) {
    let entry =
        |(index, r): (usize, &Record)| OrderedSample { position: Vec3::from_array(r.position), index: index as u32 };
    let mut entries: Vec<OrderedSample> = records.par_iter().enumerate().map(entry).collect();
    order(&mut entries);
    let collect = |part: &[OrderedSample]| {
        let mut own = [Record::default(); TILE];
        own.iter_mut().zip(part).for_each(|(record, e)| *record = records[e.index as usize]);
        tile(&own[..part.len()])
    };
    let tiles: Vec<Tile> = entries.par_chunks(TILE).map(collect).collect();
    let nodes = nodes(&tiles, records.len());
    (tiles, nodes)
}

fn order(entries: &mut [OrderedSample]) {
    if entries.len() < 2 {
        return;
    }
    let tiles = entries.len().div_ceil(TILE) as u64;
    let left = if tiles > 1 { first_leaf(tiles) as usize / 2 * TILE } else { entries.len() / 2 };
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = entries.iter().fold(start, |(low, high), e| (low.min(e.position), high.max(e.position)));
    let axis = (high - low).max_position();
    entries
        .select_nth_unstable_by(left, |a, b| a.position[axis].total_cmp(&b.position[axis]).then(a.index.cmp(&b.index)));
    let (one, two) = entries.split_at_mut(left);
    if one.len() > ALONE {
        rayon::join(|| order(one), || order(two));
    } else {
        order(one);
        order(two);
    }
}

fn nodes(tiles: &[Tile], samples: usize) -> Vec<Node> {
    let mut nodes = vec![Node::default(); node_count(tiles.len() as u64) as usize];
    let filled = |t: usize| (samples - t * TILE).min(TILE);
    let mut level: Vec<Moments> = tiles.par_iter().enumerate().map(|(t, tile)| Moments::of(tile, filled(t))).collect();
    let mut first = first_leaf(tiles.len() as u64) as usize;
    while first > 0 && !level.is_empty() {
        nodes[first..first + level.len()].par_iter_mut().zip(&level).for_each(|(node, m)| *node = m.node());
        let join = |pair: &[Moments]| pair[1..].iter().fold(pair[0], |one, two| one.with(two));
        level = level.par_chunks(2).map(join).collect();
        first /= 2;
    }
    nodes
}

/// Moments of the samples below a node, in float64.
#[derive(Clone, Copy)]
struct Moments {
    count: f64,
    center: DVec3,
    /// Sum of squared distances from the center, m².
    scatter: f64,
    /// Mean flux, summed over channels, W.
    flux: f64,
    /// Sum of squared deviations of the flux, W².
    flux_scatter: f64,
    /// Sums of unit vectors.
    direction: DVec3,
    normal: DVec3,
    /// The bounding box.
    low: Vec3,
    high: Vec3,
}

impl Moments {
    fn of(tile: &Tile, filled: usize) -> Moments {
        let one = |lane: usize| {
            let s = tile[lane].sample();
            Moments {
                count: 1.0,
                center: s.position.as_dvec3(),
                scatter: 0.0,
                flux: s.flux.as_dvec3().element_sum(),
                flux_scatter: 0.0,
                direction: s.direction,
                normal: s.normal,
                low: s.position,
                high: s.position,
            }
        };
        (1..filled).fold(one(0), |sum, lane| sum.with(&one(lane)))
    }

    /// The moments of both: weighted means, and scatter by the parallel axis theorem.
    fn with(&self, other: &Moments) -> Moments {
        let count = self.count + other.count;
        let share = other.count / count;
        let pair = self.count * share;
        Moments {
            count,
            center: self.center + (other.center - self.center) * share,
            scatter: self.scatter + other.scatter + pair * self.center.distance_squared(other.center),
            flux: self.flux + (other.flux - self.flux) * share,
            flux_scatter: self.flux_scatter + other.flux_scatter + pair * (self.flux - other.flux).powi(2),
            direction: self.direction + other.direction,
            normal: self.normal + other.normal,
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn node(&self) -> Node {
        let center = self.center.as_vec3();
        let max_offset = (self.high - center).max(center - self.low);
        // The mean square deviation of unit vectors with mean m is 1 − |m|².
        let variance = |sum: DVec3| (1.0 - (sum / self.count).length_squared()).max(0.0);
        Node {
            center: center.to_array(),
            spread: (self.scatter / self.count).sqrt() as f32,
            radius: max_offset.length(),
            flux: (self.flux * self.count).min(f64::from(f32::MAX)) as f32,
            flux_deviation: ((self.flux_scatter / self.count).sqrt() / self.flux) as f32,
            direction_deviation: (variance(self.direction) + variance(self.normal)).sqrt() as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use formats::cloud::Sample;

    fn records(count: usize) -> Vec<Record> {
        let point = |k: usize| {
            let spread = |f: f64| ((k as f64 * f).fract() as f32) - 0.5;
            let position = Vec3::new(spread(0.618_034), 2.0 * spread(0.754_878), 0.1 * spread(0.569_840));
            let flux = Vec3::new(1.0, 0.5, 0.25) * (1 + k % 3) as f32;
            Record::new(&Sample { position, normal: DVec3::Z, direction: DVec3::Y, flux })
        };
        (0..count).map(point).collect()
    }

    /// Seen to catch: a wrong child, a lost tile, a radius around the center of the box.
    #[test]
    fn nodes_are_what_their_samples_say() {
        for count in [1, 15, 16, 17, 100, 1000, 4097] {
            let records = records(count);
            let (tiles, nodes) = build(&records);
            assert_eq!((tiles.len(), nodes.len() as u64), (count.div_ceil(16), node_count(tiles.len() as u64)));
            let leaves = first_leaf(tiles.len() as u64) as usize;
            for (id, node) in nodes.iter().enumerate().skip(1) {
                let depth = (leaves.ilog2() - id.ilog2()) as usize;
                let below = (id << depth) - leaves..((id + 1) << depth) - leaves;
                let range = below.start * 16..(below.end * 16).min(count);
                if range.is_empty() {
                    assert_eq!(*node, Node::default());
                    continue;
                }
                let samples: Vec<Sample> = range.map(|k| tiles[k / 16][k % 16].sample()).collect();
                let n = samples.len() as f32;
                let center = samples.iter().map(|s| s.position).sum::<Vec3>() / n;
                let spread = (samples.iter().map(|s| s.position.distance_squared(center)).sum::<f32>() / n).sqrt();
                let flux = samples.iter().map(|s| s.flux.element_sum()).sum::<f32>();
                assert!((Vec3::from_array(node.center) - center).length() < 1e-4);
                assert!((node.spread - spread).abs() < 1e-4 && (node.flux / flux - 1.0).abs() < 1e-4);
                assert!(
                    samples.iter().all(|s| s.position.distance(Vec3::from_array(node.center)) <= node.radius + 1e-6)
                );
                assert!(node.direction_deviation.abs() < 1e-3);
            }
        }
    }

    #[test]
    fn every_sample_is_stored_once() {
        let records = records(777);
        let (tiles, _) = build(&records);
        let mut stored: Vec<Record> = tiles.as_flattened()[..777].to_vec();
        let mut wanted = records;
        let order = |a: &Record, b: &Record| a.partial_cmp(b).expect("numbers");
        stored.sort_by(order);
        wanted.sort_by(order);
        assert_eq!(stored, wanted);
        assert!(tiles.as_flattened()[777..].iter().all(|filler| filler.flux == [0.0; 3]));
    }
}
