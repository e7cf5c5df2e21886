//! Lights: what arrives at a point on the surface, by one routine for both phases.

mod area;
mod directional;
mod environment;
mod environment_map;
mod lookout;
mod point;
mod pyramid;

pub use area::AreaLight;
pub use directional::DirectionalLight;
pub use environment::Environment;
pub use environment_map::{EnvironmentMap, MapError};
pub use point::{PointLight, Spot};

use crate::{mesh::SurfacePoint, rays::Rays};
use glam::DVec3;

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

    /// Light arriving at `at`, from the direction that the uniform numbers `xi` choose; none if it arrives from below
    /// the surface.
    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination>;
}

/// What became of one attempt to light a point.
#[derive(Clone, Copy, Debug)]
pub enum Lit {
    /// Direction towards the light, and irradiance over the probability of the light's choice, W/m².
    Light { direction: DVec3, irradiance: DVec3 },
    /// Every light is behind the surface, or out of its cone or range.
    FacingAway,
    /// The chosen light is hidden.
    Shadowed,
}

/// Picks one light by importance, then a direction, and looks whether it is visible (method.md 6.4). Light must come
/// from above the triangle, whatever normal the cosine is taken with. `shadow_rays` counts the rays traced.
pub fn light_at(lights: &[Box<dyn Light>], rays: &Rays, at: &SurfacePoint, xi: [f64; 3], shadow_rays: &mut u64) -> Lit {
    let Some((index, probability)) = pick(lights, at, xi[0]) else {
        return Lit::FacingAway;
    };
    let Some(arriving) = lights[index].illuminate(at, [xi[1], xi[2]]) else {
        return Lit::FacingAway;
    };
    if arriving.direction.dot(at.geometric_normal) <= 0.0 || arriving.irradiance == DVec3::ZERO {
        return Lit::FacingAway;
    }
    *shadow_rays += 1;
    if !rays.visible(at.position, arriving.direction, arriving.distance, Some(at.triangle)) {
        return Lit::Shadowed;
    }
    Lit::Light { direction: arriving.direction, irradiance: arriving.irradiance / probability }
}

/// Irradiance from all lights, one direction of each: for surfaces that are lit once a path, where the choice of a light
/// would be noise. `xi` gives two uniform numbers for each light.
pub fn all_light_at(
    lights: &[Box<dyn Light>],
    rays: &Rays,
    at: &SurfacePoint,
    mut xi: impl FnMut() -> [f64; 2],
    shadow_rays: &mut u64,
) -> DVec3 {
    let mut irradiance = DVec3::ZERO;
    for light in lights {
        let Some(arriving) = light.illuminate(at, xi()) else { continue };
        if arriving.direction.dot(at.geometric_normal) <= 0.0 {
            continue;
        }
        *shadow_rays += 1;
        if rays.visible(at.position, arriving.direction, arriving.distance, Some(at.triangle)) {
            irradiance += arriving.irradiance;
        }
    }
    irradiance
}

/// A light and the probability of having been picked, in proportion to its importance; none if all are zero.
pub fn pick(lights: &[Box<dyn Light>], at: &SurfacePoint, xi: f64) -> Option<(usize, f64)> {
    let total: f64 = lights.iter().map(|l| l.importance(at)).sum();
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let mut left = xi * total;
    let mut last = None;
    for (index, light) in lights.iter().enumerate() {
        let importance = light.importance(at);
        if importance > 0.0 {
            last = Some((index, importance / total));
            if left < importance {
                break;
            }
            left -= importance;
        }
    }
    last
}

/// One number for a colour, positive wherever a channel is.
pub(crate) fn strength(color: DVec3) -> f64 {
    color.element_sum()
}
