//! `note: [split]` One camera path: `L_o = L_e + L_t + L_r` where it refracts at a surface (docs/method.md 6.6), and
//! what reflects there. A [`Bsdf`] says what happens at the surface; the path chooses between its lobes.

use crate::{
    counts::Counts,
    meeting::Meeting,
    path_state::{Guide, Layer, PathIndex, PathLight, PathState, ThreadContext, Trace, Way},
    renderer::{Renderer, TranslucentObject},
    seen::Glimpse,
};
use bsdf::{Bsdf, Lobe, Side, Surface, View};
use scene::{DVec3, Hit, SurfacePoint, light::all_lights_at};
use sums::drawn::ShardPick;

/// The second branch of a path uses the random numbers from this dimension on.
const BRANCH: u64 = 1 << 32;

/// How much likelier than its light a ray reaches the end of a medium, at most: chance does not decide about paths of more than
/// the inverse of this, as a share of the light.
const LIKELIER: f64 = 512.0;

/// The factor by which the transmittance of a channel is multiplied to be the probability of a ray.
fn boost(state: &PathState) -> f64 {
    (LIKELIER * state.throughput.max_element()).clamp(1.0, LIKELIER)
}

/// The probability with which a ray reaches the surface behind such a transmittance: the mean over the channels.
fn reached(transmittance: DVec3, boost: f64) -> f64 {
    (boost * transmittance).min(DVec3::ONE).element_sum() / 3.0
}

