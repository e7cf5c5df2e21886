//! Moments of the transmittance of a smooth boundary, by quadrature.

use bsdf::fresnel::transmittance;
use std::f64::consts::PI;

/// Steps of the integrals: they are then good for seven digits.
const STEPS: usize = 2000;

/// `μ_c`: below this cosine light that hits the boundary from inside is totally reflected; 0 if `eta ≤ 1`.
pub fn critical_cosine(eta: f64) -> f64 {
    if eta > 1.0 { ((eta - 1.0) * (eta + 1.0)).sqrt() / eta } else { 0.0 }
}

/// `∫ T f(μ, ν) μ dμ` over the cosines `μ` outside, to which the cosines `ν` inside belong.
fn integral(eta: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    // The rarer side is integrated over: there the cosines run from 0 to 1, and T has no root at an end.
    let rarer = eta.max(1.0 / eta);
    let at = |k: usize| {
        let rare = (k as f64 + 0.5) / STEPS as f64;
        let dense = (1.0 - (1.0 - rare * rare) / (rarer * rarer)).sqrt();
        let (outside, inside) = if eta >= 1.0 { (rare, dense) } else { (dense, rare) };
        transmittance(rare, rarer) * f(outside, inside) * rare
    };
    // μ dμ = η² ν dν
    let measure = if eta >= 1.0 { 1.0 } else { eta * eta };
    measure * (0..STEPS).map(at).sum::<f64>() / STEPS as f64
}

/// `m_k = ∫ T21 μ^{k+1} dω` outside (docs/method.md 15.8).
pub fn exit_moment(k: i32, eta: f64) -> f64 {
    2.0 * PI * integral(eta, |outside, _| outside.powi(k))
}

/// `A = (1 + 3C₂)/(1 − 2C₁)` from the definitions of the moments instead of their fits (docs/method.md 2.7, 15.2).
pub fn reflection(eta: f64) -> f64 {
    let inside = |k: i32| integral(eta, |_, inside| inside.powi(k)) / (eta * eta); // ∫ T ν^{k+1} dν
    (2.0 - 3.0 * inside(1)) / (2.0 * inside(0))
}
