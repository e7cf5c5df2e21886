//! Tests of the gates of the command line.

use compare::metric::{GATES, GateKind, GateValue};
use formats::image::Image;

use crate::support::{Compare, Verdict, WIDTH, bench, picture, scale};

/// The options of every gate, with a limit of zero.
fn all_gates() -> Vec<String> {
    let options = |kind: &GateKind| match kind.value {
        GateValue::Samples(_) => format!("--{}", kind.name),
        GateValue::Pixels(_) => format!("--{}=0@0", kind.name),
        GateValue::Channel(_) | GateValue::Picture(_) => format!("--{}=0", kind.name),
    };
    GATES.iter().map(options).collect()
}

/// Seen to catch: a gate on a metric that does not exist.
#[test]
fn identical_images_pass_every_gate() {
    let bench = bench();
    bench.compare(|_| (), &[]).passes();
    let gates = all_gates();
    let gates: Vec<&str> = gates.iter().map(String::as_str).collect();
    bench.compare(|_| (), &gates).passes();
    bench.compare(|_| (), &[&gates[..], &["--layer", "all"]].concat()).passes();
}

#[test]
fn one_per_cent_brighter_is_a_bias() {
    let bench = bench();
    let brighter = |image: &mut Image| scale(image, 1.01);
    bench.compare(brighter, &[]).passes();
    bench.compare(brighter, &["--max-bias", "0.02"]).passes();
    bench.compare(brighter, &["--max-bias", "0.005"]).fails("max-bias 0.0");
    bench.compare(|image| scale(image, 0.99), &["--max-bias", "0.005"]).fails("max-bias 0.0");
}

/// If red rises and blue falls, the mean of the layer stays.
#[test]
fn a_shift_of_color_is_a_bias() {
    let shift = |image: &mut Image| {
        image.channels[0].samples.iter_mut().for_each(|sample| *sample += 0.1);
        image.channels[2].samples.iter_mut().for_each(|sample| *sample -= 0.1);
    };
    bench().compare(shift, &["--max-bias", "0.01"]).fails("max-bias");
}

#[test]
fn noise_without_bias_is_found() {
    let noisy = |image: &mut Image| {
        for channel in &mut image.channels {
            channel
                .samples
                .iter_mut()
                .enumerate()
                .for_each(|(i, sample)| *sample += if i % 2 == 0 { 0.5 } else { -0.5 });
        }
    };
    let bench = bench();
    bench.compare(noisy, &["--max-bias", "1e-6"]).passes();
    bench.compare(noisy, &["--max-rmse", "0.4"]).fails("max-rmse 0.5 > ");
    bench.compare(noisy, &["--max-rmse", "0.5"]).passes();
    bench.compare(noisy, &["--max-relmse", "0.01"]).fails("max-relmse");
}

#[test]
fn values_that_are_not_finite_fail() {
    let bench = bench();
    let one = |image: &mut Image| image.channels[4].samples[5] = f32::NAN;
    bench.compare(one, &[]).fails("nonfinite 1 > 0");
    bench.compare(one, &["--allow-nonfinite"]).passes();
    bench.compare(|image| image.channels[0].samples[0] = f32::INFINITY, &[]).fails("nonfinite 1 > 0");
    let all = |image: &mut Image| scale(image, f32::NAN);
    bench.compare(all, &[]).fails("nonfinite 1920 > 0");
    for gate in [["--max-bias", "9"], ["--max-relmse", "9"], ["--max-rmse", "9"], ["--max-abs", "9"]] {
        bench.compare(all, &[&gate[..], &["--allow-nonfinite"]].concat()).fails(&format!("{} NaN > 9", &gate[0][2..]));
    }
    bench.compare(all, &["--allow-nonfinite", "--max-outliers", "383@1e30"]).fails("max-outliers 384 > 383");
}

#[test]
fn equal_nans_do_not_cancel() {
    let bench = bench();
    let mut image = picture();
    image.channels[1].samples[3] = f32::NAN;
    bench.write_image("reference.exr", &image);
    bench.write_image("test.exr", &image);
    bench.judge("test.exr", &[]).fails("nonfinite 2 > 0");
    bench.judge("test.exr", &["--allow-nonfinite", "--max-bias", "1"]).fails("max-bias NaN > 1");
}

#[test]
fn one_bright_pixel_is_an_outlier() {
    let bench = bench();
    let firefly = |image: &mut Image| image.channels[1].samples[2 * WIDTH + 3] = 1e4;
    let run = bench.compare(firefly, &["--max-abs", "100"]);
    run.fails("max-abs 9");
    assert!(run.stdout.contains(" 3,2 "), "{}", run.stdout);
    bench.compare(firefly, &["--max-outliers", "0@1"]).fails("max-outliers 1 > 0");
    bench.compare(firefly, &["--max-outliers", "1@1"]).passes();
}

#[test]
fn one_bit_fails_the_bitwise_gate_in_any_layer() {
    let bench = bench();
    let flip = |image: &mut Image| {
        let sample = &mut image.channels[4].samples[0];
        *sample = f32::from_bits(sample.to_bits() ^ 1);
    };
    bench.compare(flip, &["--exact"]).fails("exact 1 > 0 (variance)");
    bench.compare(flip, &["--exact", "--layer", "beauty"]).passes();
}

#[test]
fn gates_judge_beauty_by_default() {
    let bench = bench();
    let deeper = |image: &mut Image| image.channels[3].samples.iter_mut().for_each(|sample| *sample *= 2.0);
    bench.compare(deeper, &["--max-bias", "0.1"]).passes();
    bench.compare(deeper, &["--max-bias", "0.1", "--layer", "Z"]).fails("max-bias 1 > 0.1 (Z Z)");
    bench.compare(deeper, &["--max-bias", "0.1", "--layer", "all"]).fails("max-bias 1 > 0.1 (Z Z)");
    bench.compare(deeper, &["--layer", "diffuse"]).cannot_judge(&["`diffuse`", "beauty, Z, variance", "--layer"]);
}
