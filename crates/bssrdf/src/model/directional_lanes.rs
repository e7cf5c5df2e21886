//! The directional dipole on blocks; see [`DirectionalDipole`] for the model.
//!
//! The difference of the real and the virtual source is expanded in the difference of their distances
//! (docs/method.md 9.1 to 9.9): far away the two cancel like (h/r)², and float32 has no digits for that. Where `S`
//! passes through zero the terms cancel in any form, and where `x` is parallel to `n_i` rounding decides the mirror
//! normal. The float64 model evaluates those few values.

mod channel;
mod geometry;

use super::directional_dipole::DirectionalDipole;
use crate::{
    evaluate::{Bssrdf, Separation},
    lanes::block::{Block, LANES, Lane, LaneModel},
    medium::Medium,
};
use channel::Channel;
use geometry::{Projections, SourceGeometry};
use glam::{DVec3, Vec3};

/// The directional dipole of one medium.
#[derive(Clone, Debug)]
pub struct DirectionalLanes {
    channels: [Channel; 3],
    /// `k = C_E/(3C_φ)`.
    k: f32,
    /// The float64 model.
    reference: DirectionalDipole,
}

impl LaneModel for DirectionalLanes {
    fn new(medium: &Medium) -> Self {
        let k = medium.interface.c_e / (3.0 * medium.interface.c_phi);
        let channels = [0, 1, 2].map(|c| Channel::new(&medium.channels[c], &medium.interface, k));
        DirectionalLanes { channels, k: k as f32, reference: DirectionalDipole::new(medium) }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, normal_out: [f32; 3]) -> [Lane; 3] {
        let [red, green, blue] = &self.channels;
        let source = SourceGeometry::new(block, normal_out);
        let squares = [red.squares(&source), green.squares(&source), blue.squares(&source)];
        let projections = Projections::new(block, normal_out, &source, self.k);
        let [r, g, b] = &squares;
        let roots = [red.roots(&source, r), green.roots(&source, g), blue.roots(&source, b)];
        let decays = [red.decay(&roots[0]), green.decay(&roots[1]), blue.decay(&roots[2])];
        let (red, r) = red.values(&projections, r, &roots[0], &decays[0]);
        let (green, g) = green.values(&projections, g, &roots[1], &decays[1]);
        let (blue, b) = blue.values(&projections, b, &roots[2], &decays[2]);
        let mut values = [red, green, blue];
        let mut any = 0;
        for i in 0..LANES {
            any |= r[i] | g[i] | b[i];
        }
        if any != 0 {
            self.restore(block, normal_out, &[r, g, b], &mut values);
        }
        values
    }
}

impl DirectionalLanes {
    /// Replaces values that lost too many digits by those of the float64 model.
    #[cold]
    #[inline(never)]
    fn restore(&self, block: &Block, normal_out: [f32; 3], lost: &[[u32; LANES]; 3], values: &mut [Lane; 3]) {
        for channel in 0..3 {
            for lane in (0..LANES).filter(|lane| lost[channel][*lane] != 0) {
                values[channel][lane] = self.exactly(block, normal_out, channel, lane);
            }
        }
    }

    /// One value by the float64 model; 0, as for `d_r = 0`, where it is too near that pole for float32.
    fn exactly(&self, block: &Block, normal_out: [f32; 3], channel: usize, lane: usize) -> f32 {
        let vector = |v: &[Lane; 3]| DVec3::from_array([0, 1, 2].map(|c| f64::from(v[c][lane])));
        let separation = Separation {
            offset: vector(&block.offset),
            normal_in: vector(&block.normal_in),
            refracted: vector(&block.refracted),
            normal_out: Vec3::from_array(normal_out).as_dvec3(),
        };
        let value = self.reference.bare(channel, &separation) as f32;
        if value < f32::INFINITY { value } else { 0.0 }
    }
}
