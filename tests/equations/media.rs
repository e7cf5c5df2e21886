//! Published media, and media at the limits.

use bssrdf::{DVec3, Exitant, Incident, Medium, MediumError, Model, built_in, evaluate, single_scattering_albedo};
use serde_json::Value;
use std::f64::consts::PI;
use test_support::{
    pipeline::{MODELS, gray},
    quadrature::{Annulus, plane_integral},
    random::Random,
    walk::{Estimate, Matter, slab},
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

/// A medium from its diffuse color; lengths in mm.
fn colored(color: [f64; 3], radius: [f64; 3], rest: &str) -> Result<Medium, MediumError> {
    Medium::from_json(&format!(r#"{{"name":"test","unit":"mm","color":{color:?},"radius":{radius:?}{rest}}}"#))
}

/// A half-space of that medium reflects the color: by the closed form (3.5), and by the integral of the model itself
/// over a plane. Seen to catch: one index for all media (10 % in a dark color).
#[test]
fn a_medium_shows_the_color_asked_for() {
    for (eta, g) in [(1.0, 0.0), (1.3, 0.0), (1.5, 0.8), (0.7, -0.5)] {
        for color in [[0.0, 1e-4, 0.02], [0.2, 0.5, 0.8], [0.9, 0.99, 0.9999]] {
            let radius = [0.1, 1.0, 30.0];
            let medium = colored(color, radius, &format!(r#","eta":{eta},"g":{g}"#)).expect("a medium");
            for (c, value) in diffuse_reflectance(&medium).into_iter().enumerate() {
                // A color near 1 leaves few digits of 1 - albedo.
                assert!((value - color[c]).abs() < 1e-10, "{value} for {}", color[c]);
                let transport = medium.channels[c].transport();
                assert!((transport * radius[c] * 1e-3 - 1.0).abs() < 1e-9, "1/{transport} for {} mm", radius[c]);
                let annulus =
                    Annulus { inner: 1e-6 / medium.channels[c].reduced_extinction(), outer: 60.0 / transport };
                let integral = PI * plane_integral(&*Model::StandardDipole.of(&medium), c, 0.0, annulus);
                assert!((integral - color[c]).abs() < 1e-6, "{integral} for {}", color[c]);
            }
        }
    }
}

/// `σ_t = 1/mean free path`, divided by the albedo.
#[test]
fn a_medium_by_albedo_and_mean_free_path() {
    let text = r#"{"name":"test","unit":"m","albedo":[0.75,0,1],"mean_free_path":[0.5,4,0.125],"g":0.5}"#;
    let medium = Medium::from_json(text).expect("a medium");
    assert_eq!(medium.map(|c| c.sigma_s), [1.5, 0.0, 8.0]);
    assert_eq!(medium.map(|c| c.sigma_a), [0.5, 0.25, 0.0]);
    let millimetres = Medium::from_json(&text.replace("\"m\"", "\"mm\"")).expect("a medium");
    assert_eq!(millimetres.mean_free_path(), [0.5e-3, 4e-3, 0.125e-3]);
}

#[test]
fn fields_of_two_ways_to_give_a_medium_do_not_mix() {
    let three = "[0.5,0.5,0.5]";
    let cases = [
        (r#""unit":"1/m","sigma_a":V,"albedo":V"#, "one pair"),
        (r#""unit":"1/m","sigma_a":V,"sigma_s":V,"albedo":V"#, "one pair"),
        (r#""unit":"m","albedo":V,"radius":V"#, "one pair"),
        (r#""unit":"m","color":V"#, "one pair"),
        (r#""unit":"m""#, "one pair"),
        (r#""unit":"m","sigma_a":V,"sigma_s":V"#, "\"1/mm\" or \"1/m\""),
        (r#""unit":"1/m","color":V,"radius":V"#, "\"mm\" or \"m\""),
        (r#""unit":"m","color":V,"radius":V,"sss":1"#, "unknown field `sss`"),
        (r#""color":V,"radius":V"#, "missing field `unit`"),
    ];
    for (fields, words) in cases {
        let text = format!(r#"{{"name":"test",{}}}"#, fields.replace('V', three));
        let message = Medium::from_json(&text).expect_err(fields).to_string();
        assert!(message.contains(words), "{fields}: {message}");
    }
    let message = |color: [f64; 3], radius: [f64; 3]| colored(color, radius, "").expect_err("refused").to_string();
    assert!(message([0.5, 1.0, 0.5], [1.0; 3]).contains("`color`: 1 is outside [0, 1)"));
    assert!(message([0.5; 3], [1.0, 0.0, 1.0]).contains("`radius`: 0 is not a length above zero"));
}

/// The examples in the text of the drafts, and the ends of the range for every `g`.
#[test]
fn the_albedo_of_the_gltf_drafts() {
    assert!((single_scattering_albedo(0.5, 0.0) - 0.9117).abs() < 5e-5);
    for g in [-0.999, 0.0, 0.9, 0.999_999] {
        assert!(single_scattering_albedo(0.0, g) < 1e-5 / (1.0 - g), "{g}");
        assert!(single_scattering_albedo(1.0, g) > 1.0 - 1e-9);
    }
    // 1 − s² = 0.9117 over 1 − g s² with s² = 0.0883.
    assert!((single_scattering_albedo(0.5, 0.5) - 0.9117 / (1.0 - 0.5 * 0.0883)).abs() < 1e-4);
}

/// The purpose of the formula of the drafts: without a reflecting boundary, the medium shows the color under a constant
/// environment, to the 1 % of the fit. Random walks, false alarms 1 in 10⁵. Seen to catch: the albedo 2 % too low.
#[test]
fn the_drafts_color_is_that_of_random_walks() {
    let walks = if cfg!(feature = "slow") { 1_000_000 } else { 50_000 };
    for color in [0.1, 0.5, 0.9] {
        let matter = Matter { albedo: single_scattering_albedo(color, 0.0), asymmetry: 0.0, eta: 1.0 };
        // Under a constant environment cosines have the density 2c: the centers of ten strata.
        let tenths = (0..10u64).map(|k| {
            let cosine = ((k as f64 + 0.5) / 10.0).sqrt();
            slab(&matter, f64::INFINITY, cosine, walks / 10, k).reflected
        });
        let tenths: Vec<Estimate> = tenths.collect();
        let mean = tenths.iter().map(|e| e.mean).sum::<f64>() / 10.0;
        let error = tenths.iter().map(|e| e.error * e.error).sum::<f64>().sqrt() / 10.0;
        println!("{color}: {mean:.4} +- {error:.4}");
        assert!((mean - color).abs() < 4.5 * error + 0.01 * color, "{color}: {mean} +- {error}");
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
    let clear = [gray(300.0, 0.0, 0.0, 1.3), gray(0.0, 0.0, 0.0, 1.5)];
    for (medium, model) in clear.iter().flat_map(|m| MODELS.map(|model| (m, model))) {
        assert!(random_values(model, medium).all(|s| s == 0.0), "{}", model.name());
    }
}

#[test]
fn without_absorption_values_are_finite() {
    for medium in [gray(0.0, 800.0, 0.0, 1.3), gray(0.0, 1e6, 0.95, 1.0), gray(0.0, 20.0, -0.5, 0.7)] {
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

/// A file in 1/mm gives the same medium as one in 1/m with numbers 1000 times larger.
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
