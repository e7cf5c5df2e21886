//! `--target-error`: the error asked for is a standard error that is met, not one that was met by luck once. All light comes
//! through a small hole in a black plate, so that the flux that enters is known to the last digit, and so that the two
//! halves of a cloud differ by one value all over the surface.

use serde_json::{Value, json};
use std::{fs, process::Command};

/// Boxes and plates: corners, triangles, m.
#[derive(Default)]
struct Shape {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// A side that spans two axes from one corner.
    fn add(&mut self, corner: [f64; 3], along: [f64; 3], across: [f64; 3]) {
        let first = self.positions.len() as u32;
        for [u, v] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            self.positions.push([0, 1, 2].map(|k| (corner[k] + u * along[k] + v * across[k]) as f32));
        }
        self.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }

    /// A cube about the origin, facing outward.
    fn cube(half: f64) -> Shape {
        let mut cube = Shape::default();
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let side = |axis: usize, size: f64| [0, 1, 2].map(|k| if k == axis { size } else { 0.0 });
                let mut corner = [-half; 3];
                corner[axis] = sign * half;
                let (one, two) = (side((axis + 1) % 3, 2.0 * half), side((axis + 2) % 3, 2.0 * half));
                if sign > 0.0 { cube.add(corner, one, two) } else { cube.add(corner, two, one) }
            }
        }
        cube
    }

    /// A plate with a square hole in the middle; both half sizes.
    fn plate(half: f64, hole: f64, height: f64) -> Shape {
        let mut plate = Shape::default();
        for [x, width, z, depth] in [
            [-half, half - hole, -half, 2.0 * half],
            [hole, half - hole, -half, 2.0 * half],
            [-hole, 2.0 * hole, -half, half - hole],
            [-hole, 2.0 * hole, hole, half - hole],
        ] {
            plate.add([x, height, z], [0.0, 0.0, depth], [width, 0.0, 0.0]);
        }
        plate
    }
}

/// A scene in a folder of its own: a cube of this half size, m, under a plate with a square hole of this size, m, and a
/// light of 1 W/m² from above.
fn under_a_hole(size: f64, half_cube: f64) -> tempfile::TempDir {
    let shapes = [Shape::cube(half_cube), Shape::plate(4.0 * half_cube, 0.5 * size, 1.2 * half_cube)];
    let (mut binary, mut views, mut accessors, mut meshes): (Vec<u8>, Vec<Value>, Vec<Value>, Vec<Value>) =
        Default::default();
    for (material, shape) in shapes.iter().enumerate() {
        let floats: Vec<u8> = shape.positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        let indices: Vec<u8> = shape.triangles.as_flattened().iter().flat_map(|i| i.to_le_bytes()).collect();
        for (bytes, component, kind, count) in
            [(floats, 5126, "VEC3", shape.positions.len()), (indices, 5125, "SCALAR", 3 * shape.triangles.len())]
        {
            views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
            accessors.push(
                json!({ "bufferView": views.len() - 1, "componentType": component, "type": kind, "count": count }),
            );
            binary.extend(bytes);
        }
        let last = accessors.len() - 1;
        let primitive = json!({ "attributes": { "POSITION": last - 1 }, "indices": last, "material": material });
        meshes.push(json!({ "primitives": [primitive] }));
    }
    // A light shines along its node's −Z: turned by a quarter about X, downwards.
    let (half, lights) = (std::f64::consts::FRAC_1_SQRT_2, json!([{ "type": "directional", "intensity": 1.0 }]));
    let light = json!({ "rotation": [-half, 0, 0, half], "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    let wax = json!({ "name": "Wax", "extensions": { "KHR_materials_volume": { "thicknessFactor": 1 } } });
    let black = json!({ "name": "Plate", "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1] } });
    let document = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [{ "mesh": 0 }, { "mesh": 1 }, light], "meshes": meshes, "materials": [wax, black],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_volume"],
        "extensions": { "KHR_lights_punctual": { "lights": lights } },
        "buffers": [{ "uri": "scene.bin", "byteLength": binary.len() }], "bufferViews": views, "accessors": accessors,
    });
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("scene.gltf"), document.to_string()).expect("writes");
    fs::write(folder.path().join("scene.bin"), binary).expect("writes");
    folder
}

fn run(folder: &tempfile::TempDir, target: f64, seed: u64) -> (String, Value) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sample-surface"));
    command.current_dir(folder.path()).args(["scene.gltf", "-o", "own.cloud", "--stats", "own.json"]);
    command.args(["--for-medium", "skin1", "--target-error", &target.to_string(), "--seed", &seed.to_string()]);
    let output = command.output().expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{message}");
    let statistics = fs::read(folder.path().join("own.json")).expect("statistics");
    (message, serde_json::from_slice(&statistics).expect("JSON"))
}

