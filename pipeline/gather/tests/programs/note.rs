//! `--note` stands for the settings of the note (Frisvad and Dal Corso 2018).

use test_support::{Bench, data};

/// `--note` gives byte for byte what the options give that it stands for, and an option beside it wins.
///
/// Seen to catch: one of the five defaults left as it is without `--note`.
#[test]
fn the_note_in_one_word() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let cloud = |name: &str, how: &[&str]| {
        bench.succeed("sample-surface", &[&[&scene, "-n", "3k", "--quiet", "-o", name], how].concat());
        bench.read(name)
    };
    let spelled = ["--choice", "uniform", "--pattern", "independent", "--normals", "geometric"];
    let note = cloud("note.cloud", &["--note"]);
    assert!(note == cloud("spelled.cloud", &spelled) && note != cloud("default.cloud", &[]));
    let stratified = [&spelled[..2], &spelled[4..]].concat();
    assert!(cloud("own.cloud", &["--note", "--pattern", "stratified"]) == cloud("stratified.cloud", &stratified));

    let image = |name: &str, how: &[&str]| {
        let own = ["note.cloud", &scene, "--view", &view, "--medium", "skin1", "--spp", "2", "--no-timings", "--quiet"];
        bench.succeed("gather", &[&own[..], &["--width", "16", "--height", "16", "-o", name], how].concat());
        bench.read(name)
    };
    let dipole = ["--bssrdf", "directional-dipole", "--calibration", "none"];
    let spelled = [&dipole[..], &["--estimator", "roulette", "--roulette", "mean", "--normals", "geometric"]].concat();
    let note = image("note.exr", &["--note"]);
    assert!(note == image("spelled.exr", &spelled) && note != image("default.exr", &["--normals", "geometric"]));
    let exhaustive = [&dipole[..], &["--estimator", "exhaustive", "--normals", "geometric"]].concat();
    assert!(image("own.exr", &["--note", "--estimator", "exhaustive"]) == image("exhaustive.exr", &exhaustive));
}
