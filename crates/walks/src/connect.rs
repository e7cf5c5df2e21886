//! Connects the collisions of a walk from the camera to delta lights.

use crate::{
    beams::{Arrival, Beams},
    boundary::Meeting,
    matter::Matter,
    phase::density,
    random::Sequence,
    solid::Solid,
    walk::{Collision, Observer},
};
use glam::DVec3;
use std::f64::consts::PI;

/// Connections of less than this share of the light's typical contribution are made with a probability in proportion
/// to it, and count as much more. In a sphere of skim milk the product of variance and time is least here.
const ROULETTE: f64 = 0.6;

/// So is the search for connections, where the clearance bounds their share to less than this.
const SEARCH: f64 = 1.5;

/// Collects the light of one channel that a walk from the camera meets.
pub struct Connections<'a> {
    solid: &'a Solid<'a>,
    beams: &'a [Beams<'a>],
    matter: &'a Matter,
    channel: usize,
    /// Radiance inside, W/(m² sr).
    pub radiance: f64,
    /// Connections that were made, the blocked ones included.
    pub count: u64,
    pub collisions: u64,
}

impl Observer for Connections<'_> {
    const SEES_JUMPS: bool = true;

    #[inline(always)]
    fn collide(&mut self, collision: &Collision, random: &mut Sequence) {
        self.collisions += 1;
        let reached = (-self.matter.extinction * collision.clearance).exp();
        let bound = collision.weight * reached / SEARCH;
        if bound < 1.0 && random.uniform() >= bound {
            return;
        }
        let collision = Collision { weight: collision.weight / bound.min(1.0), ..*collision };
        let (mesh, all) = (self.solid.mesh(), self.beams);
        for beams in all {
            let typical = ROULETTE * beams.typical[self.channel] / (4.0 * PI);
            beams.each_at(mesh, collision.position, |arrival| self.connect(&collision, arrival, typical, random));
        }
    }

    #[inline(always)]
    fn meet(&mut self, _: &Meeting, _: f64, _: &mut Sequence) {}
}

impl<'a> Connections<'a> {
    /// The connections of one walk, none so far.
    pub fn new(solid: &'a Solid<'a>, beams: &'a [Beams<'a>], matter: &'a Matter, channel: usize) -> Self {
        Connections { solid, beams, matter, channel, radiance: 0.0, count: 0, collisions: 0 }
    }

    /// Adds the light that arrives at a collision in one way (docs/method.md 14.8).
    fn connect(&mut self, collision: &Collision, arrival: &Arrival, typical: f64, random: &mut Sequence) {
        let legs = arrival.legs();
        let along = |direction: DVec3| density(direction.dot(legs[0].direction), self.matter.asymmetry);
        let phase = collision.direction.map_or(1.0 / (4.0 * PI), along);
        let extinction = (-self.matter.extinction * arrival.distance).exp();
        let value = collision.weight * arrival.fluence[self.channel] * extinction * phase;
        let share = (value / typical).min(1.0);
        if value <= 0.0 || share < 1.0 && random.uniform() >= share {
            return;
        }
        self.count += 1;
        let (towards, distance) = arrival.outside;
        let inside = legs.iter().all(|leg| self.solid.is_clear(leg, collision.nesting));
        if inside && self.solid.is_lit(arrival.triangle, arrival.weights, towards, distance) {
            self.radiance += value / share;
        }
    }
}
