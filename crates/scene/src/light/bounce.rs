//! The surface that is sampled, and light that reaches it after one reflection by an opaque surface.

use super::{
    choice::LightChoice,
    direct::{Lit, all_light_at, light_at},
    tree::LightTree,
};
use crate::{
    mesh::{Mesh, NormalKind, SurfacePoint},
    random::Item,
    rays::{Hit, Rays},
    scene::Scene,
    warp,
};
use glam::DVec3;

/// The share of samples that are lit this way where there are opaque surfaces. For a head on an evenly lit floor, which
/// gets a third as much light from the floor as from the lamps, the variance is least at 0.27.
const SHARE: f64 = 0.25;

/// A surface and its light.
pub struct LitSurface<'a> {
    pub mesh: &'a Mesh,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub normals: NormalKind,
}

impl LitSurface<'_> {
    /// Lights a point in one of the ways that samples are lit: directly or, for a share of the tries where there are
    /// opaque surfaces, by one reflection. `xi` chooses, `random` lights the surface that reflects, and `rays` counts the
    /// rays traced.
    pub fn light_at(
        &self,
        bounce: Option<&Bounce>,
        choice: &LightChoice,
        at: &SurfacePoint,
        [xi, l1, l2]: [f64; 3],
        random: Item,
        rays: &mut u64,
    ) -> Lit {
        let share = if bounce.is_some() { SHARE } else { 0.0 };
        let (lit, share) = match bounce {
            Some(bounce) if xi < share => (bounce.light_at(self, at, [l1, l2], random, rays), share),
            _ => (light_at(choice, self.rays, at, [(xi - share) / (1.0 - share), l1, l2], rays), 1.0 - share),
        };
        match lit {
            Lit::Light { direction, irradiance } => Lit::Light { direction, irradiance: irradiance / share },
            none => none,
        }
    }
}

/// `π L` of the light that an opaque surface reflects where a ray meets it, or that a thin wall scatters to that side, W/m².
/// The normals of the point are on the side of the ray. Each call of `xi` gives two uniform numbers.
pub fn reflected(
    scene: &Scene,
    lights: &LightTree,
    (rays, hit): (&Rays, &Hit),
    at: &SurfacePoint,
    mut xi: impl FnMut() -> [f64; 2],
    shadow_rays: &mut u64,
) -> DVec3 {
    let Some(wall) = scene.wall(hit.triangle, hit.weights) else {
        return scene.diffuse(hit.triangle, hit.weights) * all_light_at(lights, rays, at, xi, shadow_rays);
    };
    let behind = at.facing(-at.geometric_normal);
    let [front, behind] = [at, &behind].map(|side| all_light_at(lights, rays, side, &mut xi, shadow_rays));
    wall.back * front + wall.through * behind
}

/// The opaque surfaces of a scene.
pub struct Bounce<'a> {
    scene: &'a Scene,
    /// For each material, whether it is opaque and reflects.
    opaque: Vec<bool>,
}

impl<'a> Bounce<'a> {
    /// None if no opaque surface reflects.
    pub fn new(scene: &'a Scene, translucent: impl Fn(u16) -> bool) -> Option<Self> {
        let reflects = |k: usize| {
            let material = &scene.materials[k];
            let is_metal = material.gloss.as_ref().is_some_and(|g| g.metallic == 1.0 && g.texture.is_none());
            (material.base_color.truncate() != DVec3::ZERO && !is_metal) || scene.is_wall(k as u16)
        };
        let diffuse = |k: usize| !translucent(k as u16) && !scene.is_pane(k as u16) && reflects(k);
        let opaque: Vec<bool> = (0..scene.materials.len()).map(diffuse).collect();
        let any = scene.mesh.triangles.iter().any(|t| opaque[t.material as usize]);
        any.then_some(Bounce { scene, opaque })
    }

    /// A cosine-distributed direction, and the irradiance `π L` that the opaque surface there gives, W/m². Its light is
    /// `L = ρ E/π`, since both of its sides are Lambertian, as in phase two; what a glossy surface mirrors is left out.
    fn light_at(&self, surface: &LitSurface, at: &SurfacePoint, xi: [f64; 2], random: Item, rays: &mut u64) -> Lit {
        // The frame is that of the triangle: a scene that is turned as a whole keeps its samples.
        let [a, b, _] = surface.mesh.corners(at.triangle as usize);
        let tangent = (b - a).reject_from_normalized(at.normal).try_normalize();
        let tangent = tangent.unwrap_or_else(|| at.normal.any_orthonormal_vector());
        let direction = warp::cosine_hemisphere_in([tangent, at.normal.cross(tangent), at.normal], xi);
        if direction.dot(at.geometric_normal) <= 0.0 {
            return Lit::NoBounce;
        }
        *rays += 1;
        let Some(hit) = surface.rays.closest(at.position, direction, Some(at.triangle)) else {
            return Lit::NoBounce;
        };
        let point = surface.mesh.point(hit.triangle, hit.weights, surface.normals).facing(-direction);
        if !self.opaque[point.material as usize] {
            return Lit::NoBounce;
        }
        let mut dimension = 0;
        let xi = || {
            dimension += 2;
            [dimension - 2, dimension - 1].map(|d| random.uniform(d))
        };
        let irradiance = reflected(self.scene, &surface.lights, (surface.rays, &hit), &point, xi, rays);
        if irradiance == DVec3::ZERO { Lit::NoBounce } else { Lit::Light { direction, irradiance } }
    }
}
