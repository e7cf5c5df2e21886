//! The light that enters close to an exitant point, closer than the samples of a cloud lie to each other: points are
//! drawn around the exitant point and lit as samples are (docs/method.md section 17).
//!
//! Around most points the surface is nearly a plane in even light. The plane through the exitant point in its light is
//! a control variate, whose integral is known: what is left to chance is what curvature and shadows change.

mod profile;

use bssrdf::{Bssrdf, Medium, Model, Partition, Separation, fresnel};
use glam::DVec3;
use profile::{PlaneIntegral, Profile, Radii};
use scene::{
    Hit, Mesh, NormalKind, Rays, Scene, SurfacePoint,
    light::{Bounce, LightChoice, LightTree, Lit, LitSurface, ReceiverBounds},
    random::Item,
};

/// The translucent surfaces of a scene and their light.
pub struct LitScene<'a> {
    surface: LitSurface<'a>,
    bounce: Option<Bounce<'a>>,
}

impl<'a> LitScene<'a> {
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, normals: NormalKind, translucent: impl Fn(u16) -> bool) -> Self {
        let lights = LightTree::new(scene.lights());
        let surface = LitSurface { mesh: &scene.mesh, rays, lights, normals };
        LitScene { surface, bounce: Bounce::new(scene, translucent) }
    }

    fn mesh(&self) -> &Mesh {
        self.surface.mesh
    }
}

/// The near part of the BSSRDF of one material.
pub struct NearField {
    model: Box<dyn Bssrdf>,
    partition: Partition,
    /// The end of the near part, m.
    reach: f64,
    eta: f64,
    material: u16,
    radii: Radii,
    plane: PlaneIntegral,
}

/// Lists that a thread keeps from one point to the next.
#[derive(Debug, Default)]
pub struct Memory {
    hits: Vec<Hit>,
}

/// The work that was done.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Points that were found on the surface.
    pub points: u64,
    pub rays: u64,
}

/// Where light leaves.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub surface: SurfacePoint,
    /// Where the model is evaluated, m.
    pub position: DVec3,
    /// The normal that the model is given.
    pub normal: DVec3,
}

/// The uniform numbers of one try: two for a point of the disc, one for the axis, three for its light.
pub type Numbers = [f64; 6];

/// Tries along the normal, and along each of two directions across it, on average.
const TRIES: [f64; 3] = [1.0, 0.5, 0.5];

/// The light of one point, as it is drawn.
struct Arriving {
    irradiance: DVec3,
    transmittance: f64,
    refracted: DVec3,
}

impl NearField {
    /// The part of a model that lies within `reach` (m) and, beyond `from`, is shared with the far part.
    pub fn new(model: Model, medium: &Medium, material: u16, [from, reach]: [f64; 2]) -> NearField {
        let (partition, eta) = (Partition::new(from, reach), medium.eta);
        let scattering = medium.channels.iter().filter(|c| c.scatters());
        let shortest = scattering.map(|c| 1.0 / c.reduced_extinction()).fold(f64::INFINITY, f64::min);
        let model = model.of(medium);
        let (radii, plane) = Profile { model: &*model, partition, reach, eta }.tabulate(shortest);
        NearField { model, partition, reach, eta, material, radii, plane }
    }

    pub fn partition(&self) -> Partition {
        self.partition
    }

    /// One estimate of the radiance without `T21` that leaves at a place and entered near it, W/(m² sr).
    pub fn light(
        &self,
        scene: &LitScene,
        at: &Place,
        numbers: &Numbers,
        random: Item,
        memory: &mut Memory,
        work: &mut Work,
    ) -> DVec3 {
        let [radius, azimuth, axis, light @ ..] = *numbers;
        let frame = frame(at.normal);
        let mut draw = Draw { near: self, scene, at, frame, light, random, work };
        let ring = (self.radii.sample(radius), std::f64::consts::TAU * azimuth);
        let mut sum = draw.plane(ring);
        // The second try goes across the normal.
        let across = 1 + usize::from(axis >= 0.5);
        for axis in [0, across] {
            sum += draw.along(axis, ring, memory);
        }
        sum
    }
}

/// The normal, and two directions across it.
fn frame(normal: DVec3) -> [DVec3; 3] {
    let (x, y) = normal.any_orthonormal_pair();
    [normal, x, y]
}

