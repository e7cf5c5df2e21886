//! Lights: what arrives at a point on the surface, by one routine for both phases.

mod area;
mod bounds;
mod choice;
mod cosine_importance;
mod directional;
mod environment;
mod environment_map;
mod hierarchical_sampler;
mod point;
mod receiver;
mod tree;

pub use area::AreaLight;
pub use bounds::LightBounds;
pub use choice::{LightChoice, Pick};
pub use directional::DirectionalLight;
pub use environment::Environment;
pub use environment_map::{EnvironmentMap, MapError};
pub use point::{PointLight, Spot};
pub use receiver::ReceiverBounds;
pub use tree::LightTree;

use crate::{mesh::SurfacePoint, rays::Rays};
use glam::DVec3;
use tree::FEW;

/// Light that reaches a point if nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct Illumination {
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// How far the way must be clear, m; infinite for distant light.
    pub distance: f64,
    /// note: [irradiance] `E = L_i (n·ω)/pdf_solid_angle(ω)`, cosine included, visibility not, W/m².
    pub irradiance: DVec3,
}

/// A source of light.
pub trait Light: Send + Sync {
    /// A number to choose lights by, W/m²: positive wherever the light could reach `at` unshadowed, near the
    /// irradiance there, and 0 only where it certainly cannot.
    fn importance(&self, at: &SurfacePoint) -> f64;

    /// Where the light is and what it can send; none if it is infinitely far away.
    fn bounds(&self) -> Option<LightBounds>;

    /// Light arriving at `at`, from the direction that the uniform numbers `xi` choose; none if it arrives from below
    /// the surface.
    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination>;
}

/// What became of one attempt to light a point.
#[derive(Clone, Copy, Debug)]
pub enum Lit {
    /// Direction towards the light, and irradiance over the light's share of the choice, W/m².
    Light { direction: DVec3, irradiance: DVec3 },
    /// Every light is behind the surface, or out of its cone or range.
    FacingAway,
    /// The chosen light is hidden.
    Shadowed,
}

/// Picks one light by importance, then a direction, and looks whether it is visible (method.md 6.4). Light must come
/// from above the triangle, whatever normal the cosine is taken with. `shadow_rays` counts the rays traced.
pub fn light_at(choice: &LightChoice, rays: &Rays, at: &SurfacePoint, xi: [f64; 3], shadow_rays: &mut u64) -> Lit {
    let Some(Pick { light, share, .. }) = choice.pick(at, xi[0]) else {
        return Lit::FacingAway;
    };
    let Some(arriving) = arriving(light, at, [xi[1], xi[2]]) else {
        return Lit::FacingAway;
    };
    *shadow_rays += 1;
    if !rays.visible(at.position, arriving.direction, arriving.distance, Some(at.triangle)) {
        return Lit::Shadowed;
    }
    Lit::Light { direction: arriving.direction, irradiance: arriving.irradiance / share }
}

/// Entries of the list that lights of one point are picked from.
const PICKED_FROM: usize = 128;

/// Irradiance for surfaces that are lit once a path: from all lights, one direction of each, where there are few, since
/// the choice of one would be noise; else from as many picked ones. `xi` gives two uniform numbers at a time.
pub fn all_light_at(
    lights: &LightTree,
    rays: &Rays,
    at: &SurfacePoint,
    mut xi: impl FnMut() -> [f64; 2],
    shadow_rays: &mut u64,
) -> DVec3 {
    let mut visible = |light: &dyn Light, xi: [f64; 2]| {
        let Some(arriving) = arriving(light, at, xi) else { return DVec3::ZERO };
        *shadow_rays += 1;
        let clear = rays.visible(at.position, arriving.direction, arriving.distance, Some(at.triangle));
        if clear { arriving.irradiance } else { DVec3::ZERO }
    };
    if lights.lights.len() <= FEW {
        return lights.lights.iter().map(|light| visible(&**light, xi())).sum();
    }
    let choice = LightChoice::new(lights, &ReceiverBounds::point(at), PICKED_FROM);
    let [shift, _] = xi();
    let one = |k: usize| {
        let picked = choice.pick(at, (k as f64 + shift) / FEW as f64);
        picked.map_or(DVec3::ZERO, |p| visible(p.light, xi()) / p.share)
    };
    (0..FEW).map(one).sum::<DVec3>() / FEW as f64
}

/// Light from above the triangle.
fn arriving(light: &dyn Light, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
    let arriving = light.illuminate(at, xi)?;
    (arriving.direction.dot(at.geometric_normal) > 0.0 && arriving.irradiance != DVec3::ZERO).then_some(arriving)
}

/// One number for a color, positive wherever a channel is.
pub(crate) fn channel_sum(color: DVec3) -> f64 {
    color.element_sum()
}
