//! The light that a walk from the camera meets through a rough boundary.
//!
//! Such a boundary sends light to every point inside in all directions, so that lights are sampled where the walk meets
//! the boundary (docs/method.md 14.11).

use crate::{
    boundary::Meeting,
    random::Sequence,
    walk::{Collision, Observer},
};
use bsdf::{Bsdf, RoughDielectric, View};
use scene::{
    DVec3, Rays, SurfacePoint,
    light::{LightTree, all_lights_at},
};

/// Collects the light of one channel that is sampled where a walk meets a rough boundary.
pub struct Lamps<'a, F> {
    rays: &'a Rays<'a>,
    lights: &'a LightTree<'a>,
    /// The surface at a point of the boundary.
    surface: F,
    channel: usize,
    /// Outside, without the transmittance of the first boundary, W/(m² sr).
    pub radiance: f64,
    pub shadow_rays: u64,
    pub collisions: u64,
    last: Option<(SurfacePoint, View)>,
}

/// Where a walk left that lights were sampled for.
#[derive(Clone, Copy, Debug)]
pub struct Left {
    pub at: SurfacePoint,
    /// Density with which walks leave in its direction, 1/sr.
    pub density: f64,
}

impl<'a, 's, F: Fn(&Meeting) -> RoughDielectric<'s>> Lamps<'a, F> {
    /// The light of one walk, none so far.
    pub fn new(rays: &'a Rays<'a>, lights: &'a LightTree<'a>, surface: F, channel: usize) -> Self {
        Lamps { rays, lights, surface, channel, radiance: 0.0, shadow_rays: 0, collisions: 0, last: None }
    }

    /// Where the walk left in this direction; none if it did not.
    pub fn left(&self, direction: DVec3) -> Option<Left> {
        let (at, view) = self.last?;
        let meeting =
            Meeting { position: at.position, face: at.triangle, normal: -view.normal, direction: -view.direction };
        Some(Left { at, density: (self.surface)(&meeting).scatter_density(&view, direction) })
    }
}

impl<'s, F: Fn(&Meeting) -> RoughDielectric<'s>> Observer for Lamps<'_, F> {
    const SEES_JUMPS: bool = false;

    #[inline(always)]
    fn collide(&mut self, _: &Collision, _: &mut Sequence) {
        self.collisions += 1;
    }

    fn meet(&mut self, meeting: &Meeting, weight: f64, random: &mut Sequence) {
        let Meeting { position, face, normal, .. } = *meeting;
        let at = SurfacePoint::smooth(position, normal, normal, face, 0);
        let (surface, view) = ((self.surface)(meeting), meeting.view());
        self.last = Some((at, view));
        let xi = || [random.uniform(), random.uniform()];
        let arriving = all_lights_at(self.lights, self.rays, &at, (1, xi), &mut self.shadow_rays, |light| {
            let passed = surface.evaluate(&view, light.direction).x;
            // Light that walks meet as well counts by the balance heuristic.
            let met = if light.density > 0.0 { passed * normal.dot(light.direction) } else { 0.0 };
            let share = if met > 0.0 { light.density / (light.density + met) } else { 1.0 };
            light.irradiance[self.channel] * passed * share
        });
        self.radiance += weight * arriving;
    }
}
