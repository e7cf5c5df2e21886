//! note: [split] One camera path: Fresnel roulette at the interfaces, and `L_o = L_e + L_t + L_r` where light leaves.

use crate::{
    estimator::{Estimator, Exhaustive, Rates, Roulette, Sum},
    film::{Guide, Layer, Layers},
    samples::{Exit, LitSamples},
};
use bssrdf::{Medium, fresnel, lanes::LaneModel, simd};
use scene::{
    Camera, DVec3, Hit, NormalKind, Rays, Scene, SurfacePoint,
    light::all_light_at,
    random::{Item, Stream},
};
use std::f64::consts::PI;

/// A translucent material with its medium and its samples.
pub struct Body<M> {
    pub medium: Medium,
    pub model: M,
    /// `σ̃_t` of light that is not scattered, 1/m.
    pub unscattered: [f64; 3],
    pub rates: Rates,
    pub samples: LitSamples,
}

/// Everything a path needs; shared by all threads.
pub struct Renderer<'a, M> {
    pub scene: &'a Scene,
    pub rays: &'a Rays,
    pub camera: &'a Camera,
    /// One entry for each material; none for opaque ones.
    pub bodies: Vec<Option<Body<M>>>,
    /// Radiance of rays that escape, W/(m² sr).
    pub environment: DVec3,
    pub normals: NormalKind,
    pub estimator: Estimator,
    /// `K`, the unlit samples included.
    pub samples_drawn: f64,
    pub max_depth: u32,
    /// How far beyond a surface a ray goes on that passes it straight, m.
    pub clearance: f64,
    pub paths: Stream,
    pub roulette: Stream,
}

/// What happened on the paths of an image.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub paths: u64,
    pub rays: u64,
    pub shadow_rays: u64,
    pub gathers: u64,
    pub evaluations: u64,
    /// Paths ended by the depth limit: their light is missing.
    pub cut_by_depth: u64,
    /// Paths that left a medium without meeting its surface: the mesh is open.
    pub escaped_inside: u64,
    /// Outer surfaces met from inside a medium, passed straight: objects overlap.
    pub nested: u64,
    /// Points where the interpolated normal contradicts the triangle, whose own normal was taken.
    pub geometric_normals: u64,
}

impl Counts {
    pub fn add(&mut self, other: &Counts) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.gathers += other.gathers;
        self.evaluations += other.evaluations;
        self.cut_by_depth += other.cut_by_depth;
        self.escaped_inside += other.escaped_inside;
        self.nested += other.nested;
        self.geometric_normals += other.geometric_normals;
    }
}

/// A path on its way.
struct Walker {
    origin: DVec3,
    direction: DVec3,
    /// The triangle that the ray starts on.
    from: Option<u32>,
    /// The material whose medium the ray is in.
    inside: Option<u16>,
    throughput: DVec3,
    /// The layer of all further light, once there was an event.
    layer: Option<Layer>,
    light: Layers,
    random: Item,
    dimension: u64,
    key: Item,
}

impl Walker {
    fn uniform(&mut self) -> f64 {
        self.dimension += 1;
        self.random.uniform(self.dimension - 1)
    }

    /// Files light under the path's layer, or under `layer` if nothing happened to it yet.
    fn add(&mut self, layer: Layer, radiance: DVec3) {
        self.light[self.layer.unwrap_or(layer) as usize] += self.throughput * radiance;
    }

    fn leave(&mut self, point: &SurfacePoint, direction: DVec3, event: Layer) {
        self.origin = point.position;
        self.direction = direction;
        self.from = Some(point.triangle);
        self.layer.get_or_insert(event);
    }
}

