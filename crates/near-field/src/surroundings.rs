//! The surfaces of a scene around an exitant point, and their light.

use bssrdf::{RoughEntry, fresnel};
use glam::DVec3;
use scene::{
    Hit, NormalKind, Rays, Scene, SurfacePoint,
    light::{Bounce, LightChoice, LightTree, Lit, LitSurface, ReceiverBounds},
    random::Item,
    sequence::turned,
};

/// The translucent surfaces of a scene and their light, as samples are lit.
pub struct Surroundings<'a> {
    pub(crate) scene: &'a Scene,
    surface: LitSurface<'a>,
    bounce: Option<Bounce<'a>>,
    /// How many times the points of one estimate are lit.
    pub(crate) lightings: usize,
}

/// How many times points are lit where lights are wide or opaque surfaces reflect: most of the noise is that of the
/// light. A figure of 0.3 m and the first skin, lit by lamps and sky, then errs by 0.3 times what it does with one, in
/// 1.5 times the time; with sixteen, by 0.2 times in 2.1 times the time.
const LIGHTINGS: usize = 8;

/// The numbers by which points are lit once: the first chooses the light, two its direction, and the item lights what
/// reflects.
pub(crate) struct Lighting {
    light: [f64; 3],
    random: Item,
}

impl<'a> Surroundings<'a> {
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, normals: NormalKind, translucent: impl Fn(u16) -> bool) -> Self {
        let lights = LightTree::new(scene.lights());
        let surface = LitSurface { mesh: &scene.mesh, rays, lights, normals };
        let bounce = Bounce::new(scene, translucent);
        let mut lights = scene.lights();
        let is_sharp = bounce.is_none() && lights.all(|light| light.delta().is_some());
        let lightings = if is_sharp { scene.lights().count().clamp(1, LIGHTINGS) } else { LIGHTINGS };
        Surroundings { scene, surface, bounce, lightings }
    }

    /// The numbers of all lightings, which those of the first are followed by, where a share of the light is seen.
    pub(crate) fn lightings(
        &self,
        share: f64,
        [choice, a, b]: [f64; 3],
        random: Item,
    ) -> impl ExactSizeIterator<Item = Lighting> + use<> {
        let count = ((share * self.lightings as f64).ceil() as usize).clamp(1, self.lightings);
        (0..count).map(move |k| {
            let [a, b] = turned([a, b], k);
            let light = [(choice + k as f64) / count as f64, a, b];
            Lighting { light, random: random.part(k as u64) }
        })
    }

    /// The triangles along a line of this length, m.
    pub(crate) fn along(&self, start: DVec3, direction: DVec3, length: f64, hits: &mut Vec<Hit>) {
        self.surface.rays.all_within(start, direction, length, hits);
    }

    pub(crate) fn point(&self, hit: &Hit) -> SurfacePoint {
        self.surface.mesh.point(hit.triangle, hit.weights, self.surface.normals)
    }
}

/// Light that enters at a point.
pub(crate) struct Arriving {
    /// `T12 E`, W/m².
    pub entering: DVec3,
    /// The unit direction below the surface.
    pub refracted: DVec3,
}

/// Lights several points that lie close together with the same random numbers, so that their light differs by what
/// differs between them alone.
pub(crate) struct Lamp<'a> {
    surroundings: &'a Surroundings<'a>,
    choice: LightChoice<'a, 'a>,
    rays: &'a mut u64,
}

/// Nodes of the list from which the light of the points is picked.
const NODES: usize = 128;

impl<'a> Lamp<'a> {
    /// A lamp for these points; none if there are none.
    pub fn new(surroundings: &'a Surroundings<'a>, points: &[SurfacePoint], rays: &'a mut u64) -> Option<Self> {
        let choice = LightChoice::new(&surroundings.surface.lights, &ReceiverBounds::around(points)?, NODES);
        Some(Lamp { surroundings, choice, rays })
    }

    /// The light that the numbers pick for a point, if any enters a medium of relative index `eta` there, through an
    /// interface that may be rough.
    pub fn light(
        &mut self,
        point: &SurfacePoint,
        (eta, rough): (f64, Option<&RoughEntry>),
        by: &Lighting,
    ) -> Option<Arriving> {
        let Surroundings { surface, bounce, .. } = self.surroundings;
        let lit = surface.light_at(bounce.as_ref(), &self.choice, point, by.light, by.random, self.rays);
        let Lit::Light { direction, irradiance } = lit else {
            return None;
        };
        let entry = fresnel::enter(point.smooth_normal, direction, eta)?;
        let cosine = point.smooth_normal.dot(direction);
        let irradiance = irradiance * point.bump.gain(cosine);
        let share = match rough {
            None => DVec3::splat(entry.transmittance),
            Some(rough) => {
                let gains = rough.gains(cosine as f32).unwrap_or([1.0; 3]);
                DVec3::from_array(gains.map(f64::from)) * f64::from(rough.at(cosine as f32))
            }
        };
        Some(Arriving { entering: irradiance * share, refracted: entry.direction })
    }
}
