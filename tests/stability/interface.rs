//! The interface: equal indices, total reflection, the ends of the fits, grazing light and view.

use crate::evaluate::{assert_close, assert_is, bare, gather, onto_plane, out_of_plane};
use bssrdf::{ETA_MAX, ETA_MIN, Incident, Medium, Model, Separation, fresnel};
use formats::cloud::Sample;
use gather::samples::{Exit, LitSamples};
use glam::{DVec3, Vec3};
use test_support::{
    lit::{scatterer, sum},
    pipeline::{ESTIMATORS, MODELS, gray},
    planted::{alternating, cloud_of},
};

/// α' = 0.9; lengths are mean free paths.
fn medium(eta: f64) -> Medium {
    gray(0.1, 0.9, 0.0, eta)
}

/// Light that enters at an angle and leaves nearby: `S_bare` with the same ω12 for all indices.
fn separation() -> Separation {
    Separation {
        offset: DVec3::new(0.7, 0.3, 0.0),
        normal_in: DVec3::Z,
        refracted: DVec3::new(0.36, 0.48, -0.8),
        normal_out: DVec3::Z,
    }
}

/// The half-space model's numbers are integers in units of 2⁻¹⁰ of a factor of two, which turn at some index, and its
/// table is interpolated in the cosine of the critical angle, 4·10⁻⁴ at an index of 1 + 10⁻⁷.
const TABULATED: f64 = 1e-3;

/// η = 1: everything is transmitted and nothing bends, at any angle.
#[test]
fn equal_indices() {
    for cosine in [1.0, 0.5, 1e-7, 1e-300] {
        let direction = DVec3::new((1.0f64 - cosine * cosine).sqrt(), 0.0, cosine);
        assert_eq!(fresnel::transmittance(cosine, 1.0), 1.0);
        let entry = fresnel::enter(DVec3::Z, direction, 1.0).expect("light from above enters");
        assert_eq!((entry.transmittance, entry.direction), (1.0, -direction));
        assert_close(&gather(&medium(1.0), &onto_plane(direction), &out_of_plane(1.0)), 1e-5);
    }
}

/// η = 1 ± 10⁻⁷ refracts and reflects next to nothing, and `S_bare` is that of equal indices.
///
/// Seen to fail with the published fits, whose branches do not meet at 1: by 0.41 % on either side of it for the
/// directional and the better dipole.
#[test]
fn indices_that_differ_by_a_ten_millionth() {
    for near in [1.0 + 1e-7, 1.0 - 1e-7] {
        let entry = fresnel::enter(DVec3::Z, DVec3::new(0.6, 0.0, 0.8), near).expect("light from above enters");
        assert!((entry.transmittance - 1.0).abs() < 1e-12);
        assert!((entry.direction - DVec3::new(-0.6, 0.0, -0.8)).length() < 1e-6);
        for (same, near) in bare(&medium(1.0), &separation()).iter().zip(bare(&medium(near), &separation())) {
            let [exact, fast] = if same.model == Model::HalfSpace { [TABULATED; 2] } else { [2e-6, 3e-6] };
            assert_is(same.model.name(), near.exact, same.exact, exact);
            assert_is(same.model.name(), near.fast, same.fast, fast);
        }
    }
}

/// From one end of the range of the fits to the other, and in small steps through η = 1.
#[test]
fn no_jump_in_the_index() {
    let ends = [ETA_MIN + 1e-6, ETA_MAX - 1e-6];
    let beside = (-50..=50).map(|k| 1.0 + 0.001 * f64::from(k));
    let beside = beside.chain([1.0f64.next_down(), 1.0 - 1e-7, 1.0f64.next_up()]);
    for eta in (1..=42).map(|k| 0.4 + 0.05 * f64::from(k)).chain(beside).chain(ends) {
        let values = bare(&medium(eta), &separation());
        assert_close(&values, 1e-5);
        for (value, near) in values.iter().zip(bare(&medium(eta + 1e-7), &separation())) {
            assert!(value.exact.x > 0.0, "{value:?} at {eta}");
            let tolerance = if value.model == Model::HalfSpace { TABULATED } else { 1e-5 };
            assert_is(&format!("{} at {eta}", value.model.name()), near.exact, value.exact, tolerance);
        }
    }
}

