//! Several translucent objects in one scene: shares of the samples, and light that stays in its own object.

use crate::means::{jelly, rendered, sun};
use bssrdf::{Medium, Model};
use formats::cloud::Cloud;
use glam::DVec3;
use sample_surface::{Choice, TriangleChoice};
use scene::{
    Camera,
    random::{Purpose, Stream},
};
use test_support::{
    EFFORT,
    chi_square::assert_fits,
    meshes::{Light, Mesh, Part, World, rectangle, slab, world},
    pipeline::{Sampling, by_area, cloud, gray, orthographic, stratified},
    z_test::{Estimate, assert_equal},
};

const SEEDS: u64 = 48;

fn image_sum(world: &World, camera: &Camera, cloud: &Cloud, media: &[Medium], model: Model) -> DVec3 {
    rendered(world, camera, cloud, media, model).pixels.iter().map(|p| p.beauty()).sum()
}

pub fn at(mut mesh: Mesh, offset: DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p += offset.as_vec3());
    mesh
}

/// A small slab beside a large one.
fn two() -> World {
    let small = slab(DVec3::new(1e-3, 2e-3, 1e-3), 2);
    let large = at(slab(DVec3::new(5e-3, 2e-3, 1e-3), 2), DVec3::X * 8e-3);
    world(&[Part::translucent(small), Part::translucent(large)], &[sun(DVec3::ONE)], DVec3::ZERO)
}

/// Densities times areas add up to the share that was asked for, and the choice follows the densities.
///
/// Seen to catch: half of the samples given to the other objects whatever the share.
#[test]
fn shares_are_kept_and_densities_follow() {
    let world = two();
    let mesh = &world.scene.mesh;
    for (rule, share) in [(Choice::Area, 0.9), (Choice::Area, 0.1), (Choice::Uniform, 0.3)] {
        let choice = TriangleChoice::new(mesh, rule, |_| true, &[(0, share)]);
        let (stream, draws) = (Stream::new(31, Purpose::Surface), 100_000 * EFFORT);
        let mut observed = vec![0; mesh.triangles.len()];
        let mut expected = vec![0.0; mesh.triangles.len()];
        for k in 0..draws {
            let chosen = choice.choose(stream.item(k).uniform(0));
            let triangle = chosen.triangle as usize;
            observed[triangle] += 1;
            expected[triangle] = chosen.pdf_area * mesh.area(triangle) * draws as f64;
        }
        let of = |material: u16| (0..expected.len()).filter(move |k| mesh.triangles[*k].material == material);
        let [first, second] = [0, 1].map(|m| of(m).map(|k| expected[k]).sum::<f64>() / draws as f64);
        assert!((first - share).abs() < 1e-9 && (second - (1.0 - share)).abs() < 1e-9, "{first} {second}");
        assert_fits(&format!("{}, share {share}", rule.name()), &observed, &expected);
    }
}

/// The small slab looks the same whatever share of the samples it gets, by both patterns.
///
/// Seen to catch: a density whose share is wrong by a fiftieth.
#[test]
fn a_share_leaves_the_mean() {
    let (world, camera) = (two(), orthographic(DVec3::new(0.2, 0.3, 1.0), 1.5e-3));
    let mean = |first: u64, sampling: &dyn Fn(u64) -> Sampling| {
        let one = |seed| {
            let sum =
                image_sum(&world, &camera, &cloud(&world, &sampling(seed)), &[jelly(), jelly()], Model::BetterDipole);
            sum.element_sum()
        };
        Estimate::of(&(first..first + SEEDS).map(one).collect::<Vec<f64>>())
    };
    let samples = 1000 * EFFORT;
    let by_areas = mean(2000, &|seed| by_area(4 * samples, seed));
    for (k, share) in [0.9, 0.05].into_iter().enumerate() {
        let first = 2100 + 200 * k as u64;
        let own = mean(first, &|seed| Sampling { share: Some(share), ..by_area(samples, seed) });
        assert_equal(&format!("share {share}"), own, by_areas);
        let own = mean(first + 100, &|seed| Sampling { share: Some(share), ..stratified(samples, seed) });
        assert_equal(&format!("share {share}, stratified"), own, by_areas);
    }
}

/// Two slabs that touch, with an opaque sheet over the first: the light of the second one ends at the common face,
/// unless both are of one material.
#[test]
fn light_does_not_bleed_between_touching_objects() {
    let half = DVec3::new(2e-3, 2e-3, 1e-3);
    let [first, second] = [-2e-3, 2e-3].map(|x| at(slab(half, 4), DVec3::X * x));
    let sheet = Part::opaque(rectangle([-6e-3, 0.0], 6e-3, 5e-3, 1));
    let above = [Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE }];
    let media = [jelly(), gray(100.0, 3000.0, 0.0, 1.0)];
    // From below the sheet, half a millimetre from the common face.
    let window = |x: f64| Camera { position: DVec3::new(x, 0.0, 3e-3), ..orthographic(DVec3::Z, 1e-4) };
    let parts = [Part::translucent(first.clone()), Part::translucent(second.clone()), sheet.clone()];
    let apart = world(&parts, &above, DVec3::ZERO);
    let clouds = cloud(&apart, &by_area(20_000, 5));
    let seen = |x: f64| image_sum(&apart, &window(x), &clouds, &media, Model::DirectionalDipole);
    assert_eq!(seen(-5e-4), DVec3::ZERO);
    assert!(seen(5e-4).min_element() > 0.0);
    let mut both = first;
    let start = both.positions.len() as u32;
    both.positions.extend(second.positions);
    both.triangles.extend(second.triangles.iter().map(|t| t.map(|i| i + start)));
    let joined = world(&[Part::translucent(both), sheet], &above, DVec3::ZERO);
    let clouds = cloud(&joined, &by_area(20_000, 5));
    assert!(image_sum(&joined, &window(-5e-4), &clouds, &media[..1], Model::DirectionalDipole).min_element() > 0.0);
}
