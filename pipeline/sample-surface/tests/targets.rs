//! `--target-error`: the standard error of the clouds meets the target, and not only by chance. All light comes through
//! a small hole in a black plate, so that the flux that enters is known exactly and the two halves of a cloud differ by
//! one value all over the surface.

use glam::{DVec3, Vec3};
use serde_json::Value;
use test_support::{
    Bench,
    meshes::{Light, Mesh, Part, asset, slab},
};

/// A plate with a square hole in the middle, both given by half their sizes, m.
fn plate(half: f64, hole: f64, height: f64) -> Mesh {
    let mut plate = Mesh::default();
    for [left, right, front, back] in
        [[-half, -hole, -half, half], [hole, half, -half, half], [-hole, hole, -half, -hole], [-hole, hole, hole, half]]
    {
        let first = plate.positions.len() as u32;
        let corners = [[left, front], [right, front], [right, back], [left, back]];
        plate.positions.extend(corners.map(|[x, y]| Vec3::new(x as f32, y as f32, height as f32)));
        plate.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    plate
}

/// A scene in a folder of its own: a cube of half the size `half`, m, under a plate with a square hole, and a light of
/// 1 W/m² from above.
fn under_a_hole(size: f64, half_cube: f64) -> Bench {
    let cube = Part::translucent(slab(DVec3::splat(half_cube), 1));
    let plate = plate(4.0 * half_cube, 0.5 * size, 1.2 * half_cube);
    let plate = Part { color: DVec3::ZERO, ..Part::opaque(plate) };
    let light = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
    let bench = Bench::new();
    bench.write("scene.glb", asset(&[cube, plate], &[light]).glb());
    bench
}

fn run(bench: &Bench, target: f64, seed: u64) -> (String, Value) {
    let [target, seed] = [target.to_string(), seed.to_string()];
    let files = ["scene.glb", "-o", "own.cloud", "--stats", "own.json"];
    let aim = ["--for-medium", "skin1", "--target-error", &target, "--seed", &seed];
    (bench.says("sample-surface", &[&files[..], &aim].concat()), bench.json("own.json"))
}

/// Checks runs with several seeds: at most 5 % of them exceed twice the standard error. Fewer do here, because a cloud
/// has a smaller error than the mean of the trials by which it is judged: the error is a quarter of the target, and
/// none of many seeds exceeded it, so that new seeds would fail less than once in a thousand times.
fn assert_met(size: f64, half_cube: f64, target: f64, own: std::ops::Range<u64>) {
    let seeds = own.end - own.start;
    let bench = under_a_hole(size, half_cube);
    let (mut errors, mut samples) = (Vec::new(), 0.0);
    for seed in own {
        let (message, statistics) = run(&bench, target, seed);
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

/// Seen to catch: the first small difference between the halves taken for the error, by which a third of the light was
/// missing at a target of 10 %.
#[test]
fn a_small_hole_is_no_luck() {
    if cfg!(feature = "slow") {
        assert_met(2e-3, 50e-3, 0.05, 0..200);
    } else {
        // A larger share of the smaller cube is lit.
        assert_met(2e-3, 35e-3, 0.1, 0..5);
    }
}

/// Few of the first samples find the hole, or none does.
///
/// Seen to catch: the error of a cloud without a lit sample taken for 0 %.
#[test]
fn a_hole_that_is_missed_is_not_without_error() {
    if cfg!(feature = "slow") {
        assert_met(0.5e-3, 25e-3, 0.05, 0..200);
    } else {
        assert_met(0.5e-3, 19e-3, 1.0, 5..6);
    }
}

/// The error in a dark scene is unknown, and the program says so.
///
/// Seen to catch: an error of 0 % claimed for 65536 samples.
#[test]
#[cfg(feature = "slow")]
fn of_darkness_no_error_is_told() {
    let (message, statistics) = run(&under_a_hole(1e-9, 50e-3), 0.05, 0);
    assert!(message.contains("warning: none of 16777216 samples carries light"), "{message}");
    assert!(message.contains("relative error is unknown") && !message.contains(" 0.00 %"), "{message}");
    assert_eq!(statistics["samples_stored"], 0);
}
