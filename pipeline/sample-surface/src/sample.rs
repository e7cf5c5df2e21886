//! One sample: position, direction to the light, flux.

use crate::pattern::Place;
use formats::cloud::Sample;
use scene::{
    NormalKind, Rays, Scene,
    light::{Lit, light_at},
};

/// What became of a drawn sample.
pub enum Drawn {
    /// A lit sample, and the material it lies on.
    Lit { sample: Sample, material: u16 },
    /// No light can reach it: all are behind the surface, or out of range.
    FacingAway,
    /// The light that was picked is hidden.
    Shadowed,
    /// It is lit, but its flux vanishes in float32.
    Underflow,
    /// Its flux is not a finite float32.
    NotFinite,
}

/// Lights a place of the surface. `shadow_rays` counts the rays traced.
pub fn draw(scene: &Scene, rays: &Rays, normals: NormalKind, place: &Place, shadow_rays: &mut u64) -> Drawn {
    let point = scene.mesh.point(place.triangle, place.weights, normals);
    let (direction, irradiance) = match light_at(&scene.lights, rays, &point, place.light, shadow_rays) {
        Lit::FacingAway => return Drawn::FacingAway,
        Lit::Shadowed => return Drawn::Shadowed,
        Lit::Light { direction, irradiance } => (direction, irradiance),
    };
    // note: [flux] Φ = E/pdf(x); the estimator divides by K (method.md 6.5).
    let flux = (irradiance / place.pdf_area).as_vec3();
    if !flux.is_finite() {
        return Drawn::NotFinite;
    }
    if flux == scene::Vec3::ZERO {
        return Drawn::Underflow;
    }
    let sample = Sample { position: point.position.as_vec3(), normal: point.normal, direction, flux };
    Drawn::Lit { sample, material: point.material }
}
