//! One sample: position, direction to the light, flux.

use crate::choice::TriangleChoice;
use formats::cloud::Sample;
use scene::{
    NormalKind, Rays, Scene,
    light::{Lit, light_at},
    random::Item,
    warp,
};

/// Dimensions of a sample's random numbers.
mod dimension {
    pub const TRIANGLE: u64 = 0;
    pub const POINT: [u64; 2] = [1, 2];
    pub const LIGHT: [u64; 3] = [3, 4, 5];
}

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

/// Draws a point of the surface and lights it. `shadow_rays` counts the rays traced.
pub fn draw(
    scene: &Scene,
    rays: &Rays,
    choice: &TriangleChoice,
    normals: NormalKind,
    random: Item,
    shadow_rays: &mut u64,
) -> Drawn {
    let (triangle, pdf_area) = choice.choose(random.uniform(dimension::TRIANGLE));
    let weights = warp::triangle(dimension::POINT.map(|d| random.uniform(d)));
    let point = scene.mesh.point(triangle, weights, normals);
    let xi = dimension::LIGHT.map(|d| random.uniform(d));
    let (direction, irradiance) = match light_at(&scene.lights, rays, &point, xi, shadow_rays) {
        Lit::FacingAway => return Drawn::FacingAway,
        Lit::Shadowed => return Drawn::Shadowed,
        Lit::Light { direction, irradiance } => (direction, irradiance),
    };
    // note: [flux] Φ = E/pdf(x); the estimator divides by K (method.md 6.5).
    let flux = (irradiance / pdf_area).as_vec3();
    if !flux.is_finite() {
        return Drawn::NotFinite;
    }
    if flux == scene::Vec3::ZERO {
        return Drawn::Underflow;
    }
    let sample = Sample { position: point.position.as_vec3(), normal: point.normal, direction, flux };
    Drawn::Lit { sample, material: point.material }
}
