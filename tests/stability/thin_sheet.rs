//! A thin sheet lit from behind, `n_o = −n_i`: the back-lit branch of the directional dipole, against the published
//! form with its mirrored source as a vector, and through both phases.

use crate::evaluate::{DIRECTIONAL, assert_close, assert_is, bare};
use bssrdf::{Coefficients, Exitant, Incident, Medium, Separation, evaluate};
use gather::estimator::Estimator;
use glam::DVec3;
use std::f64::consts::PI;
use test_support::{
    meshes::{Light, Part, slab, world},
    pipeline::{Lit, MODELS, Point, by_area, cloud, gray},
};

/// `C_φ φ + C_E n_o·(−D∇φ)` for the field `φ` of one source at the offset `at`, which emits along `along` at its
/// depth below the surface; (5.9) is the closed form of it. The gradient is a central difference, so that nothing is
/// shared with the formula under test.
fn source(c: &Coefficients, medium: &Medium, [at, along, out]: [DVec3; 3], depth_squared: f64) -> f64 {
    let (diffusion, transport) = (c.diffusion(), c.transport());
    let field = |x: DVec3| {
        let d = (x.length_squared() + depth_squared).sqrt();
        let q = transport * d;
        (-q).exp() / (diffusion * d) * (1.0 + 3.0 * diffusion * (1.0 + q) / (d * d) * x.dot(along))
    };
    let step = 1e-5 * (at.length_squared() + depth_squared).sqrt();
    let slope = (field(at + out * step) - field(at - out * step)) / (2.0 * step);
    medium.interface.c_phi * field(at) - medium.interface.c_e * diffusion * slope
}

/// Light at normal incidence through sheets from a thousandth of a mean free path to ten, beside and opposite the
/// entry.
///
/// The guard: `z² = 1/(3σ_t)²` where `μ0 ≤ 0`, with the full extinction.
#[test]
fn back_lit_branch_has_the_published_value() {
    let medium = gray(0.05, 1.2, 0.4, 1.4);
    let c = medium.channels[0];
    let extrapolation = 2.131 * c.diffusion() / c.reduced_albedo().sqrt();
    let mirror = 2.0 * medium.interface.reflection * extrapolation;
    let mut positive = 0;
    for thickness in [1e-3, 0.1, 1.0, 3.0, 10.0] {
        for aside in [0.3, 1.0, 5.0] {
            let offset = DVec3::new(aside, 0.0, -thickness);
            let refracted = DVec3::new(0.28, 0.0, -0.96);
            let separation = Separation { offset, normal_in: DVec3::Z, refracted, normal_out: DVec3::NEG_Z };
            let unit = offset.normalize();
            let normal = (DVec3::Z - DVec3::Z.dot(unit) * unit).normalize();
            let mirrored = refracted - 2.0 * refracted.dot(normal) * normal;
            let real = source(&c, &medium, [offset, refracted, DVec3::NEG_Z], (3.0 * c.extinction()).powi(-2));
            let image = source(&c, &medium, [offset - mirror * normal, mirrored, DVec3::NEG_Z], 0.0);
            let expected = (real - image).max(0.0) / (4.0 * PI * PI * medium.interface.exit_norm);
            let values = bare(&medium, &separation);
            assert_is(&format!("{thickness} {aside}"), values[DIRECTIONAL].exact, DVec3::splat(expected), 1e-7);
            assert_close(&values, 1e-5);
            positive += usize::from(expected > 0.0);
        }
    }
    assert!(positive >= 5, "only {positive} values are not clamped");
}

/// Light from below, seen from above: both phases and the float32 sum against a float64 sum over the same samples.
#[test]
fn light_shines_through_a_sheet() {
    let sun = Light::Directional { towards: DVec3::new(0.0, 0.6, -0.8), irradiance: DVec3::ONE };
    let world = world(&[Part::translucent(slab(DVec3::new(1.0, 1.0, 5e-4), 2))], &[sun], DVec3::ZERO);
    let medium = gray(50.0, 2000.0, 0.3, 1.3);
    let cloud = cloud(&world, &by_area(20_000, 3));
    let origin = DVec3::from_array(cloud.meta().origin_m);
    let point = Point { position: DVec3::new(0.11, 0.07, 5e-4), normal: DVec3::Z };
    for model in MODELS {
        let lit = Lit::new(&cloud, &medium, model).radiance(Estimator::Exhaustive, point, 0);
        let of = model.of(&medium);
        let exitant = Exitant { position: point.position, normal: point.normal, direction: DVec3::Z };
        let term = |sample: formats::cloud::Sample| {
            let position = sample.position.as_dvec3() + origin;
            let incident = Incident { position, normal: sample.normal, direction: sample.direction };
            evaluate(&*of, medium.eta, 0, &incident, &exitant).gather * f64::from(sample.flux.x)
        };
        let expected =
            cloud.samples(&cloud.meta().materials[0]).map(term).sum::<f64>() / cloud.meta().samples_drawn as f64;
        assert!(expected > 0.0);
        assert_is(model.name(), lit, DVec3::splat(expected), 1e-5);
    }
}
