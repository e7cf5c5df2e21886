//! Walks from the samples of a cloud to the cells of the surface that they leave through.

use crate::{
    entries::Entries,
    fit::Counts,
    patches::{Patches, Site},
    views::{self, PerView, REGION_LEVELS, VIEWS},
};
use bssrdf::{Coefficients, Medium};
use rayon::prelude::*;
use scene::{
    NormalKind, Scene,
    random::{Purpose, Stream},
};
use std::ops::Range;
use walks::{Boundary, End, Matter, Roughness, Sequence, Smooth, Solid, observed_walk};

/// What a walk starts from and runs in.
pub struct Walking<'a> {
    pub scene: &'a Scene,
    pub solid: &'a Solid<'a>,
    pub entries: &'a Entries<'a>,
    pub patches: &'a Patches,
    pub eta: f64,
    /// The roughness of the surface, if it has any.
    pub rough: Option<&'a Roughness>,
    pub seed: u64,
    /// Distinguishes the random numbers of materials.
    pub slot: usize,
}

/// The light of one channel that leaves each cell, in weights of walks.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Walks that were begun.
    pub walks: u64,
    /// For each half of the walks, the sum of the weights that leave each cell.
    pub weights: [Vec<f64>; 2],
    /// The same of each region of the surface, by the view that is nearest to the direction of the light.
    pub views: [Vec<PerView>; 2],
    /// The sum of the squared weights, and of the weights times the cosine outside.
    pub squares: f64,
    pub cosines: f64,
    /// Walks that left through a hole of the mesh, or whose sample lies on no triangle.
    pub holes: u64,
    /// Walks that left without a collision, or ended on an opaque surface.
    pub unscattered: u64,
    pub opaque: u64,
}

/// Walks of one task, and tasks whose results are held at once: the memory does not grow with the number of walks.
const CHUNK: u64 = 1024;
const BATCH: u64 = 1024;

/// The items of a stream are numbered by material and channel above this bit, and by walk below it.
const WALK_BITS: u32 = 44;

impl Tally {
    pub fn sum(&self) -> f64 {
        self.weights.iter().flatten().sum()
    }

    fn add(&mut self, chunk: &Chunk) {
        let cells_of_region = self.weights[0].len() >> REGION_LEVELS;
        for (half, left) in chunk.left.iter().enumerate() {
            for (cell, weight, cosine, view) in left {
                self.weights[half][*cell as usize] += weight;
                self.views[half][*cell as usize / cells_of_region][usize::from(*view)] += weight;
                self.squares += weight * weight;
                self.cosines += weight * cosine;
            }
        }
        self.holes += chunk.holes;
        self.unscattered += chunk.unscattered;
        self.opaque += chunk.opaque;
    }

    /// The tally (docs/method.md 16.1) as counts, and the `power` of the model, W, in the same unit; none if nothing
    /// leaves, or the model says so. `entering` is the power that enters, W.
    ///
    /// Weights of walks are not counts: as many counts of one mean weight `Σw²/Σw` have the same sum and variance.
    pub fn counted(&self, entering: f64, power: &[f64]) -> Option<Counted> {
        let sum = self.sum();
        let unit = self.squares / sum;
        // Each half has half of the walks.
        let watts = 2.0 * entering / self.walks as f64 * unit;
        let usable = sum > 0.0 && watts > 0.0 && power.iter().any(|m| *m > 0.0);
        let counted = Counted {
            model: power.iter().map(|m| m / watts).collect(),
            halves: self.weights.each_ref().map(|half| half.iter().map(|w| w / unit).collect()),
            views: self.views.each_ref().map(|half| half.iter().map(|of| of.map(|w| w / unit)).collect()),
        };
        usable.then_some(counted)
    }
}

/// Counts of walks at each cell.
pub struct Counted {
    /// What the model predicts for each half of the walks.
    pub model: Vec<f64>,
    /// What left in each half of the walks.
    pub halves: [Vec<f64>; 2],
    /// The same of each region, towards each view.
    pub views: [Vec<PerView>; 2],
}

impl Counted {
    /// The same at each patch.
    pub fn at_patches(&self, patches: &Patches) -> Counts {
        Counts { model: patches.sums(&self.model), halves: self.halves.each_ref().map(|half| patches.sums(half)) }
    }
}

