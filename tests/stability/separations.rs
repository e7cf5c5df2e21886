//! Separations of entry and exit: the same point, in line with a normal or with the light, far away.
//!
//! Lengths are mean free paths here: `σ_t' = 1/m`.

use crate::evaluate::{DIRECTIONAL, along_plane, assert_close, assert_is, bare, gather, onto_plane, out_of_plane};
use bssrdf::{Exitant, Medium, Model, Separation, fresnel};
use glam::DVec3;
use std::f64::consts::PI;
use test_support::{
    pipeline::{MODELS, gray},
    random::Random,
};

/// α' = 0.9.
fn medium() -> Medium {
    gray(0.1, 0.9, 0.0, 1.3)
}

/// A unit vector `angle` from −Z.
fn down(angle: f64) -> DVec3 {
    DVec3::new(angle.sin(), 0.0, -angle.cos())
}

/// `x = 0`: the guards of the mirror normal and of a division by the distance. The standard dipole has its closed
/// form, and there is no jump beside the sample.
#[test]
fn exit_point_exactly_at_a_sample() {
    let medium = medium();
    let light = onto_plane(DVec3::new(0.5, 0.2, 1.0));
    let at = gather(&medium, &light, &out_of_plane(0.0));
    assert_close(&at, 1e-5);
    for (at, near) in at.iter().zip(gather(&medium, &light, &out_of_plane(1e-9))) {
        // The azimuth of the half-space model turns within 5·10⁻⁴ mean free paths.
        let tolerance = if at.model == Model::HalfSpace { 1e-5 } else { 1e-7 };
        assert_is("beside the sample", near.exact, at.exact, tolerance);
    }
    let transport = 0.3f64.sqrt();
    let source = |z: f64| (1.0 + transport * z) * (-transport * z).exp() / (z * z);
    let virtual_depth = 1.0 + 4.0 / 3.0 * medium.interface.reflection_egan;
    let entry = fresnel::transmittance(light.normal.dot(light.direction), 1.3);
    let expected = entry * 0.9 / (4.0 * PI * PI) * (source(1.0) + source(virtual_depth));
    let [.., standard] = at;
    assert_eq!(standard.model, Model::StandardDipole);
    assert_is("standard dipole", standard.exact, DVec3::splat(expected), 1e-14);
}

/// `x = 0` on an edge, where the light runs along the other face: `μ0 → 0`. The source then approaches the exit
/// point, and 1/d³ leaves the range of float32 and finally of float64: `S` is 0 there, as it is at `d = 0`.
#[test]
fn light_along_the_exit_surface() {
    for exponent in 0..=320 {
        let mu0 = 10f64.powi(-exponent);
        for x in [0.0, 1e-160, 1e-100, 1e-38, 1e-20, 1e-12, 1e-6, 1e-3, 1.0] {
            for across in [DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::NEG_X] {
                let refracted = DVec3::new(-mu0, 0.0, -1.0).normalize();
                bare(
                    &medium(),
                    &Separation { offset: across * x, normal_in: DVec3::Z, refracted, normal_out: DVec3::X },
                );
            }
        }
    }
}

/// `μ0 ≤ 0` is lit from behind, `μ0 > 0` from the front, and `d_r` jumps between them (docs/method.md section 8).
#[test]
fn the_depth_of_the_source_jumps_where_the_light_turns_from_behind() {
    let separation = |mu0: f64| Separation {
        offset: DVec3::new(0.0, 0.05, 0.0),
        normal_in: DVec3::Z,
        refracted: DVec3::new(-mu0, 0.0, -1.0).normalize(),
        normal_out: DVec3::X,
    };
    let value = |mu0: f64| bare(&medium(), &separation(mu0))[DIRECTIONAL].exact.x;
    for zero in [0.0, -0.0, -1e-300] {
        assert_eq!(value(zero), value(-1e-30));
    }
    assert!((value(1e-9) / value(0.0) - 1.0).abs() > 0.1, "no jump: {} {}", value(1e-9), value(0.0));
}

