//! Published media, and media at the limits.

use bssrdf::{DVec3, Exitant, Incident, Medium, Model, built_in, evaluate};
use serde_json::Value;
use support::{
    pipeline::{MODELS, grey},
    random::Random,
};

/// Equation (3.5) of every channel.
fn diffuse_reflectance(medium: &Medium) -> [f64; 3] {
    medium.map(|c| {
        let albedo = c.reduced_albedo();
        let q = (3.0 * (1.0 - albedo)).sqrt();
        albedo / 2.0 * (1.0 + (-4.0 / 3.0 * medium.interface.reflection_egan * q).exp()) * (-q).exp()
    })
}

#[test]
fn media_have_their_tabulated_reflectance() {
    let file: Value = serde_json::from_str(include_str!("../reference/diffuse_reflectance.json"))
        .expect("the reference file is JSON");
    let entries = file["entries"].as_array().expect("a list");
    assert_eq!(entries.len(), 12);
    for entry in entries {
        let medium = built_in(entry["medium"].as_str().expect("a name")).expect("a medium of that name");
        for (c, value) in diffuse_reflectance(&medium).into_iter().enumerate() {
            let expected = entry["diffuse_reflectance"][c].as_f64().expect("a number");
            assert!((value - expected).abs() <= 0.5e-4 + 1e-12, "{} channel {c}: {value}", medium.name);
        }
    }
}

/// The published reflectance of marble, two digits, belongs to the index 1.5.
#[test]
fn marble_has_its_published_reflectance() {
    let marble = built_in("marble").expect("a built-in medium");
    assert_eq!(marble.eta, 1.5);
    let rounded = diffuse_reflectance(&marble).map(|r| (100.0 * r).round() / 100.0);
    assert_eq!(rounded, [0.83, 0.79, 0.75]);
}

fn random_values(model: Model, medium: &Medium) -> impl Iterator<Item = f64> {
    let (model, eta, mut random) = (model.of(medium), medium.eta, Random(5));
    (0..1000).map(move |k| {
        let [normal, direction, out] = [0; 3].map(|_| random.direction());
        let direction = direction * direction.dot(normal).signum();
        let scale = 10f64.powf(random.between(-7.0, 1.0)) * if k % 10 == 0 { 0.0 } else { 1.0 };
        let incident = Incident { position: DVec3::ZERO, normal, direction };
        let exitant = Exitant { position: random.direction() * scale, normal: out, direction: out };
        evaluate(&*model, eta, 0, &incident, &exitant).full
    })
}

#[test]
fn nothing_scatters_no_light_out() {
    let clear = [grey(300.0, 0.0, 0.0, 1.3), grey(0.0, 0.0, 0.0, 1.5)];
    for (medium, model) in clear.iter().flat_map(|m| MODELS.map(|model| (m, model))) {
        assert!(random_values(model, medium).all(|s| s == 0.0), "{}", model.name());
    }
}

#[test]
fn without_absorption_values_are_finite() {
    for medium in [grey(0.0, 800.0, 0.0, 1.3), grey(0.0, 1e6, 0.95, 1.0), grey(0.0, 20.0, -0.5, 0.7)] {
        for model in MODELS {
            let mut lit = 0;
            for value in random_values(model, &medium) {
                assert!(value.is_finite() && value >= 0.0, "{}: {value}", model.name());
                lit += u32::from(value > 0.0);
            }
            assert!(lit > 100, "{}: only {lit} of 1000 not zero", model.name());
        }
    }
}

/// A file in 1/mm is the same medium as one in 1/m with numbers 1000 times larger.
#[test]
fn units_are_converted_once() {
    let file = |unit: &str, s: f64| {
        format!(r#"{{"name":"m","unit":"{unit}","sigma_a":[{s},{s},{s}],"sigma_s":[{s},{s},{s}],"g":[0,0.5,0.9]}}"#)
    };
    let [millimetres, metres] = [file("1/mm", 0.5), file("1/m", 500.0)].map(|json| Medium::from_json(&json));
    let millimetres = millimetres.expect("valid");
    assert_eq!(millimetres, metres.expect("valid"));
    assert_eq!(millimetres.channels[2].sigma_s, 500.0);
    assert!((millimetres.channels[1].reduced_extinction() - 750.0).abs() < 1e-12);
}
