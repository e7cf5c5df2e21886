//! `S`, `S_gather`, `S_bare`, the transmittances and the refracted direction at the reference vectors, in float64 and
//! in float32.
//!
//! Lengths and coefficients are used as they are: one unit of length is called a metre here, so that no conversion
//! rounds the inputs.

use bssrdf::{
    Exitant, Incident, Medium, Model, Values, evaluate, fresnel,
    lanes::{Block, LANES},
};
use glam::DVec3;
use serde_json::Value;
use test_support::pipeline::{DIPOLES, gray};

/// One reference vector.
struct Vector {
    tag: String,
    medium: Medium,
    incident: Incident,
    exitant: Exitant,
    transmittances: [f64; 2],
    refracted: Option<DVec3>,
    /// `−n_o·ω12`.
    mu0: Option<f64>,
    /// Values and condition number, in the order of [`DIPOLES`].
    expected: [(Values, f64); 3],
}

fn triple(value: &Value) -> Option<DVec3> {
    let numbers: Vec<f64> = value.as_array()?.iter().filter_map(Value::as_f64).collect();
    Some(DVec3::from_array(numbers.try_into().ok()?))
}

fn read(vector: &Value) -> Vector {
    let number = |key: &str| vector[key].as_f64().unwrap_or_else(|| panic!("{key} is a number"));
    let three = |key: &str| triple(&vector[key]).unwrap_or_else(|| panic!("{key} is a vector"));
    let expected = |model: &Value| {
        let number = |key: &str| model[key].as_f64().unwrap_or_else(|| panic!("{key} is a number"));
        let values = Values { full: number("S"), gather: number("S_gather"), bare: number("S_bare") };
        (values, model["cond"].as_f64().unwrap_or(1.0))
    };
    Vector {
        tag: vector["tag"].as_str().unwrap_or_default().into(),
        medium: gray(number("sigma_a"), number("sigma_s"), number("g"), number("eta")),
        incident: Incident { position: three("x_i"), normal: three("n_i"), direction: three("w_i") },
        exitant: Exitant { position: three("x_o"), normal: three("n_o"), direction: three("w_o") },
        transmittances: [number("T12"), number("T21")],
        refracted: triple(&vector["w12"]),
        mu0: vector["directional"]["mu0"].as_f64(),
        expected: ["directional", "better", "standard"].map(|name| expected(&vector[name])),
    }
}

fn vectors() -> Vec<Vector> {
    let file: Value =
        serde_json::from_str(include_str!("../reference/bssrdf_vectors.json")).expect("the reference file is JSON");
    let vectors: Vec<Vector> = file["vectors"].as_array().expect("a list").iter().map(read).collect();
    assert_eq!(vectors.len(), 61);
    vectors
}

/// Relative error; where zero is expected, 0 or infinite.
fn relative(value: f64, expected: f64) -> f64 {
    if value == expected { 0.0 } else { (value / expected - 1.0).abs() }
}

#[test]
fn float64_agrees_with_the_reference() {
    let mut worst = (0.0, String::new());
    for v in vectors() {
        for (model, (expected, condition)) in DIPOLES.into_iter().zip(v.expected) {
            let values = evaluate(&*model.of(&v.medium), v.medium.eta, 0, &v.incident, &v.exitant);
            let tolerance = 1e-12 * (1.0 + condition);
            let pairs = [(values.full, expected.full), (values.gather, expected.gather), (values.bare, expected.bare)];
            for (value, expected) in pairs {
                let error = relative(value, expected);
                assert!(error <= tolerance, "{} {}: {value:e} for {expected:e}", v.tag, model.name());
                if error / tolerance > worst.0 {
                    worst = (error / tolerance, format!("{} {}: {error:.1e}", v.tag, model.name()));
                }
            }
        }
    }
    println!("worst share of the tolerance: {:.3} ({})", worst.0, worst.1);
}

#[test]
fn interface_agrees_with_the_reference() {
    for v in vectors() {
        let eta = v.medium.eta;
        let inward = v.incident.normal.dot(v.incident.direction);
        let out = v.exitant.normal.dot(v.exitant.direction);
        for (cosine, expected) in [(inward, v.transmittances[0]), (out, v.transmittances[1])] {
            let value = fresnel::transmittance(cosine, eta);
            // Where no light enters, none leaves, and the vectors give no T21.
            let unused = expected == 0.0 && v.refracted.is_none();
            assert!(unused || relative(value, expected) < 1e-13, "{}: T = {value:e} for {expected:e}", v.tag);
        }
        let entry = fresnel::enter(v.incident.normal, v.incident.direction, eta);
        assert_eq!(entry.is_some(), v.refracted.is_some(), "{}", v.tag);
        if let (Some(entry), Some(expected)) = (entry, v.refracted) {
            assert!((entry.direction - expected).length() < 4e-15, "{}: ω12", v.tag);
            let mu0 = -v.exitant.normal.dot(entry.direction);
            assert!(v.mu0.is_none_or(|expected| (mu0 - expected).abs() < 1e-15), "{}: μ0", v.tag);
        }
    }
}

/// `S_bare` of one configuration in float32, with the difference of positions in float64 as in `gather`.
fn bare_in_float32(model: Model, v: &Vector, refracted: DVec3) -> f64 {
    let lanes = |v: DVec3| v.as_vec3().to_array().map(|x| [x; LANES]);
    let offset = lanes(v.exitant.position - v.incident.position);
    let block = Block { offset, normal_in: lanes(v.incident.normal), refracted: lanes(refracted) };
    let normal_out = v.exitant.normal.as_vec3().to_array();
    f64::from(model.lanes(&v.medium).bare(&block, normal_out)[0][0])
}

#[test]
fn float32_agrees_with_the_reference() {
    let mut worst = (0.0, String::new());
    for v in vectors() {
        let Some(refracted) = v.refracted else { continue };
        for (model, (expected, condition)) in DIPOLES.into_iter().zip(v.expected) {
            // At |μ0| < 10⁻⁵ the branch of d_r, and with it a factor of S, depends on the rounding of n_o and ω12.
            let undecided = model == Model::DirectionalDipole && v.mu0.is_some_and(|mu0| mu0.abs() < 1e-5);
            if undecided {
                continue;
            }
            let value = bare_in_float32(model, &v, refracted);
            let tolerance = 1e-6 * (20.0 + 10.0 * condition);
            let error = relative(value, expected.bare);
            let close = error <= tolerance || (value - expected.bare).abs() <= 1e-30;
            assert!(close, "{} {}: {value:e} for {:e}", v.tag, model.name(), expected.bare);
            if error / tolerance > worst.0 && expected.bare > 1e-30 {
                worst = (error / tolerance, format!("{} {}: {error:.1e}", v.tag, model.name()));
            }
        }
    }
    println!("worst share of the tolerance: {:.3} ({})", worst.0, worst.1);
}
