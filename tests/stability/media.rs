//! Media at the ends of their range: no scattering, no absorption, neither; strong asymmetry; all scales.

use crate::evaluate::{along_plane, assert_close, assert_is, bare, gather, onto_plane, out_of_plane};
use bssrdf::{Coefficients, Medium, Model, Separation, built_in, built_in_names};
use glam::DVec3;
use test_support::pipeline::{MODELS, gray, medium};

/// Separations lit from the front, and from behind through a sheet; `scale` in m.
fn separations(scale: f64) -> [Separation; 3] {
    let [normal_in, normal_out] = [DVec3::Z, DVec3::new(0.6, 0.0, 0.8)];
    let refracted = DVec3::new(0.36, 0.48, -0.8);
    [
        along_plane(0.75 * scale),
        Separation { offset: DVec3::new(0.5, 0.25, -0.125) * scale, normal_in, refracted, normal_out },
        Separation { offset: DVec3::new(0.5, 0.25, -1.0) * scale, normal_in, refracted, normal_out: DVec3::NEG_Z },
    ]
}

/// σ_a = 0: no σ_tr to divide by, and the roulette accepts everything: the sum is the exhaustive one.
#[test]
fn no_absorption() {
    let medium = gray(0.0, 1.0, 0.0, 1.3);
    for model in MODELS {
        assert_eq!(model.of(&medium).transport(), [0.0; 3]);
    }
    for x in [0.0, 1e-6, 1.0, 100.0, 1e6] {
        let values = gather(&medium, &onto_plane(DVec3::new(0.3, 0.1, 1.0)), &out_of_plane(x));
        assert_close(&values, 2e-5);
        assert!(values.iter().all(|v| v.fast.min_element() > 0.0));
    }
    // The value is the limit of decreasing absorption.
    let little = gray(1e-12, 1.0, 0.0, 1.3);
    for separation in separations(1.0) {
        for (none, little) in bare(&medium, &separation).iter().zip(bare(&little, &separation)) {
            assert_is(none.model.name(), little.exact, none.exact, 1e-4);
        }
    }
}

/// σ_s = 0, or one channel of it: `S = 0` exactly, although (5.10) tends to another value there.
#[test]
fn no_scattering() {
    let clear = |sigma_a| Coefficients { sigma_a, sigma_s: 0.0, asymmetry: 0.5 };
    let milky = Coefficients { sigma_a: 1.0, sigma_s: 2.0, asymmetry: 0.5 };
    let half = medium([clear(1.0), milky, clear(0.0)], 1.3);
    for separation in separations(1.0) {
        for value in bare(&gray(1.0, 0.0, 0.0, 1.3), &separation) {
            assert_eq!((value.exact, value.fast), (DVec3::ZERO, DVec3::ZERO));
        }
        for (half, all) in bare(&half, &separation).iter().zip(bare(&medium([milky; 3], 1.3), &separation)) {
            assert_eq!((half.exact, half.fast), (all.exact * DVec3::Y, all.fast * DVec3::Y));
        }
    }
    gather(&half, &onto_plane(DVec3::Z), &out_of_plane(1.0));
    assert!(!half.is_clear());
}

/// σ_t = 0: a vacuum has no mean free path, and scatters nothing.
#[test]
fn vacuum() {
    let vacuum = gray(0.0, 0.0, 0.0, 1.3);
    assert!(vacuum.is_clear());
    assert!(MODELS.iter().all(|model| model.of(&vacuum).transport() == [0.0; 3]));
    for separation in separations(1.0) {
        for value in bare(&vacuum, &separation) {
            assert_eq!((value.exact, value.fast), (DVec3::ZERO, DVec3::ZERO));
        }
    }
    gather(&vacuum, &onto_plane(DVec3::Z), &out_of_plane(1.0));
}

