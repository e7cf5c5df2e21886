//! The tables of `docs/reports/accuracy.md`.

use crate::accuracy::picture::{MEDIUM, Ratios};
use bssrdf::fresnel;
use std::fmt::{Error, Write};
use test_support::{
    half_space::{reflectance, transmission},
    pipeline::DIPOLES,
    transfer::chandrasekhar,
    walk::{Balance, Matter, slab},
};

/// Number of walks for each table entry.
const WALKS: u64 = 1_000_000;

const ALBEDOS: [f64; 12] = [0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999, 1.0];
const ANGLES: [f64; 3] = [0.0, 45.0, 75.0];
const ETAS: [f64; 2] = [1.3, 1.5];
const THICKNESSES: [f64; 6] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0];

fn half_space(albedo: f64, asymmetry: f64, eta: f64, cosine: f64, seed: u64) -> Balance {
    slab(&Matter { albedo, asymmetry, eta }, f64::INFINITY, cosine, WALKS, seed)
}

/// The whole document.
pub fn document(spheres: &[Ratios]) -> Result<String, Error> {
    let mut text = String::new();
    text.push_str(INTRODUCTION);
    checks(&mut text)?;
    for eta in ETAS {
        reflectances(&mut text, eta)?;
    }
    similarity(&mut text)?;
    slabs(&mut text)?;
    sphere(&mut text, spheres)?;
    Ok(text)
}

const INTRODUCTION: &str = "# Errors of the models

Made by `make accuracy`; do not edit. These are errors of the published models themselves: the point cloud sums a model
without bias, so an image converges to the prediction of its model, right or wrong. The reference is a random walk in the
medium behind the same smooth boundary, without the diffusion approximation.

**Read this before you choose.** All figures are reflectances of a half-space under normal incidence.

* The *directional dipole* is the only one that depends on the direction of the light. It is too bright everywhere: by a
  quarter at high albedo, by a factor of two below 0.8, and by orders of magnitude where most light is absorbed.
* The *better dipole* is within 5 per cent above a reduced albedo of 0.98 and too dark below 0.95, increasingly with
  absorption.
* The *standard dipole* is within 11 per cent for index 1.3 at any albedo; for 1.5 it is 10 per cent too dark at high albedo
  and up to half too bright at low.
* None of them accounts for the thickness of an object: slabs thinner than two reduced mean free paths transmit far too much
  light, thick ones too little, and the dark side of a round object is too dark.

`gather` warns when the reflectance of the chosen model is off by more than ten per cent for the chosen medium.

";

fn checks(text: &mut String) -> Result<(), Error> {
    writeln!(text, "## Test of the random walk\n")?;
    writeln!(text, "A half-space of isotropic scatterers without a boundary reflects `1 - H(mu) sqrt(1 - albedo)`")?;
    writeln!(text, "(Chandrasekhar 1950). Differences are in standard errors:\n")?;
    writeln!(text, "| albedo | angle | exact | walk | difference |\n|---|---|---|---|---|")?;
    for (k, (albedo, angle)) in [(0.5, 0.0f64), (0.9, 0.0), (0.9, 60.0), (0.99, 30.0)].into_iter().enumerate() {
        let cosine = angle.to_radians().cos();
        let exact = chandrasekhar(albedo, cosine);
        let walk = half_space(albedo, 0.0, 1.0, cosine, 100 + k as u64).reflected;
        let z = (walk.mean - exact) / walk.error;
        writeln!(text, "| {albedo} | {angle} | {exact:.5} | {:.5} ± {:.5} | {z:+.1} |", walk.mean, walk.error)?;
        assert!(z.abs() < 4.5, "the walk is wrong: {z} standard errors");
    }
    text.push('\n');
    Ok(())
}

