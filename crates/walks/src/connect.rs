//! Connects the collisions of a walk from the camera to delta lights.

use crate::{
    beams::{Arrival, Beams},
    matter::Matter,
    phase::density,
    random::Sequence,
    solid::Solid,
    walk::{Collision, Observer},
};
use glam::DVec3;
use std::f64::consts::PI;

/// Connections of less than this share of the light's typical contribution are made with a probability in proportion
/// to it, and count as much more.
const ROULETTE: f64 = 0.1;

/// What is known of a collision before its connections: no more than this share of the typical contribution can come
/// from it, or the search for them is skipped with a probability.
const SEARCH: f64 = 0.1;

/// Collects the light of one channel that a walk from the camera meets.
pub struct Connections<'a> {
    pub solid: &'a Solid<'a>,
    pub beams: &'a [Beams<'a>],
    pub matter: &'a Matter,
    pub channel: usize,
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
}

impl Connections<'_> {
    /// Adds the light that arrives at a collision in one way (docs/method.md 14.8).
    fn connect(&mut self, collision: &Collision, arrival: &Arrival, typical: f64, random: &mut Sequence) {
        let along = |direction: DVec3| density(direction.dot(arrival.direction), self.matter.asymmetry);
        let phase = collision.direction.map_or(1.0 / (4.0 * PI), along);
        let extinction = (-self.matter.extinction * arrival.distance).exp();
        let value = collision.weight * arrival.fluence[self.channel] * extinction * phase;
        let share = (value / typical).min(1.0);
        if value <= 0.0 || share < 1.0 && random.uniform() >= share {
            return;
        }
        self.count += 1;
        let Collision { position, nesting, .. } = *collision;
        let (towards, distance) = arrival.outside;
        let inside = self.solid.is_clear(position, arrival.direction, arrival.distance, nesting);
        if inside && self.solid.is_lit(&arrival.entry, towards, distance) {
            self.radiance += value / share;
        }
    }
}
