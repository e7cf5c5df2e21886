//! The surfaces of a scene around an exitant point, and their light.

use bssrdf::fresnel;
use glam::DVec3;
use scene::{
    Hit, NormalKind, Rays, Scene, SurfacePoint,
    light::{Bounce, LightChoice, LightTree, Lit, LitSurface, ReceiverBounds},
    random::Item,
};

/// The translucent surfaces of a scene and their light, as samples are lit.
pub struct Surroundings<'a> {
    pub(crate) scene: &'a Scene,
    surface: LitSurface<'a>,
    bounce: Option<Bounce<'a>>,
}

impl<'a> Surroundings<'a> {
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, normals: NormalKind, translucent: impl Fn(u16) -> bool) -> Self {
        let lights = LightTree::new(scene.lights());
        let surface = LitSurface { mesh: &scene.mesh, rays, lights, normals };
        Surroundings { scene, surface, bounce: Bounce::new(scene, translucent) }
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
    light: [f64; 3],
    random: Item,
    rays: &'a mut u64,
}

/// Nodes of the list from which the light of the points is picked.
const NODES: usize = 128;

impl<'a> Lamp<'a> {
    /// A lamp for these points; none if there are none.
    pub fn new(
        surroundings: &'a Surroundings<'a>,
        points: &[SurfacePoint],
        (light, random): ([f64; 3], Item),
        rays: &'a mut u64,
    ) -> Option<Self> {
        let choice = LightChoice::new(&surroundings.surface.lights, &ReceiverBounds::around(points)?, NODES);
        Some(Lamp { surroundings, choice, light, random, rays })
    }

    /// The light that the numbers pick for a point, if any enters a medium of relative index `eta` there.
    pub fn light(&mut self, point: &SurfacePoint, eta: f64) -> Option<Arriving> {
        let Surroundings { surface, bounce, .. } = self.surroundings;
        let lit = surface.light_at(bounce.as_ref(), &self.choice, point, self.light, self.random, self.rays);
        let Lit::Light { direction, irradiance } = lit else {
            return None;
        };
        let entry = fresnel::enter(point.smooth_normal, direction, eta)?;
        let irradiance = irradiance * point.bump.gain(point.smooth_normal.dot(direction));
        Some(Arriving { entering: irradiance * entry.transmittance, refracted: entry.direction })
    }
}
