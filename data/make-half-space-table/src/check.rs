//! The model with its table against the exact reflectances, between the places that are tabulated.

use crate::reflectance::Exact;
use bssrdf::{Bssrdf, Coefficients, DVec3, Interface, Medium, Model, Separation, built_in, built_in_names, fresnel};
use std::f64::consts::{LN_2, PI, TAU};

fn gray(absorbed: f64, eta: f64) -> Medium {
    let channels = [Coefficients { sigma_a: absorbed, sigma_s: 1.0 - absorbed, asymmetry: 0.0 }; 3];
    Medium { name: "gray".into(), source: String::new(), channels, eta, interface: Interface::new(eta) }
}

/// `∫ T21 μ dω`.
fn exit_moment(eta: f64) -> f64 {
    let steps = 4000;
    let cosine = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
    (0..steps).map(|k| TAU * fresnel::transmittance(cosine(k), eta) * cosine(k) / f64::from(steps)).sum()
}

/// The share of the light that entered at `refracted` which a half-space with `σ_t' = 1/m` reflects, by the model.
fn modelled(model: &dyn Bssrdf, eta: f64, refracted: DVec3) -> f64 {
    const AZIMUTHS: usize = 64;
    const RINGS_PER_OCTAVE: f64 = 16.0;
    let far = 40.0 / model.transport()[0].max(4e-5);
    let rings = ((far / 1e-5).log2() * RINGS_PER_OCTAVE) as usize;
    let at = |ring: usize, azimuth: usize| {
        let r = 1e-5 * (ring as f64 / RINGS_PER_OCTAVE).exp2();
        let (y, x) = (PI * (azimuth as f64 + 0.5) / AZIMUTHS as f64).sin_cos();
        let offset = DVec3::new(x, y, 0.0) * r;
        let s = Separation { offset, normal_in: DVec3::Z, refracted, normal_out: DVec3::Z };
        model.bare(0, &s) * TAU * r * r * LN_2 / RINGS_PER_OCTAVE / AZIMUTHS as f64
    };
    let sum: f64 = (0..rings).flat_map(|ring| (0..AZIMUTHS).map(move |k| at(ring, k))).sum();
    sum * exit_moment(eta)
}

/// The relative error of the reflectance of one medium, and the exact one, for light of this cosine outside.
fn error(absorbed: f64, eta: f64, cosine: f64) -> Option<(f64, f64)> {
    let light = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let entry = fresnel::enter(DVec3::Z, light, eta)?;
    let value = modelled(&*Model::HalfSpace.of(&gray(absorbed, eta)), eta, entry.direction);
    let exact = (1.0 - absorbed) * Exact::new(absorbed, eta).leaving(-entry.direction.z).reflectance;
    Some((value / exact - 1.0, exact * entry.transmittance))
}

fn degrees(angle: f64) -> f64 {
    angle.to_radians().cos()
}

/// The target is 2 %, or 10⁻⁴ of the light.
///
/// Seen to catch: α' left out of the prefactor; the neighbor of the right index; `μ12` for `m`.
#[test]
fn reflectances_of_built_in_media_are_exact() {
    let mut worst = (0.0f64, String::new());
    for name in built_in_names() {
        let medium = built_in(name).expect("a medium");
        for (k, c) in medium.channels.iter().enumerate().filter(|(_, c)| c.scatters()) {
            for angle in [0.0, 45.0, 75.0] {
                let absorbed = c.sigma_a / c.reduced_extinction();
                let (error, reflectance) = error(absorbed, medium.eta, degrees(angle)).expect("light enters");
                let share = error.abs().min(error.abs() * reflectance / 1e-4 * 0.02);
                if share > worst.0 {
                    worst = (share, format!("{name} {k} {angle}°: {error:.4} of {reflectance:.5}"));
                }
            }
        }
    }
    println!("{}", worst.1);
    assert!(worst.0 < 0.02, "{}", worst.1);
}

/// Within 2 % or 1.2·10⁻⁴ of the light for any index, albedo and angle, and within 0.2 % of all light where nothing is
/// absorbed, but for grazing light of an index near 1.
///
/// Seen to catch: nodes of the index on the other side of 1; the carrier's κ of a neighbor.
#[test]
fn reflectances_between_the_places_of_the_table_are_exact() {
    for eta in [0.41, 0.55, 0.85, 0.98, 1.0, 1.01, 1.04, 1.1, 1.18, 1.3, 1.36, 1.6, 2.0, 2.4] {
        for albedo in [1.0, 0.9999, 0.999, 0.993, 0.96, 0.85, 0.7, 0.5, 0.3, 0.1, 0.02] {
            for angle in [0.0, 30.0, 60.0, 80.0, 88.0] {
                let Some((error, reflectance)) = error(1.0 - albedo, eta, degrees(angle)) else { continue };
                let what = format!("index {eta} albedo {albedo} {angle}°: {error:.4} of {reflectance:.5}");
                assert!(error.abs() < 0.02 || error.abs() * reflectance < 1.2e-4, "{what}");
                assert!(albedo < 1.0 || error.abs() < 0.002 || eta <= 1.01, "{what}");
            }
        }
    }
}
