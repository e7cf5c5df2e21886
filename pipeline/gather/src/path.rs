//! note: [split] One camera path: Fresnel roulette at the interfaces, and `L_o = L_e + L_t + L_r` where light leaves.

use crate::{
    counts::Counts,
    path_light::{Guide, Layer, PathLight},
    path_state::{PathIndex, PathState, ThreadContext},
    renderer::{Renderer, TranslucentObject},
    shards::ShardPick,
};
use bssrdf::fresnel;
use scene::{DVec3, Hit, SurfacePoint, light::all_light_at};
use std::f64::consts::PI;

/// Dimensions of the random numbers that one branch of a path may use.
const BRANCH: u64 = 1 << 32;

impl Renderer<'_> {
    /// Light that arrives at the camera along one path. At its first interface the path splits in two.
    pub fn trace(&self, index: PathIndex, origin: DVec3, direction: DVec3, context: &mut ThreadContext) -> PathLight {
        let item = index.pixel << 32 | u64::from(index.path);
        let half = index.path as usize % 2;
        let mut state = PathState {
            origin,
            direction,
            from: None,
            inside: None,
            throughput: DVec3::ONE,
            layer: None,
            events: 0,
            half,
            turn: self.turn(index),
            random: self.paths.item(item),
            dimension: 0,
            key: self.gathers.item(item),
        };
        let mut light = PathLight::default();
        context.counts.paths += 1;
        let mut mirrored = None;
        self.follow(&mut state, &mut mirrored, &mut light, context);
        if let Some(mut state) = mirrored {
            self.follow(&mut state, &mut None, &mut light, context);
        }
        light
    }

    /// Among the paths of its half that are added at once.
    fn turn(&self, index: PathIndex) -> ShardPick {
        let half = index.path % 2;
        // The first path of this half, at `path` or after it.
        let first = |path: u32| (path + 1 - half) / 2;
        let (start, end) = (first(self.pass.start), first(self.pass.end));
        let random = || self.shard_picks.item(index.pixel).uniform(u64::from(2 * start + half));
        self.drawn.pick_shard(half as usize, index.path / 2 - start, end - start, random)
    }

    fn follow(
        &self,
        state: &mut PathState,
        mirrored: &mut Option<PathState>,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) {
        while self.step(state, mirrored, light, context) {
            state.events += 1;
            if state.events >= self.max_depth {
                context.counts.cut_by_depth += 1;
                break;
            }
        }
    }

    /// Follows the path to its next interface; false if it ends.
    fn step(
        &self,
        state: &mut PathState,
        mirrored: &mut Option<PathState>,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) -> bool {
        context.counts.rays += 1;
        let free = self.free_path(state);
        let Some(hit) = self.rays.closest_within(state.origin, state.direction, free, state.from) else {
            if free == f64::INFINITY {
                self.escape(state, light, &mut context.counts);
            }
            return false;
        };
        let point = self.scene.mesh.point(hit.triangle, hit.weights, self.normals);
        let front = state.direction.dot(point.geometric_normal) < 0.0;
        let object = self.objects[point.material as usize].as_ref();
        if object.is_some() && state.from.is_none() && state.inside.is_none() {
            context.counts.from_outside += u64::from(front);
            context.counts.from_inside += u64::from(!front);
        }
        if !self.attenuate(state, &point, front, hit.distance) {
            return false;
        }
        match object {
            None => {
                self.opaque(state, &point, &hit, light, &mut context.counts);
                false
            }
            Some(_) if front && state.inside.is_some() => {
                // Straight on, a little beyond: two triangles that meet in the ray would send it to and fro.
                context.counts.nested += 1;
                state.origin = point.position + state.direction * self.clearance;
                state.from = None;
                true
            }
            Some(object) if front => self.meet_from_outside(state, object, &point, mirrored, light, context),
            Some(object) => self.meet_from_inside(state, object, &point, &mut context.counts),
        }
    }

    /// How far a ray inside a medium goes without being scattered or absorbed, by one of the three channels (method.md
    /// 6.9). A ray that meets a surface within has survived with the mean of their transmittances.
    fn free_path(&self, state: &mut PathState) -> f64 {
        let Some(object) = state.inside.and_then(|m| self.objects[m as usize].as_ref()) else {
            return f64::INFINITY;
        };
        let channel = ((3.0 * state.uniform()) as usize).min(2);
        let sigma = object.unscattered[channel];
        if sigma > 0.0 { -(1.0 - state.uniform()).ln() / sigma } else { f64::INFINITY }
    }

    /// A ray that meets nothing more.
    fn escape(&self, state: &PathState, light: &mut PathLight, counts: &mut Counts) {
        let mut seen = self.lights.distant_radiance(state.origin, state.direction);
        if let Some(object) = state.inside.and_then(|m| self.objects[m as usize].as_ref()) {
            counts.escaped_inside += 1;
            let clear = object.unscattered.map(|sigma| f64::from(u8::from(sigma == 0.0)));
            // An infinite way through the medium; the channel of an infinite free path was one of the clear ones.
            seen *= DVec3::from_array(clear) * (3.0 / clear.iter().sum::<f64>().max(1.0));
        }
        light.add(state, Layer::Emission, seen);
    }

    /// Transmittance `e^{−σ̃_t s}` of the way through a medium (method.md 6.9), over the probability of having come so far:
    /// no channel grows by more than 3. False if the path ends.
    fn attenuate(&self, state: &mut PathState, point: &SurfacePoint, front: bool, distance: f64) -> bool {
        // A back face met from outside: the camera is inside, or the mesh is open. No free path was chosen then.
        let chosen = state.inside.is_some();
        let medium = state.inside.unwrap_or(point.material);
        let Some(object) = self.objects[medium as usize].as_ref().filter(|_| chosen || !front) else {
            return true;
        };
        let transmittance = DVec3::from_array(object.unscattered.map(|sigma| (-sigma * distance).exp()));
        let survival = transmittance.element_sum() / 3.0;
        if !chosen && survival < 1.0 && state.uniform() >= survival {
            return false;
        }
        state.throughput *= transmittance / survival;
        survival > 0.0
    }

    /// A Lambertian surface that may emit: the path ends here, lit directly.
    fn opaque(
        &self,
        state: &mut PathState,
        point: &SurfacePoint,
        hit: &Hit,
        light: &mut PathLight,
        counts: &mut Counts,
    ) {
        let front = state.direction.dot(point.geometric_normal) < 0.0;
        let material = &self.scene.materials[point.material as usize];
        if material.emits() && (front || material.double_sided) {
            light.add(state, Layer::Emission, material.emission);
        }
        let facing = point.facing(-state.direction);
        let xi = || [state.uniform(), state.uniform()];
        let irradiance = all_light_at(&self.lights, self.rays, &facing, xi, &mut counts.shadow_rays);
        light.add(state, Layer::Diffuse, self.scene.color(hit.triangle, hit.weights).truncate() / PI * irradiance);
    }

    /// Reflection with probability R, else refraction, which shows emitted and scattered light and goes on inside. The
    /// first interface of a path does both: choosing there would be most of the noise of an image.
    fn meet_from_outside(
        &self,
        state: &mut PathState,
        object: &TranslucentObject,
        point: &SurfacePoint,
        mirrored: &mut Option<PathState>,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) -> bool {
        let counts = &mut context.counts;
        let eta = object.medium.eta;
        let view = -state.direction;
        let mut normal = facing_normal(point.normal, point.geometric_normal, view, counts);
        let transmittance = fresnel::transmittance(normal.dot(view), eta);
        let splits = state.layer.is_none() && transmittance > 0.0;
        if !splits && state.uniform() >= transmittance {
            self.mirror(state, normal, point, counts);
            return true;
        }
        if splits {
            if transmittance < 1.0 {
                let mut branch = PathState { dimension: state.dimension + BRANCH, events: state.events + 1, ..*state };
                branch.throughput *= 1.0 - transmittance;
                self.mirror(&mut branch, normal, point, counts);
                *mirrored = (branch.events < self.max_depth).then_some(branch);
                counts.cut_by_depth += u64::from(mirrored.is_none());
            }
            state.throughput *= transmittance;
            light.through = if object.is_dark() { 0.0 } else { transmittance };
        }
        let emission = self.scene.materials[point.material as usize].emission;
        light.add(state, Layer::Emission, emission);
        self.gather(state, object, point, normal, light, context);
        if fresnel::enter(normal, view, eta).is_none_or(|e| e.direction.dot(point.geometric_normal) >= 0.0) {
            context.counts.geometric_normals += 1;
            normal = point.geometric_normal;
        }
        let Some(entry) = fresnel::enter(normal, view, eta) else {
            return false; // only the interpolated normal lets light through
        };
        state.inside = Some(point.material);
        state.leave(point, entry.direction, Layer::Transmission);
        true
    }

    /// Sends the path back from the outside of a surface.
    fn mirror(&self, state: &mut PathState, normal: DVec3, point: &SurfacePoint, counts: &mut Counts) {
        let view = -state.direction;
        let mut mirrored = fresnel::reflect(normal, view);
        if mirrored.dot(point.geometric_normal) <= 0.0 {
            counts.geometric_normals += 1;
            mirrored = fresnel::reflect(point.geometric_normal, view);
        }
        state.leave(point, mirrored, Layer::Specular);
    }

    /// Reflection inside with probability R_in, else out into the scene. Nothing is gathered from inside.
    fn meet_from_inside(
        &self,
        state: &mut PathState,
        object: &TranslucentObject,
        point: &SurfacePoint,
        counts: &mut Counts,
    ) -> bool {
        let (inward, geometric) = (-point.normal, -point.geometric_normal);
        let view = -state.direction;
        let normal = facing_normal(inward, geometric, view, counts);
        let eta_out = 1.0 / object.medium.eta;
        let transmittance = fresnel::transmittance(normal.dot(view), eta_out);
        if state.uniform() < transmittance
            && let Some(exit) = fresnel::enter(normal, view, eta_out)
        {
            state.inside = None;
            let mut direction = exit.direction;
            if direction.dot(geometric) >= 0.0 {
                counts.geometric_normals += 1;
                direction = fresnel::enter(geometric, view, eta_out).map_or(state.direction, |e| e.direction);
            }
            state.leave(point, direction, Layer::Transmission);
            return true;
        }
        state.inside = Some(point.material);
        let mut mirrored = fresnel::reflect(normal, view);
        if mirrored.dot(geometric) <= 0.0 {
            counts.geometric_normals += 1;
            mirrored = fresnel::reflect(geometric, view);
        }
        state.leave(point, mirrored, Layer::Transmission);
        true
    }

    /// [`PathLight::through`] of a path along this ray.
    pub fn through(&self, origin: DVec3, direction: DVec3, counts: &mut Counts) -> f64 {
        counts.edge_rays += 1;
        let Some(hit) = self.rays.closest(origin, direction, None) else {
            return 0.0;
        };
        let point = self.scene.mesh.point(hit.triangle, hit.weights, self.normals);
        let view = -direction;
        match &self.objects[point.material as usize] {
            Some(object) if view.dot(point.geometric_normal) > 0.0 && !object.is_dark() => {
                // What these rays meet is no event of a path.
                let normal = facing_normal(point.normal, point.geometric_normal, view, &mut Counts::default());
                fresnel::transmittance(normal.dot(view), object.medium.eta)
            }
            _ => 0.0,
        }
    }

    /// What the ray meets first.
    pub fn guide(&self, origin: DVec3, direction: DVec3) -> Guide {
        let Some(hit) = self.rays.closest(origin, direction, None) else {
            return Guide::default();
        };
        let point = self.scene.mesh.point(hit.triangle, hit.weights, self.normals);
        Guide {
            normal: point.normal,
            position: point.position + self.scene.origin,
            depth: hit.distance * direction.dot(self.camera.forward),
        }
    }
}

/// The normal for cosines with `view`: the interpolated one unless it turns away where the triangle does not.
fn facing_normal(normal: DVec3, geometric: DVec3, view: DVec3, counts: &mut Counts) -> DVec3 {
    if normal.dot(view) > 0.0 {
        return normal;
    }
    counts.geometric_normals += 1;
    geometric
}
