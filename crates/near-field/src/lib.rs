//! The light that enters close to an exitant point, closer than the samples of a cloud lie to each other: points are
//! drawn around the exitant point and lit as samples are (docs/method.md section 17).
//!
//! Around most points the surface is nearly a plane in even light. A plane through the exitant point in its light is a
//! control variate, whose integral is known: what is left to chance is what curvature and shadows change.

mod profile;
mod surroundings;

pub use surroundings::Surroundings;

use bssrdf::{Bssrdf, Medium, Model, Partition, RoughEntry, Separation};
use formats::cloud::{Cloud, shards};
use glam::DVec3;
use profile::{PlaneIntegral, Profile, Radii};
use scene::{Hit, SurfacePoint, random::Item};
use std::f64::consts::TAU;
use surroundings::{Arriving, Lamp};
use tint::Tint;

/// The near part of the BSSRDF of one material.
pub struct NearField {
    model: Box<dyn Bssrdf>,
    partition: Partition,
    /// The end of the near part, m.
    reach: f64,
    eta: f64,
    material: u16,
    /// The texture of the material, if it tints the medium.
    tint: Option<Tint>,
    radii: Radii,
    plane: PlaneIntegral,
    /// What enters through a rough interface.
    rough: Option<RoughEntry>,
}

/// Where light leaves.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub surface: SurfacePoint,
    /// Where the model is evaluated, m.
    pub position: DVec3,
    /// The normal that the model is given, without normal maps.
    pub normal: DVec3,
    /// The factor of light that enters there, by its texture.
    pub crossing: DVec3,
}

/// The uniform numbers of one estimate: two for a point of a disc, one that chooses an axis, three for the light.
pub type Numbers = [f64; 6];

/// Lists that a thread keeps from one estimate to the next, and the work that it has done.
#[derive(Debug, Default)]
pub struct Scratch {
    hits: Vec<Hit>,
    found: Found,
    pub work: Work,
}

/// Points that are lit together.
#[derive(Debug, Default)]
struct Found {
    /// The exitant point, and those around it.
    points: Vec<SurfacePoint>,
    /// The axis along which each of the latter was found.
    axes: Vec<usize>,
    /// The factors of light that enters there; none without a texture.
    crossings: Vec<DVec3>,
}

/// The work that was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Points that were lit.
    pub points: u64,
    /// Rays that were traced.
    pub rays: u64,
}

/// Where the step between the near and the far part begins and ends, in mean distances between samples. With these, the
/// error of a bunny of marble is least where samples lie 0.5 and 5 mean free paths apart, and nearly so at 50.
const STEP: [f64; 2] = [1.0, 3.0];

/// Samples that are closer than this many reduced mean free paths resolve any model: none varies within less than 0.07
/// (docs/method.md 15.12).
const RESOLVED: f64 = 0.05;

/// Lines along the normal, and along each of two directions across it on average.
const LINES: [f64; 3] = [1.0, 0.5, 0.5];

impl NearField {
    /// The near part of the model for the sampled material `slot`; none if the samples resolve the model, or the medium
    /// does not scatter.
    pub fn of_clouds(model: Model, medium: &Medium, clouds: &[Cloud], slot: usize) -> Option<NearField> {
        let materials = shards::materials(clouds);
        let area: f64 = materials.iter().map(|m| m.area_m2).sum();
        let spacing = (area / shards::drawn(clouds).max(1) as f64).sqrt();
        let needed = spacing.is_finite() && spacing > RESOLVED * shortest(medium) && !medium.is_clear();
        needed.then(|| NearField::new(model, medium, materials[slot].index, STEP.map(|x| x * spacing)))
    }

    /// The part of a model that lies within `reach` (m) and, beyond `from`, is shared with the far part.
    pub fn new(model: Model, medium: &Medium, material: u16, [from, reach]: [f64; 2]) -> NearField {
        let (partition, eta) = (Partition::new(from, reach), medium.eta);
        let model = model.of(medium);
        let (radii, plane) = Profile { model: &*model, partition, reach, eta }.tabulate(shortest(medium));
        NearField { model, partition, reach, eta, material, tint: None, radii, plane, rough: None }
    }

    /// The same near part behind an interface that may be rough.
    pub fn behind(self, rough: Option<&RoughEntry>) -> NearField {
        NearField { rough: rough.cloned(), ..self }
    }

    /// The same below a texture.
    pub fn tinted(self, tint: Option<Tint>) -> NearField {
        NearField { tint, ..self }
    }

    /// Where the far part begins, which the cloud's samples are left with.
    pub fn partition(&self) -> Partition {
        self.partition
    }

