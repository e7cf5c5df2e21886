//! Scattered light without a BSSRDF: random walks from the exitant point (docs/method.md section 14).

use crate::{
    counts::Counts,
    path_state::{Drawn, Layer, PathLight, PathState, ThreadContext},
    reference::Walks,
    renderer::Renderer,
};
use scene::{
    DVec3, Hit, SurfacePoint,
    light::{all_light_at, reflected},
};
use std::f64::consts::PI;
use walks::{
    Boundary, Connections, End, Exit, Lamps, Matter, Meeting, Observer, Roughness, Sequence, Smooth, Start, entered,
    observed_walk,
};

/// Where the walks of one exitant point begin.
struct Beginning<'a> {
    walks: &'a Walks<'a>,
    /// The meeting of the view with the boundary, and the normal of the triangle.
    meeting: Meeting,
    geometric_normal: DVec3,
}

impl Renderer<'_> {
    /// Adds the scattered light at an exitant point, by one walk for each channel: a walk that all channels shared would
    /// have to be weighted by the ratio of their densities, which after many collisions leaves it to one of them.
    pub(crate) fn walk(
        &self,
        state: &PathState,
        (walks, rough): (&Walks, Option<&Roughness>),
        point: &SurfacePoint,
        normal: DVec3,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) {
        let meeting = Meeting { position: point.position, face: point.triangle, normal, direction: state.direction };
        let beginning = Beginning { walks, meeting, geometric_normal: point.geometric_normal };
        let mut radiance = DVec3::ZERO;
        for channel in 0..3 {
            if let Some(matter) = &walks.matter[channel] {
                let random = Sequence::of_dimension(state.key, 3 * state.dimension + channel as u64);
                let mut random = match &state.walks {
                    Some(first) => random.beginning_with(first[channel]),
                    None => random,
                };
                let (random, counts) = (&mut random, &mut context.counts);
                radiance[channel] = match rough {
                    None => self.connected(&beginning, matter, channel, random, counts),
                    Some(rough) => self.lit(&beginning, (matter, rough), channel, random, counts),
                };
            }
        }
        light.add(state, Layer::Subsurface, radiance);
    }

    /// The light of a walk below a smooth boundary, whose collisions are connected to delta lights.
    fn connected(
        &self,
        beginning: &Beginning,
        matter: &Matter,
        channel: usize,
        random: &mut Sequence,
        counts: &mut Counts,
    ) -> f64 {
        let walks = beginning.walks;
        let mut light = Connections::new(&walks.solid, &walks.beams, matter, channel);
        let exit = beginning.follow(matter, &Smooth { eta: walks.eta }, random, &mut light, counts);
        counts.collisions += light.collisions;
        counts.connections += light.count;
        let met = exit.map_or(0.0, |exit| exit.weight * self.outside(&exit, None, random, counts)[channel]);
        light.radiance / (walks.eta * walks.eta) + met
    }

    /// The light of a walk below a rough boundary, for which lights are sampled where it meets the boundary.
    fn lit(
        &self,
        beginning: &Beginning,
        (matter, rough): (&Matter, &Roughness),
        channel: usize,
        random: &mut Sequence,
        counts: &mut Counts,
    ) -> f64 {
        let scene = self.input.scene;
        let surface = |meeting: &Meeting| rough.surface(scene, meeting);
        let mut light = Lamps::new(self.input.rays, &self.lights, surface, channel);
        let exit = beginning.follow(matter, &rough.of_walks(scene), random, &mut light, counts);
        counts.collisions += light.collisions;
        counts.shadow_rays += light.shadow_rays;
        let met = exit.map_or(0.0, |exit| {
            let left = light.left(exit.direction).map(|left| Drawn { at: left.at, density: left.density });
            exit.weight * self.outside(&exit, left.as_ref(), random, counts)[channel]
        });
        light.radiance + met
    }

    /// The radiance that a walk meets where it leaves: that of the environment, of emitting surfaces, and of opaque ones
    /// lit directly. Delta lights are never met, and other translucent surfaces are black, as for a cloud. Of lights that
    /// were sampled as well, where the walk left, it has its share.
    fn outside(&self, exit: &Exit, drawn: Option<&Drawn>, random: &mut Sequence, counts: &mut Counts) -> DVec3 {
        if !self.meets_light {
            return DVec3::ZERO;
        }
        counts.rays += 1;
        let Some(hit) = self.input.rays.closest(exit.position, exit.direction, Some(exit.face)) else {
            return match drawn {
                None => self.lights.distant_radiance(exit.position, exit.direction),
                Some(Drawn { at, density }) => self.lights.distant_radiance_by(at, exit.direction, *density),
            };
        };
        let Hit { triangle, weights, .. } = hit;
        let scene = self.input.scene;
        let point = scene.mesh.point(triangle, weights, self.settings.normals);
        let material = &scene.materials[point.material as usize];
        let in_front = point.geometric_normal.dot(exit.direction) < 0.0;
        let share =
            |Drawn { at, density }: &Drawn| self.lights.share_of_surface(point.material, at, exit.direction, *density);
        let emitted = match in_front || material.double_sided {
            true => scene.emission(triangle, weights) * drawn.map_or(1.0, share),
            false => DVec3::ZERO,
        };
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

impl Beginning<'_> {
    /// Follows a walk to its end; where it leaves after a collision, if it does.
    fn follow(
        &self,
        matter: &Matter,
        boundary: &impl Boundary,
        random: &mut Sequence,
        observer: &mut impl Observer,
        counts: &mut Counts,
    ) -> Option<Exit> {
        let Meeting { position, face, .. } = self.meeting;
        let direction = entered(boundary, &self.meeting, self.geometric_normal, random)?;
        let start = Start { position, direction, face: Some(face) };
        counts.walks += 1;
        match observed_walk(&self.walks.solid, matter, boundary, &start, random, observer) {
            End::Scattered(exit) => return Some(exit),
            End::Hole => counts.walks_escaped += 1,
            End::Trapped => counts.walks_trapped += 1,
            End::Opaque => counts.walks_absorbed_inside += 1,
            End::Unscattered(_) | End::Absorbed => {}
        }
        None
    }
}