/// `x ∥ n_i`, as on the far side of a sheet: the direction of the light then gives the mirror normal, the limit for
/// points beside the line on the side of the light (docs/method.md 5.6).
#[test]
fn offset_along_the_entry_normal() {
    for angle in [1e-9, 1e-4, 0.3, 0.7] {
        for normal_out in [DVec3::NEG_Z, DVec3::new(0.6, 0.0, -0.8), DVec3::Y] {
            for depth in [1e-3, 1.0, 30.0] {
                let behind = |aside: f64| Separation {
                    offset: DVec3::new(-aside, 0.0, -1.0) * depth,
                    normal_in: DVec3::Z,
                    refracted: down(angle),
                    normal_out,
                };
                let at = bare(&medium(), &behind(0.0));
                assert_close(&at[1..], 1e-5);
                for (at, near) in at.iter().zip(bare(&medium(), &behind(1e-8))) {
                    assert_is(&format!("{angle} {normal_out} {depth}"), near.exact, at.exact, 1e-5);
                }
            }
        }
    }
}

/// `x`, `n_i`, `ω12` and `n_o` in one line: the mirror normal is undefined, and `a = b = 0`.
#[test]
fn everything_in_one_line() {
    for normal_out in [DVec3::Z, DVec3::NEG_Z] {
        for depth in [1e-6, 1.0, 1e3] {
            let offset = DVec3::NEG_Z * depth;
            let line = Separation { offset, normal_in: DVec3::Z, refracted: DVec3::NEG_Z, normal_out };
            let values = bare(&medium(), &line);
            assert_close(&values, 1e-5);
            assert!(values[DIRECTIONAL].exact.x > 0.0 || depth != 1.0 || normal_out == DVec3::Z, "{values:?}");
        }
    }
}

/// `x` nearly parallel to ω12, with n_i in the same line or not: `r² − (x·ω12)²` would lose its digits in float32 or
/// become negative (docs/method.md section 8).
#[test]
fn offset_along_the_refracted_light() {
    let mut random = Random(5);
    let (mut far_off, mut tried) = (0, 0);
    for _ in 0..10_000 {
        let refracted = down(random.between(0.0, 0.8));
        let aside = 10f64.powf(random.between(-12.0, -2.0));
        let offset = (refracted + random.direction() * aside) * 10f64.powf(random.between(-3.0, 1.0));
        let normal_out = if random.uniform() < 0.5 { refracted } else { random.direction() };
        for normal_in in [DVec3::Z, -refracted] {
            let value = bare(&medium(), &Separation { offset, normal_in, refracted, normal_out })[DIRECTIONAL];
            if normal_in == DVec3::Z && value.exact.x > 1e-6 {
                tried += 1;
                far_off += u32::from(value.error() > 1e-3);
            }
        }
    }
    assert!(tried > 2000 && far_off < tried / 200, "{far_off} of {tried} are far off");
}

/// `σ_tr r` large: `S` vanishes, and no growing exponential overflows on the way.
#[test]
fn far_away_with_absorption() {
    for distance in [1e3, 1e4, 1e8, 1e15, 1e18] {
        for value in gather(&medium(), &onto_plane(DVec3::Z), &out_of_plane(distance)) {
            assert_eq!(value.fast, DVec3::ZERO);
            assert!(value.exact.x < 1e-200);
        }
    }
}

/// σ_a = 0: `S ~ r⁻³`, though the two sources of a dipole cancel to the last digits (docs/method.md section 9).
#[test]
fn far_away_without_absorption() {
    let medium = gray(0.0, 1.0, 0.0, 1.3);
    let first = bare(&medium, &along_plane(1e3));
    for distance in [1e4, 1e5, 1e6] {
        let values = bare(&medium, &along_plane(distance));
        for (first, value) in first.iter().zip(values) {
            let power = (distance / 1e3).powi(3);
            assert_is("exact", value.exact * power, first.exact, 1e-4 * distance / 1e4);
            assert_is("fast", value.fast * power, first.fast, 1e-4);
        }
    }
    for distance in [1e9, 1e12, 1e18, 1e30] {
        bare(&medium, &along_plane(distance));
    }
}

/// Light that cannot enter, and a viewer behind the surface: `S = 0` (docs/method.md 1.3).
#[test]
fn light_and_viewer_below_the_surface() {
    for direction in [DVec3::NEG_Z, DVec3::X, DVec3::new(1.0, 0.0, -1e-7)] {
        for value in gather(&medium(), &onto_plane(direction), &out_of_plane(1.0)) {
            assert_eq!((value.exact, value.fast), (DVec3::ZERO, DVec3::ZERO));
        }
    }
    let behind = Exitant { direction: DVec3::NEG_Z, ..out_of_plane(1.0) };
    for model in MODELS {
        let values = bssrdf::evaluate(&*model.of(&medium()), 1.3, 0, &onto_plane(DVec3::Z), &behind);
        assert!(values.full == 0.0 && values.gather > 0.0);
    }
}
