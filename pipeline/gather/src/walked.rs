//! Scattered light without a BSSRDF: random walks from the exitant point (docs/method.md section 14).

use crate::{
    counts::Counts,
    path_state::{Layer, PathLight, PathState, ThreadContext},
    reference::Walks,
    renderer::Renderer,
};
use bsdf::fresnel;
use scene::{
    DVec3, Hit, SurfacePoint,
    light::{all_light_at, reflected},
};
use std::f64::consts::PI;
use walks::{Connections, End, Exit, Sequence, Start, observed_walk};

impl Renderer<'_> {
    /// Adds the scattered light at an exitant point, by one walk for each channel: a walk that all channels shared would
    /// have to be weighted by the ratio of their densities, which after many collisions leaves it to one of them.
    pub(crate) fn walk(
        &self,
        state: &PathState,
        walks: &Walks,
        point: &SurfacePoint,
        normal: DVec3,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) {
        let refracted = |normal| fresnel::enter(normal, -state.direction, walks.eta).map(|entry| entry.direction);
        let below = |direction: &DVec3| direction.dot(point.geometric_normal) < 0.0;
        let direction = refracted(normal).filter(below).or_else(|| refracted(point.geometric_normal));
        let Some(direction) = direction else { return };
        let start = Start { position: point.position, direction, face: Some(point.triangle) };
        let mut radiance = DVec3::ZERO;
        for channel in 0..3 {
            if let Some(matter) = &walks.matter[channel] {
                let random = Sequence::of_dimension(state.key, 3 * state.dimension + channel as u64);
                let mut random = match &state.walks {
                    Some(first) => random.beginning_with(first[channel]),
                    None => random,
                };
                let (solid, beams) = (&walks.solid, &walks.beams);
                let mut light = Connections::new(solid, beams, matter, channel);
                let end = observed_walk(solid, matter, &start, &mut random, &mut light);
                let counts = &mut context.counts;
                counts.walks += 1;
                counts.collisions += light.collisions;
                counts.connections += light.count;
                radiance[channel] = light.radiance / (walks.eta * walks.eta);
                match end {
                    End::Scattered(exit) => {
                        radiance[channel] += exit.weight * self.outside(&exit, &mut random, counts)[channel];
                    }
                    End::Hole => counts.walks_escaped += 1,
                    End::Trapped => counts.walks_trapped += 1,
                    End::Opaque => counts.walks_absorbed_inside += 1,
                    End::Unscattered(_) | End::Absorbed => {}
                }
            }
        }
        light.add(state, Layer::Subsurface, radiance);
    }

    /// The radiance that a walk meets where it leaves: that of the environment, of emitting surfaces, and of opaque ones
    /// lit directly. Delta lights are never met, and other translucent surfaces are black, as for a cloud.
    fn outside(&self, exit: &Exit, random: &mut Sequence, counts: &mut Counts) -> DVec3 {
        if !self.meets_light {
            return DVec3::ZERO;
        }
        counts.rays += 1;
        let Some(hit) = self.input.rays.closest(exit.position, exit.direction, Some(exit.face)) else {
            return self.lights.distant_radiance(exit.position, exit.direction);
        };
        let Hit { triangle, weights, .. } = hit;
        let scene = self.input.scene;
        let point = scene.mesh.point(triangle, weights, self.settings.normals);
        let material = &scene.materials[point.material as usize];
        let in_front = point.geometric_normal.dot(exit.direction) < 0.0;
        let emitted = if in_front || material.double_sided { scene.emission(triangle, weights) } else { DVec3::ZERO };
        // What panes mirror is left out, as for a cloud.
        if self.objects[point.material as usize].is_some() || scene.is_pane(point.material) {
            return emitted;
        }
        let point = point.facing(-exit.direction);
        let xi = || [random.uniform(), random.uniform()];
        let shadow_rays = &mut counts.shadow_rays;
        if scene.is_wall(point.material) {
            return emitted + reflected(scene, &self.lights, (self.input.rays, &hit), &point, xi, shadow_rays) / PI;
        }
        let albedo = scene.diffuse(triangle, weights);
        emitted + albedo / PI * all_light_at(&self.lights, self.input.rays, &point, xi, shadow_rays)
    }
}
