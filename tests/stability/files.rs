//! NaN and infinity in every input file: an error that names the file or the field, never a panic, and never a number
//! that is not finite in the result.

use crate::document::{bench, binary, document, import};
use bssrdf::{Medium, MediumFile, Optics};
use compare::compare;
use formats::{
    Attribute, Channel, Image,
    cloud::{Cloud, Meta, Sample},
};
use glam::{DVec3, Vec3};
use scene::{Scene, View, ViewFile};
use serde_json::{Value, json};
use std::path::Path;
use test_support::{
    Bench,
    meshes::{Light, Part, quad, world},
    pipeline::{by_area, sampled, write},
    planted::{alternating, planted},
};

/// Texts that JSON has no number for, and numbers beyond float64.
const NO_NUMBERS: [&str; 6] = ["NaN", "-NaN", "Infinity", "-Infinity", "1e999", "-1e999"];

/// Paths of all numbers in a JSON value.
fn numbers(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(path.to_owned()),
        Value::Array(list) => list.iter().enumerate().for_each(|(k, v)| numbers(v, &format!("{path}/{k}"), found)),
        Value::Object(map) => map.iter().for_each(|(k, v)| numbers(v, &format!("{path}/{k}"), found)),
        _ => {}
    }
}

/// The document with one value replaced by any text.
fn replaced(document: &Value, path: &str, text: &str) -> String {
    let mut document = document.clone();
    *document.pointer_mut(path).expect("a path of this document") = json!("here");
    document.to_string().replacen("\"here\"", text, 1)
}

/// All numbers of a scene that later stages compute with.
fn assert_finite(scene: &Scene, what: &str) {
    let vectors = scene.mesh.positions.iter().chain(&scene.mesh.normals);
    assert!(vectors.into_iter().all(|v| v.is_finite()) && scene.origin.is_finite(), "{what}");
    for camera in &scene.cameras {
        let axes = [camera.position, camera.right, camera.up, camera.forward];
        assert!(axes.iter().all(|v| v.is_finite()) && camera.aspect.is_none_or(f64::is_finite), "{what}");
        let (origin, direction) = camera.ray(glam::DVec2::splat(0.25), glam::DVec2::ONE);
        assert!(origin.is_finite() && direction.is_finite(), "{what}");
    }
    for material in &scene.materials {
        assert!(material.base_color.is_finite() && material.emission.is_finite(), "{what}");
    }
    let point = scene.mesh.point(0, [0.3, 0.3, 0.4], scene::NormalKind::Geometric);
    for light in scene.lights() {
        assert!(light.importance(&point).is_finite(), "{what}");
        assert!(light.illuminate(&point, [0.5; 2]).is_none_or(|l| l.irradiance.is_finite()), "{what}");
    }
}

/// Each number of a glTF file in turn: replaced by a name, by numbers beyond float64, and by numbers beyond the
/// float32 that the parser rounds to.
#[test]
fn gltf_json() {
    let (bench, document) = (bench(&binary()), document());
    let good = import(&bench, &document.to_string()).expect("the file is valid");
    assert_eq!((good.cameras.len(), good.lights().count()), (2, 4));
    assert_finite(&good, "as it is");
    // Finite numbers whose product is not.
    let error = import(&bench, &replaced(&document, "/nodes/6/scale/2", "1e308")).err().expect("refused").to_string();
    assert!(error.contains("scene.gltf") && error.contains("transform is not finite"), "{error}");
    let mut paths = Vec::new();
    numbers(&document, "", &mut paths);
    assert!(paths.len() > 90);
    for path in &paths {
        for number in NO_NUMBERS {
            assert!(import(&bench, &replaced(&document, path, number)).is_err(), "{path} is {number}");
        }
        for number in ["1e39", "-1e39", "1e200", "-1e308", "1e308", "1e-320"] {
            if let Ok(scene) = import(&bench, &replaced(&document, path, number)) {
                assert_finite(&scene, &format!("{path} is {number}"));
            }
        }
    }
}

/// Each float of the buffer in turn; indices have no such values, and are checked against their count.
#[test]
fn gltf_binary() {
    let changed = |at: usize, number: f32| {
        let mut binary = binary();
        binary[at..at + 4].copy_from_slice(&number.to_le_bytes());
        import(&bench(&binary), &document().to_string())
    };
    for at in (0..72).step_by(4) {
        for number in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let error = changed(at, number).err().expect("refused").to_string();
            assert!(error.contains("scene.gltf") && error.contains("not finite"), "{error}");
        }
        for number in [f32::MAX, f32::MIN, 1e30, f32::MIN_POSITIVE, 1e-45] {
            if let Ok(scene) = changed(at, number) {
                assert_finite(&scene, &format!("{number} at {at}"));
            }
        }
    }
}