impl<M: LaneModel> Renderer<'_, M> {
    /// Light that arrives at the camera along one path.
    pub fn trace(&self, index: u64, origin: DVec3, direction: DVec3, counts: &mut Counts) -> Layers {
        let (random, key) = (self.paths.item(index), self.roulette.item(index));
        let mut walker = Walker {
            origin,
            direction,
            from: None,
            inside: None,
            throughput: DVec3::ONE,
            layer: None,
            light: [DVec3::ZERO; 5],
            random,
            dimension: 2, // the first two chose the point in the pixel
            key,
        };
        counts.paths += 1;
        let mut events = 0;
        while self.step(&mut walker, counts) {
            events += 1;
            if events >= self.max_depth {
                counts.cut_by_depth += 1;
                break;
            }
        }
        walker.light
    }

    /// Follows the path to its next interface; false if it ends.
    fn step(&self, walker: &mut Walker, counts: &mut Counts) -> bool {
        counts.rays += 1;
        let Some(hit) = self.rays.closest(walker.origin, walker.direction, walker.from) else {
            self.escape(walker, counts);
            return false;
        };
        let point = self.scene.mesh.point(hit.triangle, hit.weights, self.normals);
        let front = walker.direction.dot(point.geometric_normal) < 0.0;
        let body = self.bodies[point.material as usize].as_ref();
        // A back face met from outside: the camera is inside, or the mesh is open.
        let medium = walker.inside.or((!front && body.is_some()).then_some(point.material));
        if let Some(medium) = medium
            && !self.attenuate(walker, medium, hit.distance)
        {
            return false;
        }
        match body {
            None => {
                self.opaque(walker, &point, front, counts);
                false
            }
            Some(_) if front && walker.inside.is_some() => {
                // Straight on, a little beyond: two triangles that meet in the ray would send it to and fro.
                counts.nested += 1;
                walker.origin = point.position + walker.direction * self.clearance;
                walker.from = None;
                true
            }
            Some(body) if front => self.meet_from_outside(walker, body, &point, counts),
            Some(body) => self.meet_from_inside(walker, body, &point, counts),
        }
    }

    /// A ray that meets nothing more.
    fn escape(&self, walker: &mut Walker, counts: &mut Counts) {
        let mut seen = self.environment;
        if let Some(body) = walker.inside.and_then(|m| self.bodies[m as usize].as_ref()) {
            counts.escaped_inside += 1;
            for c in 0..3 {
                if body.unscattered[c] > 0.0 {
                    seen[c] = 0.0; // an infinite way through the medium
                }
            }
        }
        walker.add(Layer::Emission, seen);
    }

    /// Transmittance `e^{−σ̃_t s}` of the way through a medium (method.md 6.9), with roulette on its mean: no channel
    /// grows by more than 3. False if the path ends.
    fn attenuate(&self, walker: &mut Walker, medium: u16, distance: f64) -> bool {
        let Some(body) = &self.bodies[medium as usize] else {
            return true;
        };
        let transmittance = DVec3::from_array(body.unscattered.map(|sigma| (-sigma * distance).exp()));
        let survival = transmittance.element_sum() / 3.0;
        if survival < 1.0 && walker.uniform() >= survival {
            return false;
        }
        walker.throughput *= transmittance / survival;
        true
    }

    /// A Lambertian surface that may emit: the path ends here, lit directly.
    fn opaque(&self, walker: &mut Walker, point: &SurfacePoint, front: bool, counts: &mut Counts) {
        let material = &self.scene.materials[point.material as usize];
        if material.emits() && (front || material.double_sided) {
            walker.add(Layer::Emission, material.emission);
        }
        let mut facing = *point;
        if !front {
            facing.normal = -facing.normal;
            facing.geometric_normal = -facing.geometric_normal;
        }
        let xi = || [walker.uniform(), walker.uniform()];
        let irradiance = all_light_at(&self.scene.lights, self.rays, &facing, xi, &mut counts.shadow_rays);
        walker.add(Layer::Diffuse, material.base_color / PI * irradiance);
    }

    /// Reflection with probability R, else refraction, which shows emitted and scattered light and goes on inside.
    fn meet_from_outside(
        &self,
        walker: &mut Walker,
        body: &Body<M>,
        point: &SurfacePoint,
        counts: &mut Counts,
    ) -> bool {
        let eta = body.medium.eta;
        let view = -walker.direction;
        let mut normal = facing_normal(point.normal, point.geometric_normal, view, counts);
        let transmittance = fresnel::transmittance(normal.dot(view), eta);
        if walker.uniform() >= transmittance {
            let mut mirrored = fresnel::reflect(normal, view);
            if mirrored.dot(point.geometric_normal) <= 0.0 {
                counts.geometric_normals += 1;
                mirrored = fresnel::reflect(point.geometric_normal, view);
            }
            walker.leave(point, mirrored, Layer::Specular);
            return true;
        }
        let emission = self.scene.materials[point.material as usize].emission;
        walker.add(Layer::Emission, emission);
        let scattered = self.gather(walker, body, point, normal, counts);
        walker.add(Layer::Subsurface, scattered);
        if fresnel::enter(normal, view, eta).is_none_or(|e| e.direction.dot(point.geometric_normal) >= 0.0) {
            counts.geometric_normals += 1;
            normal = point.geometric_normal;
        }
        let Some(entry) = fresnel::enter(normal, view, eta) else {
            return false; // only the interpolated normal lets light through
        };
        walker.inside = Some(point.material);
        walker.leave(point, entry.direction, Layer::Transmission);
        true
    }

    /// Reflection inside with probability R_in, else out into the scene. Nothing is gathered from inside.
    fn meet_from_inside(&self, walker: &mut Walker, body: &Body<M>, point: &SurfacePoint, counts: &mut Counts) -> bool {
        let (inward, geometric) = (-point.normal, -point.geometric_normal);
        let view = -walker.direction;
        let normal = facing_normal(inward, geometric, view, counts);
        let eta_out = 1.0 / body.medium.eta;
        let transmittance = fresnel::transmittance(normal.dot(view), eta_out);
        if walker.uniform() < transmittance
            && let Some(exit) = fresnel::enter(normal, view, eta_out)
        {
            walker.inside = None;
            let mut direction = exit.direction;
            if direction.dot(geometric) >= 0.0 {
                counts.geometric_normals += 1;
                direction = fresnel::enter(geometric, view, eta_out).map_or(walker.direction, |e| e.direction);
            }
            walker.leave(point, direction, Layer::Transmission);
            return true;
        }
        walker.inside = Some(point.material);
        let mut mirrored = fresnel::reflect(normal, view);
        if mirrored.dot(geometric) <= 0.0 {
            counts.geometric_normals += 1;
            mirrored = fresnel::reflect(geometric, view);
        }
        walker.leave(point, mirrored, Layer::Transmission);
        true
    }

    /// note: [reflectance] `L_r` at an exitant point: the mean over all drawn samples (method.md 6.7).
    fn gather(
        &self,
        walker: &Walker,
        body: &Body<M>,
        point: &SurfacePoint,
        normal: DVec3,
        counts: &mut Counts,
    ) -> DVec3 {
        if body.samples.is_empty() || body.medium.is_clear() {
            return DVec3::ZERO;
        }
        let exit = Exit::new(point.position, normal, walker.key.bits(walker.dimension));
        let sum = self.sum(body, &exit);
        counts.gathers += 1;
        counts.evaluations += sum.evaluations;
        sum.radiance / self.samples_drawn
    }

    fn sum(&self, body: &Body<M>, exit: &Exit) -> Sum {
        let (model, samples) = (&body.model, &body.samples);
        match self.estimator {
            Estimator::Exhaustive => simd::dispatch(Exhaustive { model, samples, exit }),
            Estimator::Roulette(_) => simd::dispatch(Roulette { model, samples, exit, rates: body.rates }),
        }
    }

    /// What the ray meets first.
    pub fn guide(&self, origin: DVec3, direction: DVec3) -> Guide {
        let Some(hit): Option<Hit> = self.rays.closest(origin, direction, None) else {
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
