//! Integrals over the plane: tabulated ones, and the closed forms of the total diffuse reflectance.

use bssrdf::{Medium, Model};
use serde_json::Value;
use std::f64::consts::PI;
use test_support::{
    pipeline::gray,
    quadrature::{Annulus, plane_integral},
};

/// Limits that are good for five digits: S is constant within 10⁻⁴ mean free paths, and the part beyond is e^{−40}
/// or, without absorption, the tail of r⁻³.
fn annulus(medium: &Medium) -> Annulus {
    let c = medium.channels[0];
    let (path, transport) = (1.0 / c.reduced_extinction(), c.transport().min(c.grosjean_transport()));
    let outer = if transport > 0.0 { 40.0 / transport + 10.0 * path } else { 1e9 * path };
    Annulus { inner: 1e-6 * path, outer }
}

struct ReferenceValue {
    name: String,
    medium: Medium,
    /// `I` of each model at 0° and, if tabulated, 60°.
    integrals: Vec<(Model, f64, f64)>,
    /// `∫ R_d 2πr dr` of the standard and the better dipole.
    reflectances: [f64; 2],
}

fn entries() -> Vec<ReferenceValue> {
    let file: Value =
        serde_json::from_str(include_str!("../reference/plane_reflectance.json")).expect("the reference file is JSON");
    let read = |entry: &Value| {
        let number = |value: &Value| value.as_f64().expect("a number");
        let coefficient = |key: &str| number(&entry[key]);
        let tabulated = |name: &str, key: &str| number(&entry[name][key]);
        ReferenceValue {
            name: format!("{} {}", entry["material"], entry["channel"]),
            medium: gray(coefficient("sigma_a"), coefficient("sigma_s"), coefficient("g"), coefficient("eta")),
            integrals: vec![
                (Model::StandardDipole, 0.0, tabulated("standard", "I_0deg")),
                (Model::StandardDipole, 60.0, tabulated("standard", "I_0deg")),
                (Model::BetterDipole, 0.0, tabulated("better", "I_0deg")),
                (Model::BetterDipole, 60.0, tabulated("better", "I_0deg")),
                (Model::DirectionalDipole, 0.0, tabulated("directional", "I_0deg")),
                (Model::DirectionalDipole, 60.0, tabulated("directional", "I_60deg")),
            ],
            reflectances: ["standard", "better"].map(|name| tabulated(name, "closed_form_Rd")),
        }
    };
    file["entries"].as_array().expect("a list").iter().map(read).collect()
}

/// The table claims five digits and has nine; for the radially symmetric models the integral does not depend on the
/// angle.
#[test]
fn plane_integrals_agree_with_the_table() {
    let mut worst = 0.0f64;
    for entry in entries() {
        for (model, degrees, expected) in &entry.integrals {
            let sine = f64::sin(f64::to_radians(*degrees)) / entry.medium.eta;
            let value = plane_integral(&*model.of(&entry.medium), 0, sine, annulus(&entry.medium));
            let error = (value / expected - 1.0).abs();
            assert!(error < 1e-7, "{} {} {degrees}°: {value} for {expected}", entry.name, model.name());
            worst = worst.max(error);
        }
    }
    println!("worst relative error {worst:.1e}");
}

/// Equation (3.5).
fn standard_closed_form(medium: &Medium) -> f64 {
    let albedo = medium.channels[0].reduced_albedo();
    let q = (3.0 * (1.0 - albedo)).sqrt();
    albedo / 2.0 * (1.0 + (-4.0 / 3.0 * medium.interface.reflection_egan * q).exp()) * (-q).exp()
}

/// Equation (4.4), with its limit for σ_a = 0.
fn better_closed_form(medium: &Medium) -> f64 {
    let (c, boundary) = (medium.channels[0], medium.interface);
    let (diffusion, transport) = (c.grosjean_diffusion(), c.grosjean_transport());
    let real = 1.0 / c.reduced_extinction();
    let depths = [real, real + 4.0 * boundary.reflection * diffusion];
    let [e_real, e_virtual] = depths.map(|z| (-transport * z).exp());
    let fluence = if transport == 0.0 { depths[1] - depths[0] } else { (e_real - e_virtual) / transport };
    c.reduced_albedo().powi(2) / 2.0 * (boundary.c_e * (e_real + e_virtual) + boundary.c_phi / diffusion * fluence)
}

#[test]
fn total_reflectance_has_its_closed_form() {
    let entries = entries();
    for entry in &entries {
        let closed = [standard_closed_form(&entry.medium), better_closed_form(&entry.medium)];
        for (value, expected) in closed.into_iter().zip(entry.reflectances) {
            assert!((value / expected - 1.0).abs() < 1e-12, "{}: {value} for {expected}", entry.name);
        }
    }
    let conservative = [gray(0.0, 2.0, 0.0, 1.3), gray(0.0, 50.0, 0.9, 1.5), gray(3.0, 7.0, 0.3, 0.8)];
    let mut worst = 0.0f64;
    for medium in entries.iter().map(|e| &e.medium).chain(&conservative) {
        // R_d = π S_bare (3.6), R_d = 4π C_φ(1/η) S_bare (4.5).
        let standard = PI * plane_integral(&*Model::StandardDipole.of(medium), 0, 0.0, annulus(medium));
        let better =
            PI * medium.interface.exit_norm * plane_integral(&*Model::BetterDipole.of(medium), 0, 0.0, annulus(medium));
        for (value, expected) in [(standard, standard_closed_form(medium)), (better, better_closed_form(medium))] {
            worst = worst.max((value - expected).abs());
            assert!((value - expected).abs() < 1e-6, "{:?}: {value} for {expected}", medium.channels[0]);
        }
    }
    println!("worst error {worst:.1e}");
}

/// Without absorption the surface returns what enters, up to the exit normalization that the model lacks.
#[test]
fn the_standard_dipole_of_a_white_medium_reflects_everything() {
    assert!((standard_closed_form(&gray(0.0, 5.0, 0.0, 1.3)) - 1.0).abs() < 1e-15);
}