/// Only `σ_s' = (1 − g) σ_s` matters, except for the depth of light from behind, `1/(3σ_t)`, and for the power of the
/// half-space model, by a factor of the angle of the light, up to 4, which is the same in all channels.
#[test]
fn asymmetry_near_its_ends() {
    for g in [-0.99, -0.5, 0.5, 0.9, 0.99, 0.9999] {
        let [sharp, soft] = [gray(0.1, 0.9 / (1.0 - g), g, 1.3), gray(0.1, 0.9, 0.0, 1.3)];
        for (k, separation) in separations(1.0).iter().enumerate() {
            let values = bare(&sharp, separation);
            assert_close(&values, 1e-5);
            for (sharp, soft) in values.iter().zip(bare(&soft, separation)) {
                let expected = match sharp.model {
                    Model::DirectionalDipole if k == 2 => continue,
                    Model::HalfSpace => {
                        let factor = sharp.exact.x / soft.exact.x;
                        assert!((0.2..4.0).contains(&factor), "g = {g}: {factor}");
                        soft.exact * factor
                    }
                    _ => soft.exact,
                };
                assert_is(&format!("g = {g}, {}", sharp.model.name()), sharp.exact, expected, 1e-10);
            }
        }
        gather(&sharp, &onto_plane(DVec3::X + DVec3::Z), &out_of_plane(0.1));
    }
}

/// Albedo 1 − 10⁻⁹: no digits are lost against σ_a = 0, from which the result differs by `σ_tr r`.
#[test]
fn almost_no_absorption() {
    let [almost, none] = [gray(1e-9, 1.0 - 1e-9, 0.0, 1.3), gray(0.0, 1.0, 0.0, 1.3)];
    for separation in separations(1.0) {
        let values = bare(&almost, &separation);
        assert_close(&values, 1e-5);
        for (almost, none) in values.iter().zip(bare(&none, &separation)) {
            assert_is(almost.model.name(), almost.exact, none.exact, 1e-3);
        }
    }
}

/// Coefficients so small that their products leave the range of float64; files may hold them.
#[test]
fn coefficients_that_underflow() {
    for tiny in [1e-30, 1e-60, 1e-120, 1e-160, 1e-200, 1e-300, f64::MIN_POSITIVE, 5e-324] {
        for (sigma_a, sigma_s) in [(0.0, tiny), (tiny, tiny), (tiny, 0.0), (1.0, tiny), (tiny, 1.0)] {
            let medium = gray(sigma_a, sigma_s, 0.0, 1.3);
            assert!(MODELS.iter().all(|model| model.of(&medium).transport().iter().all(|t| t.is_finite())));
            for separation in separations(1.0) {
                bare(&medium, &separation);
            }
            gather(&medium, &onto_plane(DVec3::Z), &out_of_plane(1.0));
        }
    }
}

/// The largest coefficients that a file may hold, on objects of all sizes.
#[test]
fn the_largest_coefficients() {
    for (sigma_a, sigma_s) in [(0.0, 1e12), (1e12, 1e12), (1e12, 1.0), (1.0, 1e12)] {
        for size in [1e-15, 1e-9, 1e-3, 1.0, 1e3, 1e6] {
            for separation in separations(size) {
                bare(&gray(sigma_a, sigma_s, 0.0, 1.3), &separation);
            }
            gather(&gray(sigma_a, sigma_s, 0.0, 1.3), &onto_plane(DVec3::Z), &out_of_plane(size));
        }
    }
}

/// `S(x; σ) = σ_t'² Ŝ(σ_t' x)`: exactly so for powers of two, mean free paths from 10⁻⁶ to 10⁶ of the object and
/// beyond.
#[test]
fn any_scale_is_like_any_other() {
    for name in ["ketchup", "marble"] {
        let first = built_in(name).expect("a built-in medium");
        for exponent in -24..=24 {
            let factor = 2f64.powi(exponent);
            let scale =
                |c: Coefficients| Coefficients { sigma_a: c.sigma_a * factor, sigma_s: c.sigma_s * factor, ..c };
            let other = Medium { channels: first.channels.map(scale), ..first.clone() };
            for (here, there) in separations(2f64.powi(-10)).iter().zip(separations(2f64.powi(-10 - exponent))) {
                for (here, there) in bare(&first, here).iter().zip(bare(&other, &there)) {
                    assert_eq!(here.exact * factor * factor, there.exact, "{name} {exponent}");
                    assert_eq!(here.fast * factor * factor, there.fast, "{name} {exponent}");
                }
            }
        }
    }
}

/// Measured media, from a point to a hundred metres away.
#[test]
fn every_medium_at_every_distance() {
    for name in built_in_names() {
        let medium = built_in(name).expect("a built-in medium");
        for x in (0..60).map(|k| 1e-10 * 10f64.powf(0.2 * f64::from(k))).chain([0.0]) {
            gather(&medium, &onto_plane(DVec3::new(0.6, 0.0, 0.8)), &out_of_plane(x));
        }
    }
}