/// η = 0.7 beyond the critical angle: no light enters, whatever the estimator, and none leaves towards the camera.
#[test]
fn total_reflection_outside() {
    let sine_beyond = onto_plane(DVec3::new(0.71, 0.0, (1.0f64 - 0.71 * 0.71).sqrt()));
    let sine_within = onto_plane(DVec3::new(0.69, 0.0, (1.0f64 - 0.69 * 0.69).sqrt()));
    let [beyond, within] = [sine_beyond, sine_within].map(|light| gather(&medium(0.7), &light, &out_of_plane(-1.0)));
    for (value, within) in beyond.iter().zip(within) {
        assert_eq!((value.exact, value.fast), (DVec3::ZERO, DVec3::ZERO));
        assert!(within.exact.min_element() > 0.0 && within.fast.min_element() > 0.0);
    }
    let direction = sine_beyond.direction;
    let sample = Sample { position: Vec3::ZERO, normal: DVec3::Z, direction, flux: Vec3::ONE };
    let cloud = cloud_of(&alternating([sample; 40]));
    for half in cloud.meta().materials[0].halves {
        let samples = LitSamples::new(&cloud, &half, 0.7);
        let exit = Exit::new(DVec3::X, DVec3::Z, 3);
        for (model, estimator) in MODELS.into_iter().flat_map(|m| ESTIMATORS.map(|e| (m, e))) {
            let radiance = sum(&scatterer(model, &medium(0.7)), &samples, &exit, estimator).radiance;
            assert_eq!(radiance, DVec3::ZERO, "{model:?} {estimator:?}");
        }
    }
    assert_eq!(fresnel::transmittance(direction.z, 0.7), 0.0);
    for model in MODELS {
        let exit = bssrdf::Exitant { direction, ..out_of_plane(1.0) };
        let values = bssrdf::evaluate(&*model.of(&medium(0.7)), 0.7, 0, &onto_plane(DVec3::Z), &exit);
        assert!(values.full == 0.0 && values.gather > 0.0);
    }
}

/// At the critical angle itself `t = 0`: rounding must not make the radicand negative.
#[test]
fn the_critical_angle_itself() {
    for k in -50..=50 {
        let sine = 0.7 * (1.0 + f64::from(k) * f64::EPSILON);
        let direction = DVec3::new(sine, 0.0, (1.0 - sine * sine).sqrt());
        let transmittance = fresnel::transmittance(direction.z, 0.7);
        assert!((0.0..1e-5).contains(&transmittance), "{transmittance}");
        gather(&medium(0.7), &onto_plane(direction), &out_of_plane(1.0));
    }
}

/// cos θ = 10⁻⁷ on both sides: T falls in proportion to the cosine and keeps its digits, which one minus a
/// reflectance would not. A cloud stores no cosine between 0 and 3·10⁻⁵: the smallest that it stores goes through the
/// sum.
#[test]
fn grazing_light_and_view() {
    for eta in [1.3, 2.5, 1.0 + 1e-7] {
        let [one, ten] = [1e-8, 1e-7].map(|cosine| fresnel::transmittance(cosine, eta) / cosine);
        if eta > 1.1 {
            assert!((ten / one - 1.0).abs() < 1e-5, "{one} {ten}");
            assert!(one > 1.0 && one < 10.0);
        }
        let light = Incident { direction: DVec3::new(1.0, 0.0, 1e-7).normalize(), ..onto_plane(DVec3::Z) };
        let stored = onto_plane(DVec3::new(1.0, 0.0, 3e-5));
        assert!(stored.direction.z > 2e-5 && stored.direction.z < 4e-5, "{stored:?}");
        let values = gather(&medium(eta), &stored, &out_of_plane(-0.5));
        assert!(values.iter().all(|v| v.fast.min_element() > 0.0));
        assert_close(&values, 1e-4);
        for model in MODELS {
            let exit = bssrdf::Exitant { direction: light.direction, ..out_of_plane(-0.5) };
            let values = bssrdf::evaluate(&*model.of(&medium(eta)), eta, 0, &light, &exit);
            assert!((values.full / (values.bare * (1e-7 * ten).powi(2)) - 1.0).abs() < 1e-6, "{values:?}");
        }
    }
}
