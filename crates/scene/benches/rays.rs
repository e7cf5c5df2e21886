//! Rays per second on one thread, and the build of the tree.
//!
//!     cargo bench -p scene                        # the repository's own figure
//!     SCENE=dragon.glb cargo bench -p scene       # any other, a path from the folder of the crate

use divan::{Bencher, counter::ItemsCount};
use scene::{
    DVec3, NormalKind, Rays, Scene,
    random::{Item, Purpose, Stream},
    warp,
};
use std::{path::PathBuf, sync::LazyLock};
use test_support::{data, glb::OPTIONS};

/// Width and height of the image that the camera rays are of.
const PIXELS: usize = 256;

struct Ray {
    origin: DVec3,
    direction: DVec3,
    from: Option<u32>,
}

static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let path = std::env::var_os("SCENE").map_or_else(|| data("scenes/figure.glb").into(), PathBuf::from);
    Scene::import(&path, &OPTIONS).expect("the scene can be read")
});

static RAYS: LazyLock<Rays<'static>> = LazyLock::new(|| Rays::new(&SCENE.mesh));

/// Neighbors go nearly the same way.
static CAMERA: LazyLock<Vec<Ray>> = LazyLock::new(|| {
    let (low, high) = SCENE.mesh.bounds();
    let middle = (low + high) / 2.0;
    let forward = DVec3::new(-0.3, -0.2, -1.0).normalize();
    let origin = middle - forward * (1.2 * SCENE.mesh.diagonal());
    let right = forward.cross(DVec3::Y).normalize();
    let (right, up) = (right * 0.75, right.cross(forward) * 0.75);
    let at = |k: usize| (k as f64 + 0.5) / PIXELS as f64 - 0.5;
    let direction = |k: usize| (forward + right * at(k % PIXELS) - up * at(k / PIXELS)).normalize();
    (0..PIXELS * PIXELS).map(|k| Ray { origin, direction: direction(k), from: None }).collect()
});

/// Off the surface that the camera sees, by the cosine to its normal.
static OUTWARD: LazyLock<Vec<Ray>> = LazyLock::new(|| {
    let bounce = |(k, ray): (usize, &Ray)| {
        let hit = RAYS.closest(ray.origin, ray.direction, None)?;
        let at = SCENE.mesh.point(hit.triangle, hit.weights, NormalKind::Geometric);
        let normal =
            if at.geometric_normal.dot(ray.direction) < 0.0 { at.geometric_normal } else { -at.geometric_normal };
        let direction = (normal + sphere(item(k)) * 0.999).normalize();
        Some(Ray { origin: at.position, direction, from: Some(hit.triangle) })
    };
    CAMERA.iter().enumerate().filter_map(bounce).collect()
});

/// From anywhere on the surface towards a light far away, as phase one asks.
static TO_LIGHT: LazyLock<Vec<Ray>> = LazyLock::new(|| {
    let light = DVec3::new(0.4, 0.8, 0.5).normalize();
    let ray = |k: usize| {
        let item = item(k);
        let triangle = (item.bits(2) % SCENE.mesh.triangles.len() as u64) as u32;
        let weights = warp::triangle([item.uniform(3), item.uniform(4)]);
        let at = SCENE.mesh.point(triangle, weights, NormalKind::Geometric);
        let lit = at.geometric_normal.dot(light) > 0.0;
        lit.then_some(Ray { origin: at.position, direction: light, from: Some(triangle) })
    };
    (0..PIXELS * PIXELS).filter_map(ray).collect()
});

fn item(k: usize) -> Item {
    Stream::new(1, Purpose::Surface).item(k as u64)
}

fn sphere(item: Item) -> DVec3 {
    let z = 2.0 * item.uniform(0) - 1.0;
    let (sine, cosine) = (std::f64::consts::TAU * item.uniform(1)).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cosine, radius * sine, z)
}

fn closest(bencher: Bencher, rays: &[Ray]) {
    let hits = |ray: &&Ray| RAYS.closest(ray.origin, ray.direction, ray.from).is_some();
    bencher.counter(ItemsCount::new(rays.len())).bench(|| rays.iter().filter(hits).count());
}

fn visible(bencher: Bencher, rays: &[Ray]) {
    let clear = |ray: &&Ray| RAYS.visible(ray.origin, ray.direction, f64::INFINITY, ray.from);
    bencher.counter(ItemsCount::new(rays.len())).bench(|| rays.iter().filter(clear).count());
}

#[divan::bench]
fn closest_camera(bencher: Bencher) {
    closest(bencher, &CAMERA);
}

#[divan::bench]
fn closest_outward(bencher: Bencher) {
    closest(bencher, &OUTWARD);
}

/// A hundredth of the mesh's diagonal, no farther.
#[divan::bench]
fn closest_within_outward(bencher: Bencher) {
    let limit = 0.01 * SCENE.mesh.diagonal();
    let hits = |ray: &&Ray| RAYS.closest_within(ray.origin, ray.direction, limit, ray.from).is_some();
    bencher.counter(ItemsCount::new(OUTWARD.len())).bench(|| OUTWARD.iter().filter(hits).count());
}

#[divan::bench]
fn visible_camera(bencher: Bencher) {
    visible(bencher, &CAMERA);
}

#[divan::bench]
fn visible_outward(bencher: Bencher) {
    visible(bencher, &OUTWARD);
}

#[divan::bench]
fn visible_to_light(bencher: Bencher) {
    visible(bencher, &TO_LIGHT);
}

#[divan::bench(sample_count = 10)]
fn build_tree(bencher: Bencher) {
    bencher.counter(ItemsCount::new(SCENE.mesh.triangles.len())).bench(|| Rays::new(&SCENE.mesh));
}

fn main() {
    divan::main();
}
