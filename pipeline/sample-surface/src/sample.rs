//! One sample: position, direction to the light, flux.

use crate::pattern::SamplePoint;
use formats::cloud::Sample;
use scene::{
    SurfacePoint, Vec3,
    light::{Bounce, LightChoice, Lit, LitSurface, ReceiverBounds},
};

/// The outcome of one drawn sample.
pub enum SampleOutcome {
    /// A lit sample, and the material it lies on.
    Lit { sample: Sample, material: u16 },
    /// No light can reach it: all are behind the surface, or it is out of their range.
    FacingAway,
    /// The light that was picked is hidden.
    Shadowed,
    /// It is lit, but its flux is 0 in float32.
    Underflow,
    /// No lit opaque surface lies in the direction that was chosen.
    NoBounce,
    /// Its flux is not a finite float32.
    NotFinite,
}

/// The number of nodes in the list of lights that several samples share: a fixed number, and more for each sample.
const SHARED_NODES: [usize; 2] = [32, 4];

/// Lights sample points that lie close together, each given with its half, directly or by one reflection.
/// `shadow_rays` counts the rays traced.
pub fn draw(
    surface: &LitSurface,
    bounce: Option<&Bounce>,
    samples: &[(usize, SamplePoint)],
    shadow_rays: &mut u64,
    mut tell: impl FnMut(usize, SampleOutcome),
) {
    let point = |(_, s): &(usize, SamplePoint)| surface.mesh.point(s.triangle, s.weights, surface.normals);
    let points: Vec<SurfacePoint> = samples.iter().map(point).collect();
    let Some(receiver) = ReceiverBounds::around(&points) else { return };
    let [fixed, per_sample] = SHARED_NODES;
    let choice = LightChoice::new(&surface.lights, &receiver, fixed + per_sample * points.len());
    for ((half, sample), point) in samples.iter().zip(&points) {
        tell(*half, drawn(surface, bounce, sample, point, &choice, shadow_rays));
    }
}

/// Lights one sample: directly or, for a share of the samples where there are opaque surfaces, by one reflection.
fn drawn(
    surface: &LitSurface,
    bounce: Option<&Bounce>,
    sample: &SamplePoint,
    point: &SurfacePoint,
    choice: &LightChoice,
    shadow_rays: &mut u64,
) -> SampleOutcome {
    let (direction, irradiance) =
        match surface.light_at(bounce, choice, point, sample.light, sample.bounce, shadow_rays) {
            Lit::NoBounce => return SampleOutcome::NoBounce,
            Lit::FacingAway => return SampleOutcome::FacingAway,
            Lit::Shadowed => return SampleOutcome::Shadowed,
            Lit::Light { direction, irradiance } => (direction, irradiance),
        };
    // note: [flux] Φ = E/pdf(x); the estimator divides by K (docs/method.md 6.5).
    // A color of -0 would make a flux of -0: adding 0 removes the sign.
    // The light on the bumps of a normal map enters below the smooth surface.
    let gain = point.bump.gain(point.smooth_normal.dot(direction));
    if gain <= 0.0 {
        return SampleOutcome::FacingAway;
    }
    let flux = (irradiance * gain / sample.pdf_area).as_vec3() + Vec3::ZERO;
    if !flux.is_finite() {
        return SampleOutcome::NotFinite;
    }
    if flux == Vec3::ZERO {
        return SampleOutcome::Underflow;
    }
    let sample = Sample { position: point.position.as_vec3(), normal: point.smooth_normal, direction, flux };
    SampleOutcome::Lit { sample, material: point.material }
}
