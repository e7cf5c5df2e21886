//! The light of thin walls, which are lit from both sides (docs/method.md 13.8).

use crate::{counts::Counts, path_state::PathState, renderer::Renderer};
use bsdf::{Bsdf, Side, ThinWall, View};
use scene::{DVec3, SurfacePoint, light::all_lights_at};

impl Renderer<'_> {
    /// Radiance that a wall scatters to the viewer, from lights on the viewer's side and behind, W/(m² sr). The normals of
    /// the point are on the side that the path comes from.
    pub fn wall_light(
        &self,
        state: &mut PathState,
        (point, side): (&SurfacePoint, Side),
        wall: &ThinWall,
        counts: &mut Counts,
    ) -> DVec3 {
        let view = View { normal: point.normal, direction: -state.direction, side };
        let behind = point.facing(-point.geometric_normal);
        let (tries, mut xi) = state.light_numbers();
        let mut of_side = |at: &SurfacePoint| {
            // A diffuse BSDF has one value for all directions of a side, which the irradiance of all lights is multiplied by.
            let (numbers, shadow_rays) = ((tries, &mut xi), &mut counts.shadow_rays);
            let irradiance = all_lights_at(&self.lights, self.input.rays, at, numbers, shadow_rays, |l| l.irradiance);
            wall.evaluate(&view, at.normal) * irradiance
        };
        of_side(point) + of_side(&behind)
    }
}