/// One try.
struct Draw<'a> {
    near: &'a NearField,
    scene: &'a LitScene<'a>,
    at: &'a Place,
    frame: [DVec3; 3],
    light: [f64; 3],
    random: Item,
    work: &'a mut Work,
}

impl Draw<'_> {
    /// A point of the disc across an axis, relative to the place.
    fn across(&self, axis: usize, (distance, azimuth): (f64, f64)) -> DVec3 {
        let [x, y] = [1, 2].map(|k| self.frame[(axis + k) % 3]);
        let (sine, cosine) = azimuth.sin_cos();
        distance * (cosine * x + sine * y)
    }

    /// The plane through the place in the light of the exitant point: its integral, less its value at the point drawn.
    fn plane(&mut self, ring: (f64, f64)) -> DVec3 {
        let (near, normal) = (self.near, self.at.normal);
        let Some(light) = self.arriving(&SurfacePoint { normal, ..self.at.surface }) else {
            return DVec3::ZERO;
        };
        let offset = -self.across(0, ring);
        let value = near.value(&Separation { offset, normal_in: normal, refracted: light.refracted, normal_out: normal });
        let density = TRIES[0] * near.radii.density(ring.0);
        let integral = near.plane.at(-normal.dot(light.refracted));
        light.irradiance * light.transmittance * (integral - value / density)
    }

    /// The points of the surface that a line along one axis meets.
    fn along(&mut self, axis: usize, ring: (f64, f64), memory: &mut Memory) -> DVec3 {
        let near = self.near;
        let (direction, reach) = (self.frame[axis], near.reach);
        let half = (reach * reach - ring.0 * ring.0).max(0.0).sqrt();
        let start = self.at.position + self.across(axis, ring) + direction * half;
        self.work.rays += 1;
        self.scene.surface.rays.all_within(start, -direction, 2.0 * half, &mut memory.hits);
        let mut sum = DVec3::ZERO;
        for hit in &memory.hits {
            let point = self.scene.mesh().point(hit.triangle, hit.weights, self.scene.surface.normals);
            if point.material == near.material {
                sum += self.point(axis, &point);
            }
        }
        sum
    }

    /// The light that enters at a point, over the density of such points.
    fn point(&mut self, axis: usize, point: &SurfacePoint) -> DVec3 {
        let near = self.near;
        let offset = self.at.position - point.position;
        if offset.length_squared() >= near.reach * near.reach {
            return DVec3::ZERO;
        }
        let Some(light) = self.arriving(point) else {
            return DVec3::ZERO;
        };
        self.work.points += 1;
        // Each point belongs to the axes by fixed shares, nearly to one alone if the surface is nearly across it.
        let facing = |k: usize| self.frame[k].dot(point.geometric_normal).abs();
        let share = facing(axis).powi(4) / (0..3).map(|k| facing(k).powi(4)).sum::<f64>();
        let direction = self.frame[axis];
        let distance = (offset - offset.dot(direction) * direction).length();
        let density = TRIES[axis] * near.radii.density(distance) * facing(axis) / share;
        let Arriving { irradiance, transmittance, refracted } = light;
        let (normal_in, normal_out) = (point.normal, self.at.normal);
        let value = near.value(&Separation { offset, normal_in, refracted, normal_out });
        irradiance * value * (transmittance / density)
    }

    /// The light at a point that the try's numbers pick, if any enters.
    fn arriving(&mut self, point: &SurfacePoint) -> Option<Arriving> {
        let LitScene { surface, bounce } = self.scene;
        let choice = LightChoice::new(&surface.lights, &ReceiverBounds::point(point), NODES);
        let lit = surface.light_at(bounce.as_ref(), &choice, point, self.light, self.random, &mut self.work.rays);
        let Lit::Light { direction, irradiance } = lit else {
            return None;
        };
        let entry = fresnel::enter(point.normal, direction, self.near.eta)?;
        Some(Arriving { irradiance, transmittance: entry.transmittance, refracted: entry.direction })
    }
}

/// Nodes of the list from which the light of a point is picked.
const NODES: usize = 128;

impl NearField {
    fn value(&self, s: &Separation) -> DVec3 {
        let (model, partition, reach, eta) = (&*self.model, self.partition, self.reach, self.eta);
        Profile { model, partition, reach, eta }.near(s)
    }
}