#[test]
fn view() {
    let bench = Bench::new();
    let view = json!({ "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "yfov": 30, "width": 4, "height": 3 });
    let read = |text: &str| {
        View::read(&bench.write("view.json", text)).map(|file| match file {
            ViewFile::One(one) => one.1,
            ViewFile::List(views) => panic!("a list of {}", views.len()),
        })
    };
    read(&view.to_string()).expect("the view is valid");
    let mut paths = Vec::new();
    numbers(&view, "", &mut paths);
    for at in &paths {
        for number in NO_NUMBERS {
            let error = read(&replaced(&view, at, number)).expect_err("refused").to_string();
            assert!(error.contains("view.json"), "{error}");
        }
        for number in ["1e308", "-1e308", "1e200", "1e-320", "179.99999999999997"] {
            if let Ok(camera) = read(&replaced(&view, at, number)) {
                let (origin, direction) = camera.ray(glam::DVec2::new(0.1, 0.2), glam::DVec2::ONE);
                assert!(origin.is_finite() && direction.is_finite(), "{at} is {number}: {direction}");
            }
        }
    }
}

/// In each of the three ways to give a medium.
#[test]
fn medium() {
    let ways = [("1/m", ["sigma_a", "sigma_s"]), ("mm", ["albedo", "mean_free_path"]), ("m", ["color", "radius"])];
    for (unit, [one, other]) in ways {
        let medium = json!({
            "name": "test", "unit": unit, one: [0.5, 0.5, 0.5], other: [1, 1, 1], "g": [0, 0, 0], "eta": 1.3
        });
        Medium::from_json(&medium.to_string()).expect("the medium is valid");
        let mut paths = Vec::new();
        numbers(&medium, "", &mut paths);
        assert_eq!(paths.len(), 10);
        for path in &paths {
            // A mean free path of 1e-300 is refused; one of 1e300 makes a clear medium.
            let huge = if path.contains("mean_free_path") || path.contains("radius") { "1e-300" } else { "1e300" };
            for number in NO_NUMBERS.into_iter().chain([huge, "-1"]) {
                assert!(Medium::from_json(&replaced(&medium, path, number)).is_err(), "{path} is {number}");
            }
        }
        let file: MediumFile = serde_json::from_value(medium).expect("the medium is valid");
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(Medium::new(MediumFile { eta: bad, ..file.clone() }).is_err());
            for (one, other) in [([1.0, bad, 1.0], [1.0; 3]), ([0.5; 3], [1.0, 1.0, bad])] {
                let optics = match file.optics {
                    Optics::Coefficients { .. } => Optics::Coefficients { sigma_a: one, sigma_s: other },
                    Optics::Albedo { .. } => Optics::Albedo { albedo: one, mean_free_path: other },
                    Optics::Color { .. } => Optics::Color { color: one, radius: other },
                };
                assert!(Medium::new(MediumFile { optics, ..file.clone() }).is_err());
            }
        }
    }
}

/// One changed sample in a file with correct checksums.
fn verdict(path: &Path, sample: Sample, change: impl Fn(&mut Meta)) -> Result<(), formats::Error> {
    let sun = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
    let drawn = sampled(&world(&[Part::translucent(quad(0.5, 0.0, 1))], &[sun], DVec3::ZERO), &by_area(1, 0));
    let mut cloud = planted(&drawn.meta, &[alternating([sample])]);
    change(&mut cloud.meta);
    write(&cloud, path);
    Cloud::open(path)?.verify(path)
}

/// Every float of a sample and of the metadata of a cloud.
#[test]
fn cloud() {
    let bench = Bench::new();
    let path = bench.path("test.cloud");
    let good = Sample { position: Vec3::ZERO, normal: DVec3::Z, direction: DVec3::Z, flux: Vec3::ONE };
    verdict(&path, good, |_| ()).expect("the cloud is valid");
    let facts: [fn(&mut Meta, f64); 6] = [
        |m, x| m.origin_m[1] = x,
        |m, x| m.mean_flux_w[2] = x,
        |m, x| m.diagonal_m = x,
        |m, x| m.surface_area_m2 = x,
        |m, x| m.materials[0].area_m2 = x,
        |m, x| m.options.metres_per_unit = x,
    ];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for c in 0..3 {
            let mut vector = Vec3::ONE;
            vector[c] = bad;
            for sample in [Sample { position: vector, ..good }, Sample { flux: vector, ..good }] {
                let error = verdict(&path, sample, |_| ()).expect_err("refused").to_string();
                assert!(error.contains("test.cloud") && error.contains("not finite"), "{error}");
            }
        }
        for fact in facts {
            let error = verdict(&path, good, |m| fact(m, f64::from(bad))).expect_err("refused").to_string();
            assert!(error.contains("test.cloud") && error.contains("sample again"), "{error}");
        }
    }
    assert!(verdict(&path, Sample { flux: Vec3::NEG_X, ..good }, |_| ()).is_err(), "negative flux");
}

/// An image can be read whatever it holds; in a comparison it passes no gate, not even against itself.
#[test]
fn image() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let channels = ["R", "G", "B", "variance.R"];
        let channel = |name: &str| Channel { name: name.to_owned(), samples: vec![0.5; 12] };
        let good = Image { width: 4, height: 3, channels: channels.map(channel).into(), ..Image::default() };
        let matrix = ("worldToCamera".to_owned(), Attribute::Matrix([bad; 16]));
        for c in 0..4 {
            let mut planted = Image { attributes: [matrix.clone()].into(), ..good.clone() };
            planted.channels[c].samples[7] = bad;
            let planted = Image::decode(&planted.encode().expect("an image")).expect("an image");
            for (reference, test) in [(&good, &planted), (&planted, &good), (&planted, &planted)] {
                let report = compare(reference, test, &compare::Settings::default()).expect("of one shape");
                assert!(!report.pass && report.nonfinite.reference + report.nonfinite.test > 0);
                assert!(report.verdict("test.exr").starts_with("FAIL nonfinite"));
                report.table();
            }
        }
        let report = compare(&good, &good, &compare::Settings::default()).expect("of one shape");
        assert!(report.pass);
    }
}
