//! The surface that is sampled, and light that reaches it after one reflection by an opaque surface.

use scene::{
    DVec3, Mesh, NormalKind, Rays, Scene, SurfacePoint,
    light::{LightTree, all_light_at},
    random::Item,
    warp,
};

/// The share of samples that are lit this way where there are opaque surfaces. For a head on an evenly lit floor, which
/// gets a third as much light from the floor as from the lamps, the variance is least at 0.27.
pub const SHARE: f64 = 0.25;

/// A surface and its light.
pub struct LitSurface<'a> {
    pub mesh: &'a Mesh,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub normals: NormalKind,
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
        let reflects = |k: usize| scene.materials[k].base_color.truncate() != DVec3::ZERO;
        let opaque: Vec<bool> = (0..scene.materials.len()).map(|k| !translucent(k as u16) && reflects(k)).collect();
        let any = scene.mesh.triangles.iter().any(|t| opaque[t.material as usize]);
        any.then_some(Bounce { scene, opaque })
    }

    /// A cosine-distributed direction, and the irradiance `π L` that the opaque surface there gives, W/m². Its light is
    /// `L = ρ E/π`, since both of its sides are Lambertian, as in phase two. None if there is no such light.
    pub fn light_at(
        &self,
        surface: &LitSurface,
        at: &SurfacePoint,
        xi: [f64; 2],
        random: Item,
        rays: &mut u64,
    ) -> Option<(DVec3, DVec3)> {
        // The frame is that of the triangle: a scene that is turned as a whole keeps its samples.
        let [a, b, _] = surface.mesh.corners(at.triangle as usize);
        let tangent = (b - a).reject_from_normalized(at.normal).try_normalize();
        let tangent = tangent.unwrap_or_else(|| at.normal.any_orthonormal_vector());
        let direction = warp::cosine_hemisphere_in([tangent, at.normal.cross(tangent), at.normal], xi);
        if direction.dot(at.geometric_normal) <= 0.0 {
            return None;
        }
        *rays += 1;
        let hit = surface.rays.closest(at.position, direction, Some(at.triangle))?;
        let point = surface.mesh.point(hit.triangle, hit.weights, surface.normals).facing(-direction);
        if !self.opaque[point.material as usize] {
            return None;
        }
        let albedo = self.scene.color(hit.triangle, hit.weights).truncate();
        let mut dimension = 0;
        let xi = || {
            dimension += 2;
            [dimension - 2, dimension - 1].map(|d| random.uniform(d))
        };
        let irradiance = albedo * all_light_at(&surface.lights, surface.rays, &point, xi, rays);
        (irradiance != DVec3::ZERO).then_some((direction, irradiance))
    }
}
