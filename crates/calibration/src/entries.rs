//! Where light enters: the samples of a cloud, each picked in proportion to the light that enters there.

use bssrdf::RoughEntry;
use formats::cloud::{Cloud, TILE, shards};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;
use sums::samples::{Exit, LitSamples};

/// The lit samples of one material in all shards and halves of a cloud, with the sums of `T12 Φ` over its tiles.
pub struct Entries<'a> {
    groups: Vec<LitSamples<'a>>,
    /// For each tile of all groups, its group and its index there.
    tiles: Vec<(u32, u32)>,
    /// For each channel, the sum of `T12 Φ` before each tile and, last, over all, W.
    before: [Vec<f64>; 3],
    /// The sum of `(T12 Φ)²` of all channels, W².
    squares: f64,
    /// The area of all sampled surfaces, m².
    area: f64,
    /// `K`.
    drawn: u64,
}

/// A sample that was picked.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// m.
    pub position: DVec3,
    pub normal: DVec3,
    /// Unit direction towards the light.
    pub towards_light: DVec3,
}

impl<'a> Entries<'a> {
    /// The samples of the sampled material `slot`, whose light enters a medium of relative index `eta` behind an interface
    /// that may be rough.
    pub fn new(clouds: &'a [Cloud], slot: usize, (eta, rough): (f64, Option<&RoughEntry>)) -> Entries<'a> {
        let halves = |cloud: &'a Cloud| {
            cloud.meta().materials[slot].halves.map(|half| LitSamples::new(cloud, &half, eta).behind(rough))
        };
        let groups: Vec<LitSamples> = clouds.iter().flat_map(halves).collect();
        let of = |(g, group): (usize, &LitSamples)| (0..group.tile_count()).map(move |t| (g as u32, t as u32));
        let tiles: Vec<(u32, u32)> = groups.iter().enumerate().flat_map(|pair| of(pair).collect::<Vec<_>>()).collect();
        let sums: Vec<([f64; 3], f64)> = (tiles.par_iter())
            .map(|(g, t)| {
                let (flux, sums) = entering(&groups[*g as usize], *t);
                (sums, flux.iter().flatten().map(|f| f64::from(*f).powi(2)).sum())
            })
            .collect();
        let squares = sums.iter().map(|(_, squares)| squares).sum();
        let before = [0, 1, 2].map(|c| {
            let mut before = vec![0.0];
            sums.iter().for_each(|(tile, _)| before.push(before[before.len() - 1] + tile[c]));
            before
        });
        let area = shards::materials(clouds).iter().map(|m| m.area_m2).sum();
        Entries { groups, tiles, before, squares, area, drawn: shards::drawn(clouds) }
    }

    /// The power that enters in one channel, `(1/K) Σ T12 Φ`, W.
    pub fn power(&self, channel: usize) -> f64 {
        self.before[channel].last().copied().unwrap_or(0.0) / self.drawn.max(1) as f64
    }

    /// About the radiance of a white diffuse surface that faces the light, W/(m² sr); 1 if no light enters. A sample carries
    /// the irradiance times the area, whose mean over the light that a ball in the sun receives is two thirds of the largest.
    pub fn white(&self) -> f64 {
        let all: f64 = self.before.iter().filter_map(|before| before.last()).sum();
        let white = 1.5 * self.squares / (all * self.area * PI);
        if white > 0.0 && white.is_finite() { white } else { 1.0 }
    }

    /// The sample at this share of the power of a channel, with the samples in their spatial order; none if no light
    /// enters.
    pub fn at(&self, channel: usize, share: f64) -> Option<Entry> {
        let before = &self.before[channel];
        let target = share * before.last()?;
        let index = before.partition_point(|sum| *sum <= target).checked_sub(1)?.min(self.tiles.len().checked_sub(1)?);
        let (g, t) = self.tiles[index];
        let (flux, _) = entering(&self.groups[g as usize], t);
        let mut rest = target - before[index];
        let mut picked = None;
        for (lane, flux) in flux[channel].iter().enumerate().filter(|(_, flux)| **flux > 0.0) {
            picked = Some(lane);
            rest -= f64::from(*flux);
            if rest < 0.0 {
                break;
            }
        }
        let record = self.groups[g as usize].record(t as usize * TILE + picked?);
        let sample = record.sample();
        Some(Entry { position: sample.position.as_dvec3(), normal: sample.normal, towards_light: sample.direction })
    }
}

/// `T12 Φ` of the samples of a tile, and the sum of each channel, W.
fn entering(group: &LitSamples, tile: u32) -> ([[f32; TILE]; 3], [f64; 3]) {
    let (_, flux) = group.block(tile as usize, &Exit::new(DVec3::ZERO, DVec3::Z, 0));
    (flux, flux.map(|lanes| lanes.iter().map(|f| f64::from(*f)).sum()))
}
