//! Tests of faults that other tools do not find: each fails the limits of docs/compare.md, which correct renders pass.
//!
//! Seen to catch: each of the three limits left out.

use formats::image::{Channel, Image};

use crate::support::{Compare, Verdict, documented};
use test_support::{Bench, Random, Run};

const SIDE: usize = 64;
/// The error of a pixel of a correct render, and the error of its cloud, which all pixels share.
const NOISE: f64 = 0.005;
const SHARED: f64 = 0.0005;

/// A picture with values from 0.2 to 0.8, times `gain`, with noise.
fn image(gain: f64, noise: f64, seed: u64) -> Image {
    let mut random = Random(seed);
    let channels = ["R", "G", "B"].into_iter().zip([0.0, 1.0, 2.0]).map(|(name, phase)| {
        let truth = |i: usize| 0.5 + 0.3 * ((i % SIDE) as f64 / 9.0 + phase).sin() * ((i / SIDE) as f64 / 7.0).cos();
        let samples = (0..SIDE * SIDE).map(|i| (truth(i) * gain + noise * random.normal()) as f32).collect();
        Channel { name: name.to_owned(), samples }
    });
    Image { width: SIDE, height: SIDE, channels: channels.collect(), ..Image::default() }
}

fn correct(seed: u64) -> Image {
    image(1.0 + SHARED * Random(seed + 1000).normal(), NOISE, seed)
}

/// A bench with the limits of the page, except those of a layer that these images lack.
fn bench() -> Bench {
    let bench = crate::support::bench();
    bench.write_image("reference.exr", &correct(0));
    let mut limits = documented("## Limits file");
    limits["limits"].as_array_mut().unwrap().retain(|limit| limit.get("layer").is_none());
    assert_eq!(limits["limits"].as_array().unwrap().len(), 3);
    bench.write("limits.json", limits.to_string());
    bench
}

fn judge(bench: &Bench, image: &Image) -> Run {
    bench.write_image("test.exr", image);
    bench.judge("test.exr", &["--limits", bench.path("limits.json").to_str().unwrap()])
}

#[test]
fn correct_renders_pass() {
    let bench = bench();
    (1..=20).for_each(|seed| judge(&bench, &correct(seed)).passes());
}

#[test]
fn every_fault_fails() {
    let bench = bench();
    let fails = |change: fn(&mut Image), gate: &str| {
        let mut image = correct(1);
        change(&mut image);
        let run = judge(&bench, &image);
        run.fails("");
        assert!(run.verdict().contains(gate), "{}", run.verdict());
    };
    fails(|image| image.channels[1].samples[77] = f32::NAN, "nonfinite 1 > 0");
    fails(|image| image.channels.iter_mut().for_each(|channel| channel.samples.fill(f32::NAN)), "nonfinite 12288 > 0");
    fails(|image| image.channels.iter_mut().for_each(|channel| channel.samples[77] = 1e4), "max-outliers 1 > 0");
    fails(|image| *image = self::image(1.01, NOISE, 1), "max-bias");
    fails(|image| *image = self::image(1.0, 0.02, 1), "max-relmse");
}

/// Each limit is needed, because its fault passes the other two.
#[test]
fn each_fault_fails_by_its_own_limit() {
    let bench = bench();
    let gates = |image: &Image| {
        let run = judge(&bench, image);
        let verdict = run.verdict().strip_prefix("FAIL ").unwrap().to_owned();
        verdict.split("; ").map(|gate| gate.split(' ').next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(gates(&image(1.01, NOISE, 1)), ["max-bias"]);
    assert_eq!(gates(&image(1.0, 0.02, 1)), ["max-relmse"]);
    let mut firefly = correct(1);
    firefly.channels[0].samples[77] += 0.5;
    assert_eq!(gates(&firefly), ["max-outliers"]);
}
