//! Results have the same bytes for any number of threads.

use bssrdf::{Model, built_in};
use formats::cloud::{Cloud, Shard};
use gather::{
    Filter, Rendered, Settings,
    estimator::{Estimator, Rule},
};
use glam::DVec3;
use scene::NormalKind;
use test_support::{
    Bench,
    meshes::{Light, Part, World, slab, sphere, world},
    pipeline::{Sampling, by_area, cloud, input, orthographic, sampled, settings, stratified, write},
    planted::stored,
};

/// Two objects, three kinds of light, shadows.
pub fn still_life() -> World {
    let lights = [
        Light::Directional { towards: DVec3::new(0.48, 0.6, 0.64), irradiance: DVec3::new(1.0, 0.8, 0.5) },
        Light::Point { position: DVec3::new(-0.02, 0.01, 0.03), intensity: DVec3::splat(1e-3) },
    ];
    let ball = Part::translucent(sphere(4e-3, 3));
    let mut plate = slab(DVec3::new(8e-3, 8e-3, 1e-3), 4);
    plate.positions.iter_mut().for_each(|p| p.z -= 6e-3);
    world(&[ball, Part::opaque(plate)], &lights, DVec3::splat(0.2))
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    pool.install(work)
}

/// Seen to catch: samples that depend on the thread that draws them.
#[test]
fn clouds_have_the_same_bytes_for_any_number_of_threads() {
    let bench = Bench::new();
    for sampling in [stratified(100_000, 3), by_area(100_000, 3)] {
        let file = |threads: usize| {
            let name = format!("{threads}.cloud");
            with_threads(threads, || write(&sampled(&still_life(), &sampling), &bench.path(&name)));
            bench.read(&name)
        };
        let one = file(1);
        assert!(one.len() > 1_000_000);
        for threads in [2, 3, 7] {
            assert!(one == file(threads), "the cloud depends on the number of threads: {sampling:?}, {threads}");
        }
    }
}

/// A different seed, pattern or shard gives different samples in both halves, without a common one.
///
/// Seen to catch: a seed that the pattern ignores.
#[test]
fn another_seed_gives_other_samples() {
    let world = still_life();
    let shard = |index, sampling| Sampling { shard: Shard { index, count: 2 }, ..sampling };
    let samplings = [stratified(2000, 3), stratified(2000, 4), by_area(2000, 3), by_area(2000, 4)];
    let shards = [0, 1].map(|k| [shard(k, samplings[0]), shard(k, samplings[2])]);
    let samplings = [&samplings[..], shards.as_flattened()].concat();
    let halves: Vec<_> = samplings.iter().map(|s| stored(&cloud(&world, s)).swap_remove(0)).collect();
    for (k, one) in halves.iter().enumerate() {
        for other in &halves[k + 1..] {
            for (a, b) in one.iter().flat_map(|a| other.iter().map(move |b| (a, b))) {
                assert!(a.len() > 100 && a.iter().all(|s| b.iter().all(|t| s.position != t.position)));
            }
        }
    }
}

fn render(world: &World, cloud: &Cloud, estimator: Estimator) -> Rendered {
    let media = [built_in("skin1").expect("a built-in medium")];
    let camera = orthographic(DVec3::new(0.2, -1.0, 0.5), 8e-3);
    let settings = Settings {
        paths_per_pixel: 4,
        filter: Filter::Box,
        estimator,
        normals: NormalKind::Shading,
        near_field: true,
        ..settings(Model::DirectionalDipole, 40, 30)
    };
    let input = input(world, std::slice::from_ref(cloud), &media, &camera);
    gather::render(&input, &settings, |_| ())
}

/// Seen to catch: random numbers that depend on the thread.
#[test]
fn images_are_the_same_for_any_number_of_threads() {
    let world = still_life();
    let cloud = cloud(&world, &stratified(3000, 3));
    for estimator in [Estimator::Cut { accuracy: 0.01 }, Estimator::Exhaustive, Estimator::Roulette(Rule::Mixture)] {
        let image = |threads: usize| {
            let rendered = with_threads(threads, || render(&world, &cloud, estimator));
            let image = gather::film::image(&rendered.pixels, 40, 30);
            let bits: Vec<u32> = image.channels.iter().flat_map(|c| c.samples.iter().map(|x| x.to_bits())).collect();
            (bits, format!("{:?}", rendered.counts))
        };
        let one = image(1);
        assert!(one.0.iter().any(|x| *x != 0));
        for threads in [2, 3, 7] {
            assert!(one == image(threads), "the image depends on the number of threads: {estimator:?}, {threads}");
        }
    }
}