/// Where a walk left: cell, weight, cosine outside, nearest view.
type Left = (u32, f64, f64, u8);

#[derive(Default)]
struct Chunk {
    left: [Vec<Left>; 2],
    holes: u64,
    unscattered: u64,
    opaque: u64,
}

/// Before any other work is done, one walk in 64 of each channel is tried, and this many at most.
const TRIED: u64 = 4096;

/// A mesh has many holes if so many of the walks that are tried leave through them.
const MANY: u64 = 15;

impl Walking<'_> {
    /// The share of walks that leave through holes, if a few of `walks` show in some channel that it exceeds one in a
    /// thousand. A mesh in which it does not is taken for one in which it does with a chance of one in 13,000 at most.
    pub fn is_open(&self, medium: &Medium, walks: u64) -> Option<f64> {
        let tried = (walks / 64).min(TRIED);
        let holes = |channel: usize| self.tally(channel, &medium.channels[channel], tried, |_| ()).holes;
        (0..3).map(holes).find(|holes| *holes >= MANY).map(|holes| holes as f64 / tried as f64)
    }

    /// Makes `count` walks of one channel.
    pub fn tally(
        &self,
        channel: usize,
        coefficients: &Coefficients,
        count: u64,
        progress: impl Fn(u64) + Sync,
    ) -> Tally {
        let none = || vec![0.0; self.patches.cells()];
        let unseen = || vec![[0.0; VIEWS]; 1 << REGION_LEVELS];
        let (weights, views) = ([none(), none()], [unseen(), unseen()]);
        let mut tally = Tally { walks: count, weights, views, ..Tally::default() };
        let Some(matter) = Matter::new(coefficients, self.eta) else {
            return tally;
        };
        let chunk = |chunk: u64| {
            let walks = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            let done = walks.end - walks.start;
            let result = match self.rough {
                None => self.chunk(channel, (&matter, &Smooth { eta: self.eta }), walks, count),
                Some(rough) => self.chunk(channel, (&matter, &rough.of_walks(self.scene)), walks, count),
            };
            progress(done);
            result
        };
        let chunks = count.div_ceil(CHUNK);
        for batch in 0..chunks.div_ceil(BATCH) {
            let numbers = batch * BATCH..((batch + 1) * BATCH).min(chunks);
            let results: Vec<Chunk> = numbers.into_par_iter().map(chunk).collect();
            results.iter().for_each(|result| tally.add(result));
        }
        tally
    }

    /// Makes some of the walks. They start at samples in proportion to the light that enters there, in the spatial order
    /// of the samples, so that their starts are as well spread as the light.
    fn chunk(
        &self,
        channel: usize,
        (matter, boundary): (&Matter, &impl Boundary),
        walks: Range<u64>,
        count: u64,
    ) -> Chunk {
        let stream = Stream::new(self.seed, Purpose::LightWalk);
        let mut chunk = Chunk::default();
        for index in walks {
            let item = stream.item(((3 * self.slot + channel) as u64) << WALK_BITS | index);
            let mut random = Sequence::new(item);
            let share = (index as f64 + random.uniform()) / count as f64;
            let Some(entry) = self.entries.at(channel, share) else {
                continue;
            };
            let along = [entry.normal, entry.towards_light];
            let Some(start) = self.solid.enter(boundary, entry.position, along, &mut random) else {
                chunk.holes += 1;
                continue;
            };
            match observed_walk(self.solid, matter, boundary, &start, &mut random, &mut ()) {
                End::Scattered(exit) => {
                    let point = self.scene.mesh.point(exit.face, [1.0, 0.0, 0.0], NormalKind::Geometric);
                    let cell = self.patches.cell(&Site { position: exit.position, normal: point.geometric_normal });
                    chunk.left[index as usize % 2].push((
                        cell,
                        exit.weight,
                        exit.cosine,
                        views::nearest(exit.direction) as u8,
                    ));
                }
                End::Unscattered(_) => chunk.unscattered += 1,
                End::Opaque => chunk.opaque += 1,
                End::Hole => chunk.holes += 1,
                End::Absorbed | End::Trapped => {}
            }
        }
        chunk
    }
}