fn reflectances(text: &mut String, eta: f64) -> Result<(), Error> {
    writeln!(text, "## Half-space, index {eta}\n")?;
    writeln!(
        text,
        "Share of the light that is scattered back; in brackets, the relative difference of a model. The standard"
    )?;
    writeln!(text, "error of the walk is below 0.0005; at albedo 1 all light that enters comes back.\n")?;
    writeln!(text, "| reduced albedo | angle | walk | directional | better | standard |\n|---|---|---|---|---|---|")?;
    for (i, albedo) in ALBEDOS.into_iter().enumerate() {
        for (j, angle) in ANGLES.into_iter().enumerate() {
            let cosine = angle.to_radians().cos();
            let seed = 1000 + (eta * 10.0) as u64 * 100 + (i * ANGLES.len() + j) as u64;
            // Without absorption all light that enters leaves again, after any number of steps.
            let walk = match albedo {
                1.0 => fresnel::transmittance(cosine, eta),
                _ => half_space(albedo, 0.0, eta, cosine, seed).reflected.mean,
            };
            write!(text, "| {albedo} | {angle} | {walk:.4} |")?;
            for model in DIPOLES {
                let value = reflectance(model, albedo, eta, cosine);
                write!(text, " {value:.4} ({}) |", percent(value / walk - 1.0))?;
            }
            text.push('\n');
        }
    }
    text.push('\n');
    Ok(())
}

fn similarity(text: &mut String) -> Result<(), Error> {
    writeln!(text, "## Forward scattering\n")?;
    writeln!(
        text,
        "The models depend on `g` only through the reduced coefficients. Walks of the same reduced albedo, normal"
    )?;
    writeln!(text, "incidence, index 1.3:\n")?;
    writeln!(text, "| reduced albedo | g = 0 | g = 0.5 | g = 0.9 |\n|---|---|---|---|")?;
    for (k, reduced) in [0.5, 0.9, 0.99].into_iter().enumerate() {
        write!(text, "| {reduced} |")?;
        for (j, g) in [0.0, 0.5, 0.9].into_iter().enumerate() {
            // α' = (1−g)α/((1−g)α + 1 − α), solved for α.
            let albedo = reduced / (reduced + (1.0 - g) * (1.0 - reduced));
            let walk = half_space(albedo, g, 1.3, 1.0, 5000 + (3 * k + j) as u64).reflected;
            write!(text, " {:.4} |", walk.mean)?;
        }
        text.push('\n');
    }
    text.push('\n');
    Ok(())
}

fn slabs(text: &mut String) -> Result<(), Error> {
    writeln!(text, "## Thin slabs\n")?;
    writeln!(
        text,
        "A slab of index 1.3 under normal incidence; thickness in reduced mean free paths. The models reflect as"
    )?;
    writeln!(
        text,
        "much as a half-space; `T` is what they transmit when points of the back gather the samples of the front.\n"
    )?;
    writeln!(text, "| reduced albedo | thickness | walk R | walk T | T directional | T better | T standard |")?;
    writeln!(text, "|---|---|---|---|---|---|---|")?;
    for (i, albedo) in [0.9, 0.99, 0.999].into_iter().enumerate() {
        for (j, thickness) in THICKNESSES.into_iter().enumerate() {
            let matter = Matter { albedo, asymmetry: 0.0, eta: 1.3 };
            let walk = slab(&matter, thickness, 1.0, WALKS, 7000 + (10 * i + j) as u64);
            write!(text, "| {albedo} | {thickness} | {:.4} | {:.4} |", walk.reflected.mean, walk.transmitted.mean)?;
            for model in DIPOLES {
                let value = transmission(model, albedo, 1.3, thickness);
                write!(text, " {value:.4} ({}) |", percent(value / walk.transmitted.mean - 1.0))?;
            }
            text.push('\n');
        }
    }
    text.push('\n');
    Ok(())
}

fn sphere(text: &mut String, spheres: &[Ratios]) -> Result<(), Error> {
    writeln!(text, "## A sphere\n")?;
    writeln!(
        text,
        "Radius 20 mm, {MEDIUM}, parallel light from the right; scattered light only. Left: random walks; middle:"
    )?;
    writeln!(
        text,
        "the model; right: their relative difference, red where the model is brighter, blue where it is darker,"
    )?;
    writeln!(
        text,
        "full color at 50 %. The ratios are of the means where the surface turns to or from the light by more"
    )?;
    writeln!(text, "than 30 degrees, red, green and blue.\n")?;
    writeln!(text, "| model | | lit side | dark side |\n|---|---|---|---|")?;
    for r in spheres {
        let three = |v: [f64; 3]| v.map(|x| format!("{x:.2}")).join(" ");
        let name = r.model.name();
        writeln!(text, "| {name} | ![{name}](sphere-{name}.png) | {} | {} |", three(r.lit), three(r.dark))?;
    }
    Ok(())
}

fn percent(x: f64) -> String {
    if x.abs() < 10.0 { format!("{:+.0} %", 100.0 * x) } else { format!("x {:.0}", x + 1.0) }
}
