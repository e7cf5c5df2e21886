//! The cut has the mean of the exhaustive sum, over the random numbers of many gathers on one cloud.

use bssrdf::{Medium, built_in};
use formats::cloud::Cloud;
use gather::estimator::Estimator;
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use scene::{
    NormalKind, SurfacePoint,
    light::{LightTree, all_light_at},
};
use test_support::{
    EFFORT,
    meshes::{Part, World, repository_scene, sphere, world},
    pipeline::{Lit, MODELS, Point, Sampling, cloud, stratified},
    random::Random,
    z_test::{Estimate, assert_mean},
};

const ACCURACIES: [f64; 3] = [0.5, 0.1, 0.01];
/// Number of gathers at each point.
const GATHERS: u64 = 48 * EFFORT;
/// Number of lit and of unlit points.
const POINTS: usize = 10;

/// Points of the surface that light reaches, and points that it does not: as many of each as asked for, if the scene
/// has both.
fn lit_and_unlit(world: &World, wanted: usize) -> [Vec<Point>; 2] {
    let (mut random, mut points) = (Random(31), [Vec::new(), Vec::new()]);
    let lights = LightTree::new(world.scene.lights());
    for _ in 0..100 * wanted {
        let (a, b) = (random.uniform().sqrt(), random.uniform());
        let triangle = (random.uniform() * world.scene.mesh.triangles.len() as f64) as u32;
        let weights = [1.0 - a, (1.0 - b) * a, b * a];
        let at: SurfacePoint = world.scene.mesh.point(triangle, weights, NormalKind::Geometric);
        let light = all_light_at(&lights, &world.rays, &at, || [0.5; 2], &mut 0);
        let own = &mut points[usize::from(light == DVec3::ZERO)];
        if own.len() < wanted {
            own.push(Point { position: at.position + world.scene.origin, normal: at.normal });
        }
    }
    points
}

/// Each run gathers once at every point; its result is the mean ratio to the exhaustive sum, over points and
/// channels. Values below a millionth of the brightest do not count: float32 resolves no more.
fn ratios(lit: &Lit, points: &[Point], estimator: Estimator, first_key: u64) -> Vec<f64> {
    let whole: Vec<DVec3> = points.iter().map(|p| lit.radiance(Estimator::Exhaustive, *p, 0)).collect();
    let dark = 1e-6 * whole.iter().map(|w| w.max_element()).fold(0.0, f64::max);
    let channels: Vec<(usize, usize)> =
        (0..3 * points.len()).map(|k| (k / 3, k % 3)).filter(|(p, c)| whole[*p][*c] > dark).collect();
    let mut random = Random(first_key);
    let mut run = || {
        let chosen: Vec<DVec3> = points.iter().map(|p| lit.radiance(estimator, *p, random.bits())).collect();
        channels.iter().map(|(p, c)| chosen[*p][*c] / whole[*p][*c]).sum::<f64>() / channels.len() as f64
    };
    (0..GATHERS).map(|_| run()).collect()
}

fn assert_unbiased(what: &str, cloud: &Cloud, medium: &Medium, points: &[Point], seed: u64) {
    MODELS.into_par_iter().for_each(|model| {
        let lit = Lit::new(cloud, medium, model);
        for (k, accuracy) in ACCURACIES.into_iter().enumerate() {
            let key = seed << 16 | (model as u64) << 8 | k as u64;
            let runs = ratios(&lit, points, Estimator::Cut { accuracy }, key);
            let estimate = Estimate::of(&runs);
            if runs.iter().all(|r| (r - 1.0).abs() < 1e-12) {
                continue; // all that contributes was opened
            }
            assert_mean(&format!("{what}, {}, {}, {accuracy}", medium.name, model.name()), estimate, 1.0);
            assert!(
                estimate.error < 0.2 * accuracy + 0.01,
                "{what}, {}: {estimate:?} is too rough to tell",
                medium.name
            );
        }
    });
}

/// Triangles of very uneven areas, chosen uniformly: the fluxes of samples differ by orders of magnitude, and with
/// them the errors of closed nodes.
///
/// Seen to catch: the last tile's lanes all counted and picked from; a last sample of each node that is never picked;
/// nodes of little flux left out.
#[test]
fn under_uneven_fluxes() {
    let world = repository_scene("slivers");
    let sampling = Sampling { choice: Choice::Uniform, ..stratified(30_000, 5) };
    let cloud = cloud(&world, &sampling);
    let [lit, unlit] = lit_and_unlit(&world, POINTS);
    for (k, name) in ["marble", "ketchup", "espresso", "spectralon"].into_iter().enumerate() {
        let medium = built_in(name).expect("a built-in medium");
        assert_unbiased("lit", &cloud, &medium, &lit, 2 * k as u64);
        assert_unbiased("unlit", &cloud, &medium, &unlit, 2 * k as u64 + 1);
    }
}

/// Under a constant environment each sample has a direction of its own, over which the nodes of the tree average.
///
/// Seen to catch: the last tile's lanes all counted and picked from; nodes of little flux left out.
#[test]
fn under_a_constant_sky() {
    let world = world(&[Part::translucent(sphere(5e-3, 3))], &[], DVec3::ONE);
    let cloud = cloud(&world, &stratified(20_000, 6));
    let [lit, unlit] = lit_and_unlit(&world, POINTS);
    assert!(unlit.is_empty(), "a sphere has no shadow under the sky");
    for (k, name) in ["marble", "espresso"].into_iter().enumerate() {
        let medium = built_in(name).expect("a built-in medium");
        assert_unbiased("sky", &cloud, &medium, &lit, 100 + k as u64);
    }
}
