//! Half-spaces and slabs by the models: plane integrals, in units of the reduced mean free path.

use crate::quadrature::{Annulus, integrate_graded, plane_integral};
use bssrdf::{DVec3, Medium, Model, Separation, fresnel};
use std::f64::consts::PI;

/// A gray medium of reduced albedo `albedo` and unit reduced extinction.
pub fn medium(albedo: f64, eta: f64) -> Medium {
    let (s, a) = (albedo, 1.0 - albedo);
    let json =
        format!(r#"{{"name":"gray","unit":"1/m","sigma_s":[{s},{s},{s}],"sigma_a":[{a},{a},{a}],"g":0,"eta":{eta}}}"#);
    Medium::from_json(&json).expect("a valid medium")
}

/// `T12(θ) ∫ T21 cosθ_o dω_o`: turns `∫ S_bare dA` into a reflectance (docs/method.md sections 2 and 12). The exit
/// integral is the exact one, of which the models' `4π C_φ(1/η)` is a fit.
fn interface(eta: f64, cosine: f64) -> f64 {
    let steps = 4000;
    let exit: f64 = (0..steps)
        .map(|k| {
            let c = (f64::from(k) + 0.5) / f64::from(steps);
            2.0 * PI * fresnel::transmittance(c, eta) * c / f64::from(steps)
        })
        .sum();
    fresnel::transmittance(cosine, eta) * exit
}

/// Share of the light of incidence cosine `cosine` that a model's half-space reflects after scattering.
pub fn reflectance(model: Model, albedo: f64, eta: f64, cosine: f64) -> f64 {
    reflectance_of(model, &medium(albedo, eta), cosine)
}

/// The same of the red channel of a medium with unit reduced extinction.
pub fn reflectance_of(model: Model, medium: &Medium, cosine: f64) -> f64 {
    let (model, eta) = (model.of(medium), medium.eta);
    let sine = (1.0 - cosine * cosine).sqrt() / eta;
    let outer = 40.0 / model.transport()[0].max(4e-5);
    let annulus = Annulus { inner: 1e-7, outer: outer.min(1e6) };
    interface(eta, cosine) * plane_integral(&*model, 0, sine, annulus)
}

/// Share of the light of normal incidence that a slab of `thickness` reduced mean free paths scatters out of its
/// back: the samples lie on the front, the exitant point on the back with the opposite normal.
pub fn transmission(model: Model, albedo: f64, eta: f64, thickness: f64) -> f64 {
    let medium = medium(albedo, eta);
    let model = model.of(&medium);
    let ring = |radius: f64| {
        let separation = Separation {
            offset: DVec3::new(radius, 0.0, -thickness),
            normal_in: DVec3::Z,
            refracted: DVec3::NEG_Z,
            normal_out: DVec3::NEG_Z,
        };
        2.0 * PI * radius * model.bare(0, &separation)
    };
    let outer = (thickness + 40.0 / model.transport()[0].max(1e-3)).min(1e5);
    interface(eta, 1.0) * integrate_graded(1e-4 * thickness, outer, 200, ring)
}