/// Runs of so many seeds. Twice a standard error is exceeded by 5 % of them at most. It is by fewer here, because one
/// cloud has less error than the mean of the trials that it is judged by: of many seeds by none, the error being a
/// quarter of the target, so that new seeds would fail less than once in a thousand times.
fn assert_met(size: f64, half_cube: f64, target: f64, own: std::ops::Range<u64>) {
    let seeds = own.end - own.start;
    let folder = under_a_hole(size, half_cube);
    let (mut errors, mut samples) = (Vec::new(), 0.0);
    for seed in own {
        let (message, statistics) = run(&folder, target, seed);
        let flux = statistics["mean_flux_w"][0].as_f64().expect("a number");
        samples += statistics["samples_drawn"].as_f64().expect("a count") / seeds as f64;
        errors.push((flux / (size * size) - 1.0).abs());
        assert!(!message.contains(" 0.00 %"), "seed {seed}: {message}");
    }
    let beyond = |factor: f64| errors.iter().filter(|error| **error > factor * target).count();
    let worst = errors.iter().fold(0.0f64, |worst, error| worst.max(*error));
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / seeds as f64).sqrt();
    println!(
        "hole of {size} m: {} of {seeds} beyond {target}, {} beyond twice that; root mean square {rms:.4}, worst {worst:.4}; \
         {samples:.3e} samples",
        beyond(1.0),
        beyond(2.0)
    );
    assert!(20 * beyond(2.0) <= errors.len(), "{} of {seeds} are beyond twice the target", beyond(2.0));
    assert!(rms <= target, "the error is {rms}, not {target}");
}

/// Seen to catch, with the first small difference of two halves believed: a third of the light missing at a target of 10 %.
#[test]
fn a_small_hole_is_no_luck() {
    if cfg!(feature = "slow") {
        assert_met(2e-3, 50e-3, 0.05, 0..200);
    } else {
        // A smaller cube, of which a larger share is lit.
        assert_met(2e-3, 35e-3, 0.1, 0..5);
    }
}

/// Of the first samples few find the hole, or none.
///
/// Seen to catch: no lit sample taken for an error of 0 %.
#[test]
fn a_hole_that_is_missed_is_not_without_error() {
    if cfg!(feature = "slow") {
        assert_met(0.5e-3, 25e-3, 0.05, 0..200);
    } else {
        assert_met(0.5e-3, 19e-3, 1.0, 5..6);
    }
}

/// Of a scene that is dark nothing is known, and that is said.
///
/// Seen to catch: an error of 0 % of 65536 samples.
#[test]
#[cfg(feature = "slow")]
fn of_darkness_no_error_is_told() {
    let (message, statistics) = run(&under_a_hole(1e-9, 50e-3), 0.05, 0);
    assert!(message.contains("warning: none of 16777216 samples carries light"), "{message}");
    assert!(message.contains("relative error is unknown") && !message.contains(" 0.00 %"), "{message}");
    assert_eq!(statistics["samples_stored"], 0);
}