    /// One estimate of the radiance without `T21` that leaves at a place and entered near it, W/(m² sr) (docs/method.md
    /// 17.3), of which a `share` is seen: the less, the fewer times the points are lit. `random` lights what reflects light
    /// to the points.
    pub fn light(
        &self,
        surroundings: &Surroundings,
        (at, share): (&Place, f64),
        numbers: &Numbers,
        random: Item,
        scratch: &mut Scratch,
    ) -> DVec3 {
        let [radius, azimuth, axis, light @ ..] = *numbers;
        let (x, y) = at.normal.any_orthonormal_pair();
        let around = Around { near: self, at, frame: [at.normal, x, y] };
        let drawn = (self.radii.sample(radius), TAU * azimuth);
        let Scratch { hits, found, work } = scratch;
        let exitant = SurfacePoint { smooth_normal: at.normal, ..at.surface }.smoothed();
        found.axes.clear();
        found.crossings.clear();
        found.points.clear();
        found.points.push(exitant);
        for axis in [0, 1 + usize::from(axis >= 0.5)] {
            around.find(axis, drawn, surroundings, hits, found);
        }
        work.rays += 2;
        work.points += found.axes.len() as u64;
        let Some(mut lamp) = Lamp::new(surroundings, &found.points, &mut work.rays) else {
            return DVec3::ZERO;
        };
        let interface = (self.eta, self.rough.as_ref());
        let mut sum = DVec3::ZERO;
        let lightings = surroundings.lightings(share, light, random);
        let count = lightings.len() as f64;
        for numbers in lightings {
            let mut lit = |point: &SurfacePoint| lamp.light(point, interface, &numbers);
            let mut plane = lit(&exitant).map_or(DVec3::ZERO, |light| around.plane(drawn, &light));
            if self.tint.is_some() {
                plane *= at.crossing;
            }
            sum += plane;
            for (k, (axis, point)) in found.axes.iter().zip(&found.points[1..]).enumerate() {
                let light = lit(point).map_or(DVec3::ZERO, |light| around.point(*axis, point, &light));
                sum += found.crossings.get(k).map_or(light, |crossing| light * *crossing);
            }
        }
        sum / count
    }

    /// `(1 − w) S_bare` of the channels, 1/(m² sr).
    fn value(&self, s: &Separation) -> DVec3 {
        let (model, partition, reach, eta) = (&*self.model, self.partition, self.reach, self.eta);
        Profile { model, partition, reach, eta }.near(s)
    }
}

/// The shortest reduced mean free path, m.
fn shortest(medium: &Medium) -> f64 {
    let scattering = medium.channels.iter().filter(|c| c.scatters());
    scattering.map(|c| 1.0 / c.reduced_extinction()).fold(f64::INFINITY, f64::min)
}

/// The surface around a place, along the normal and across it.
struct Around<'a> {
    near: &'a NearField,
    at: &'a Place,
    frame: [DVec3; 3],
}

impl Around<'_> {
    /// The point of the disc across an axis, at this distance and azimuth from the place.
    fn on_disc(&self, axis: usize, (distance, azimuth): (f64, f64)) -> DVec3 {
        let [x, y] = [1, 2].map(|k| self.frame[(axis + k) % 3]);
        let (sine, cosine) = azimuth.sin_cos();
        distance * (cosine * x + sine * y)
    }

    /// Finds the points of the surface on a line along one axis, inside the ball of the near part.
    fn find(
        &self,
        axis: usize,
        drawn: (f64, f64),
        surroundings: &Surroundings,
        hits: &mut Vec<Hit>,
        found: &mut Found,
    ) {
        let (near, direction) = (self.near, self.frame[axis]);
        let half = (near.reach * near.reach - drawn.0 * drawn.0).max(0.0).sqrt();
        let start = self.at.position + self.on_disc(axis, drawn) + direction * half;
        surroundings.along(start, -direction, 2.0 * half, hits);
        let own = hits.iter().map(|hit| surroundings.point(hit)).filter(|point| point.material == near.material);
        found.points.extend(own);
        if let Some(tint) = &near.tint {
            let scene = surroundings.scene;
            let own = hits.iter().filter(|hit| scene.mesh.triangles[hit.triangle as usize].material == near.material);
            found.crossings.extend(own.map(|hit| tint.entering(&scene.texture_color(hit.triangle, hit.weights))));
        }
        found.axes.resize(found.points.len() - 1, axis);
    }

    /// The plane through the place in the light of the exitant point: its integral, less the value at the point drawn.
    fn plane(&self, drawn: (f64, f64), light: &Arriving) -> DVec3 {
        let (near, normal, refracted) = (self.near, self.at.normal, light.refracted);
        let Some(integral) = near.plane.at(-normal.dot(refracted)) else {
            // The plane is left out by the direction of the light alone, which is as right as with it.
            return DVec3::ZERO;
        };
        let offset = -self.on_disc(0, drawn);
        let value = near.value(&Separation { offset, normal_in: normal, refracted, normal_out: normal });
        let density = LINES[0] * near.radii.density(drawn.0);
        light.entering * (integral - value / density)
    }

    /// The light that enters at a point and leaves at the place, over the density of such points. Each point belongs to
    /// the three axes by fixed shares, nearly to one alone where the surface is nearly across it.
    fn point(&self, axis: usize, point: &SurfacePoint, light: &Arriving) -> DVec3 {
        let (near, direction) = (self.near, self.frame[axis]);
        let offset = self.at.position - point.position;
        let facing = |k: usize| self.frame[k].dot(point.geometric_normal).abs();
        let share = facing(axis).powi(4) / (0..3).map(|k| facing(k).powi(4)).sum::<f64>();
        let distance = (offset - offset.dot(direction) * direction).length();
        let density = LINES[axis] * near.radii.density(distance) * facing(axis);
        if density <= 0.0 {
            // A line along the surface, or rounding at the end of the near part, where its value is 0.
            return DVec3::ZERO;
        }
        let (normal_in, normal_out) = (point.smooth_normal, self.at.normal);
        let value = near.value(&Separation { offset, normal_in, refracted: light.refracted, normal_out });
        light.entering * value * (share / density)
    }
}
