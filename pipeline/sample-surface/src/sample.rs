//! One sample: position, direction to the light, flux.

use crate::{
    bounce::{Bounce, SHARE},
    pattern::Place,
};
use formats::cloud::Sample;
use scene::{
    Mesh, NormalKind, Rays, SurfacePoint,
    light::{LightChoice, LightTree, Lit, ReceiverBounds, light_at},
};

/// A surface and its light.
pub struct LitSurface<'a> {
    pub mesh: &'a Mesh,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub normals: NormalKind,
    /// What else is lit and lights it.
    pub bounce: Option<Bounce<'a>>,
}

/// What became of a drawn sample.
pub enum SampleOutcome {
    /// A lit sample, and the material it lies on.
    Lit { sample: Sample, material: u16 },
    /// No light can reach it: all are behind the surface, or out of range.
    FacingAway,
    /// The light that was picked is hidden.
    Shadowed,
    /// It is lit, but its flux vanishes in float32.
    Underflow,
    /// No lit opaque surface lies in the direction that was chosen.
    NoBounce,
    /// Its flux is not a finite float32.
    NotFinite,
}

/// Entries of the list of lights that places share: some, and more for each of them.
const ENTRIES: [usize; 2] = [32, 4];

/// Lights places of the surface that lie together, each with the half that it belongs to. `shadow_rays` counts the rays
/// traced.
pub fn draw(
    surface: &LitSurface,
    places: &[(usize, Place)],
    shadow_rays: &mut u64,
    mut tell: impl FnMut(usize, SampleOutcome),
) {
    let point = |(_, p): &(usize, Place)| surface.mesh.point(p.triangle, p.weights, surface.normals);
    let points: Vec<SurfacePoint> = places.iter().map(point).collect();
    let Some(region) = ReceiverBounds::around(&points) else { return };
    let choice = LightChoice::new(&surface.lights, &region, ENTRIES[0] + ENTRIES[1] * points.len());
    for ((half, place), point) in places.iter().zip(&points) {
        tell(*half, drawn(surface, place, point, &choice, shadow_rays));
    }
}

/// The sample at a place: lit directly or, where there are opaque surfaces, by way of one.
fn drawn(
    surface: &LitSurface,
    place: &Place,
    point: &SurfacePoint,
    choice: &LightChoice,
    shadow_rays: &mut u64,
) -> SampleOutcome {
    let [xi, l1, l2] = place.light;
    let share = if surface.bounce.is_some() { SHARE } else { 0.0 };
    let (direction, irradiance) = match &surface.bounce {
        Some(bounce) if xi < share => match bounce.light_at(surface, point, [l1, l2], place.bounce, shadow_rays) {
            None => return SampleOutcome::NoBounce,
            Some((direction, irradiance)) => (direction, irradiance / share),
        },
        _ => match light_at(choice, surface.rays, point, [(xi - share) / (1.0 - share), l1, l2], shadow_rays) {
            Lit::FacingAway => return SampleOutcome::FacingAway,
            Lit::Shadowed => return SampleOutcome::Shadowed,
            Lit::Light { direction, irradiance } => (direction, irradiance / (1.0 - share)),
        },
    };
    // note: [flux] Φ = E/pdf(x); the estimator divides by K (method.md 6.5).
    // Of a color of -0 it would be -0; a cloud has no negative flux.
    let flux = (irradiance / place.pdf_area).as_vec3() + scene::Vec3::ZERO;
    if !flux.is_finite() {
        return SampleOutcome::NotFinite;
    }
    if flux == scene::Vec3::ZERO {
        return SampleOutcome::Underflow;
    }
    let sample = Sample { position: point.position.as_vec3(), normal: point.normal, direction, flux };
    SampleOutcome::Lit { sample, material: point.material }
}
