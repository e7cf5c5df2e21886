//! `calibrate` and the images of its calibrations, as users start the programs.

mod bad_input;
mod calibrations;
mod images;

use test_support::{Bench, data};

/// The slab of `data/`.
fn slab() -> String {
    data("scenes/slab.glb")
}

/// A folder with a cloud of the slab.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.succeed("sample-surface", &[&slab(), "-n", "2k", "-o", "slab.cloud", "--quiet"]);
    bench
}

/// The arguments of a quick calibration of the slab in marble to `output`, and more of them.
fn quick<'a>(scene: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let own = ["slab.cloud", scene, "--bssrdf", "half-space", "--medium", "marble", "--walks", "600", "-o", output];
    [&own, more].concat()
}