impl Renderer<'_> {
    /// Light that arrives at the camera along one path. At its first interface the path splits into a refracted and a
    /// reflected branch.
    pub fn trace(&self, index: PathIndex, origin: DVec3, direction: DVec3, context: &mut ThreadContext) -> PathLight {
        let mut state = self.begin(index, origin, direction);
        let mut trace = Trace::default();
        context.counts.paths += 1;
        self.follow(&mut state, &mut trace, context);
        if let Some(mut state) = trace.mirrored.take() {
            self.follow(&mut state, &mut trace, context);
        }
        trace.light
    }

    /// A path before its first surface.
    pub(crate) fn begin(&self, index: PathIndex, origin: DVec3, direction: DVec3) -> PathState {
        let item = index.pixel << 32 | u64::from(index.path);
        let half = index.path as usize % 2;
        PathState {
            origin,
            direction,
            from: None,
            inside: None,
            throughput: DVec3::ONE,
            drawn: None,
            mirrored_share: 1.0,
            emitted_share: 1.0,
            layer: None,
            events: 0,
            splits: true,
            half,
            shard_pick: self.pick_shard(index),
            walks: index.walks,
            near: index.near,
            mirrors: 0.0,
            edge: index.edge,
            accuracy: None,
            light: index.surface,
            mirrored: index.surface,
            random: self.paths.item(item),
            dimension: 0,
            key: self.gathers.item(item),
            near_points: self.near_points.item(item),
        }
    }

    /// Picks the shard that a path gathers from. Shards alternate over the paths of one half and one pass.
    fn pick_shard(&self, index: PathIndex) -> ShardPick {
        let half = index.path % 2;
        // The number of paths of this half before `path`.
        let first = |path: u32| (path + 1 - half) / 2;
        let (start, end) = (first(self.pass.start), first(self.pass.end));
        let random = || self.shard_picks.item(index.pixel).uniform(u64::from(2 * start + half));
        // Where pixels share their paths there is one shard, and the path may be one from before the pass of others.
        self.drawn.pick_shard(half as usize, (index.path / 2).saturating_sub(start), end - start, random)
    }

    /// Follows a branch until it ends.
    fn follow(&self, state: &mut PathState, trace: &mut Trace, context: &mut ThreadContext) {
        while self.step(state, trace, context) {
            state.events += 1;
            if state.events >= self.settings.max_depth {
                context.counts.cut_by_depth += 1;
                break;
            }
        }
    }

    /// Follows the path to its next surface; false if it ends.
    fn step(&self, state: &mut PathState, trace: &mut Trace, context: &mut ThreadContext) -> bool {
        context.counts.rays += 1;
        let free = self.free_path(state);
        let Some(hit) = self.input.rays.closest_within(state.origin, state.direction, free, state.from) else {
            if free == f64::INFINITY {
                self.escape(state, &mut trace.light, &mut context.counts);
            }
            return false;
        };
        let point = self.input.scene.mesh.point(hit.triangle, hit.weights, self.settings.normals);
        let side = if state.direction.dot(point.geometric_normal) < 0.0 { Side::Outside } else { Side::Inside };
        let object = self.objects[point.material as usize].as_ref();
        if object.is_some() && state.from.is_none() && state.inside.is_none() {
            context.counts.from_outside += u64::from(side == Side::Outside);
            context.counts.from_inside += u64::from(side == Side::Inside);
        }
        if !self.attenuate(state, point.material, side, hit.distance) {
            return false;
        }
        let point = point.facing(-state.direction);
        match (object, side) {
            (None, _) => self.meet_opaque(state, &point, side, &hit, &mut trace.light, &mut context.counts),
            (Some(_), Side::Outside) if state.inside.is_some() => {
                // The path is inside another object already and goes straight on. It starts a little beyond the
                // surface, because two triangles at the same point of the ray would send it back and forth.
                context.counts.nested += 1;
                state.origin = point.position + state.direction * self.clearance;
                state.from = None;
                true
            }
            (Some(object), Side::Outside) => self.meet_from_outside(state, object, (&point, &hit), trace, context),
            (Some(object), Side::Inside) => self.meet_from_inside(state, object, (&point, &hit), &mut context.counts),
        }
    }

    /// Distance at which a ray inside a medium ends, m, drawn by the extinction of one of the three channels (docs/method.md
    /// 6.9), so that it reaches a surface with the probability [`reached`].
    fn free_path(&self, state: &mut PathState) -> f64 {
        let Some(object) = state.inside.and_then(|m| self.objects[m as usize].as_ref()) else {
            return f64::INFINITY;
        };
        let channel = ((3.0 * state.uniform()) as usize).min(2);
        let sigma = object.unscattered[channel];
        if sigma > 0.0 { (boost(state).ln() - (1.0 - state.uniform()).ln()) / sigma } else { f64::INFINITY }
    }

    /// Adds the environment for a ray that meets no further surface.
    pub(crate) fn escape(&self, state: &PathState, light: &mut PathLight, counts: &mut Counts) {
        if let Some(backdrop) = self.settings.backdrop.filter(|_| state.layer.is_none() && state.inside.is_none()) {
            return light.add(state, Layer::Emission, backdrop);
        }
        let mut seen = match &state.drawn {
            None => self.lights.distant_radiance(state.origin, state.direction),
            Some(drawn) => self.lights.distant_radiance_by(&drawn.at, state.direction, drawn.density),
        };
        if let Some(object) = state.inside.and_then(|m| self.objects[m as usize].as_ref()) {
            counts.escaped_inside += 1;
            // Only channels without extinction see through an infinite medium. The ray escaped because one of them was
            // drawn for its free path; each channel is drawn with a probability of one third.
            let clear = object.unscattered.map(|sigma| f64::from(u8::from(sigma == 0.0)));
            seen *= DVec3::from_array(clear) * (3.0 / clear.iter().sum::<f64>().max(1.0));
        }
        light.add(state, Layer::Emission, seen * state.emitted_share);
    }

    /// Multiplies the throughput by the transmittance `e^{−σ̃_t s}` of a medium (docs/method.md 6.9) over the
    /// probability that the ray came so far: no channel grows by more than a factor of 3. False if the path ends.
    fn attenuate(&self, state: &mut PathState, material: u16, side: Side, distance: f64) -> bool {
        // Without a known medium, a back face is met if the camera is inside or the mesh is open. Then no free path was
        // drawn for this ray.
        let chosen = state.inside.is_some();
        let medium = state.inside.unwrap_or(material);
        let within = |_: &&TranslucentObject| chosen || side == Side::Inside;
        let Some(object) = self.objects[medium as usize].as_ref().filter(within) else {
            return true;
        };
        let transmittance = DVec3::from_array(object.unscattered.map(|sigma| (-sigma * distance).exp()));
        let survival = reached(transmittance, boost(state));
        if !chosen && survival < 1.0 && state.uniform() >= survival {
            return false;
        }
        state.throughput *= transmittance / survival;
        survival > 0.0
    }

    /// Adds the light of an opaque surface, which may emit. A specular surface sends the path on; any other is lit
    /// directly and ends the path.
    fn meet_opaque(
        &self,
        state: &mut PathState,
        point: &SurfacePoint,
        side: Side,
        hit: &Hit,
        light: &mut PathLight,
        counts: &mut Counts,
    ) -> bool {
        let material = &self.input.scene.materials[point.material as usize];
        if material.emits() && (side == Side::Outside || material.double_sided) {
            let emission = self.input.scene.emission(hit.triangle, hit.weights);
            light.add(state, Layer::Emission, emission * self.share_of(state, point.material));
        }
        if let Some(wall) = self.input.scene.wall(hit.triangle, hit.weights) {
            let scattered = self.wall_light(state, (point, side), &wall, counts);
            light.add(state, Layer::Diffuse, scattered);
            return false;
        }
        // A ray meets a pane only where that mirrors.
        let is_pane = self.input.scene.is_pane(point.material);
        if !is_pane && let Some(stated) = self.input.scene.gloss(hit.triangle, hit.weights) {
            return self.meet_gloss(state, point, side, &stated, light, counts);
        }
        let bsdf = match is_pane {
            true => Surface::dielectric(1.0),
            false => Surface::opaque(self.input.scene.color(hit.triangle, hit.weights).truncate()),
        };
        if bsdf.is_specular() {
            let meeting = Meeting::new(point, bsdf, side, -state.direction, counts);
            return meeting.scatter(state, Lobe::Reflection, Layer::Specular, counts);
        }
        let view = View { normal: point.normal, direction: -state.direction, side };
        let (numbers, shadow_rays) = (state.light_numbers(), &mut counts.shadow_rays);
        let irradiance =
            all_lights_at(&self.lights, self.input.rays, point, numbers, shadow_rays, |light| light.irradiance);
        // A diffuse BSDF has one value for all directions, which the irradiance of all lights is multiplied by.
        light.add(state, Layer::Diffuse, bsdf.evaluate(&view, view.normal) * irradiance);
        false
    }

    /// Reflection with probability `R`, otherwise refraction, which shows emitted and scattered light and goes on
    /// inside. The first interface of a path does both: a choice there would be most of the noise of an image.
    fn meet_from_outside(
        &self,
        state: &mut PathState,
        object: &TranslucentObject,
        (point, hit): (&SurfacePoint, &Hit),
        trace: &mut Trace,
        context: &mut ThreadContext,
    ) -> bool {
        let counts = &mut context.counts;
        let surface = object.surface(self.input.scene, hit);
        let meeting = Meeting::new(point, surface, Side::Outside, -state.direction, counts);
        let transmittance = meeting.transmittance();
        let (mut way, from) = (None, state.origin);
        let first = state.layer.is_none();
        let splits = state.splits && transmittance > 0.0;
        if !splits && state.uniform() >= transmittance {
            return self.reflect(state, &meeting, &mut trace.light, counts);
        }
        if splits {
            if transmittance < 1.0 {
                let mut branch = PathState {
                    dimension: state.dimension + BRANCH,
                    events: state.events + 1,
                    walks: None,
                    near: None,
                    splits: false,
                    ..*state
                };
                branch.throughput *= 1.0 - transmittance;
                branch.mirrors = if first && meeting.bsdf.is_specular() { 1.0 - transmittance } else { 0.0 };
                let follows = self.reflect(&mut branch, &meeting, &mut trace.light, counts);
                trace.mirrored = (follows && branch.events < self.settings.max_depth).then_some(branch);
                counts.cut_by_depth += u64::from(follows && trace.mirrored.is_none());
            }
            state.splits = false;
            state.throughput *= transmittance;
            way = first.then_some((Way::Direct, transmittance));
        } else if state.mirrors > 0.0 && state.events == 1 {
            way = Some((Way::Mirrored, state.mirrors));
        }
        let emission = self.input.scene.emission(hit.triangle, hit.weights) * self.share_of(state, point.material);
        trace.light.add(state, Layer::Emission, emission);
        self.gather(state, object, (point, hit), &meeting.view, &mut trace.light, context);
        if let Some((way, share)) = way.filter(|_| state.edge) {
            let glimpse = Glimpse { object, hit: *hit, point: *point, view: meeting.view };
            let first = if way == Way::Direct { point.position } else { from };
            trace.light.known[way as usize] = share * self.known_light(first, way, &glimpse, context);
        }
        (state.walks, state.near) = (None, None);
        state.inside = Some(point.material);
        // If only the interpolated normal lets light through, the path ends here.
        meeting.scatter(state, Lobe::Transmission, Layer::Transmission, &mut context.counts)
    }

    /// Reflection inside with probability `R_in` (docs/method.md 6.9), otherwise refraction out into the scene. Nothing
    /// is gathered from inside.
    fn meet_from_inside(
        &self,
        state: &mut PathState,
        object: &TranslucentObject,
        (point, hit): (&SurfacePoint, &Hit),
        counts: &mut Counts,
    ) -> bool {
        let surface = object.surface(self.input.scene, hit);
        let meeting = Meeting::new(point, surface, Side::Inside, -state.direction, counts);
        if state.uniform() >= meeting.transmittance() {
            state.inside = Some(point.material);
            return meeting.scatter(state, Lobe::Reflection, Layer::Transmission, counts);
        }
        state.inside = None;
        if !meeting.scatter(state, Lobe::Transmission, Layer::Transmission, counts) {
            if !meeting.bsdf.is_specular() {
                return false;
            }
            // Only the interpolated normal lets light through: the path goes straight on.
            state.leave(point, state.direction, Layer::Transmission);
        }
        true
    }

    /// Normal, position, depth and material of what the ray meets first.
    pub fn guide(&self, origin: DVec3, direction: DVec3) -> Guide {
        let Some(hit) = self.input.rays.closest(origin, direction, None) else {
            return Guide::default();
        };
        let point = self.input.scene.mesh.point(hit.triangle, hit.weights, self.settings.normals);
        let albedo = match &self.objects[point.material as usize] {
            Some(object) => object.color,
            None => self.input.scene.color(hit.triangle, hit.weights).truncate(),
        };
        Guide {
            normal: point.normal,
            position: point.position + self.input.scene.origin,
            depth: hit.distance * direction.dot(self.input.camera.forward),
            albedo,
            id: u32::from(point.material) + 1,
        }
    }
}
