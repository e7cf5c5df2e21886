//! Pictures of the figure, and how they are compared.

use bssrdf::{Coefficients, Medium, Model, built_in};
use formats::{Image, cloud::Cloud};
use gather::{Settings, estimator::Estimator};
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use scene::NormalKind;
use test_support::{
    EFFORT,
    meshes::World,
    pipeline::{Sampling, by_area, filed, input, medium, sampled_with, settings},
    z_test::{Estimate, assert_mean},
};

/// Width and height, pixels; about 200 of the pixels show the figure.
pub const SIZE: usize = 24;
/// Number of clouds in a mean.
pub const SEEDS: u64 = 24;

/// Channels of the light that comes from the cloud.
pub const SUBSURFACE: [&str; 3] = ["subsurface.R", "subsurface.G", "subsurface.B"];
/// The channels of all light that comes from lights.
pub const DIFFUSE: [&str; 3] = ["diffuse.R", "diffuse.G", "diffuse.B"];

/// How a picture is taken.
#[derive(Clone)]
pub struct Shot {
    pub sampling: Sampling,
    pub medium: Medium,
    pub model: Model,
    pub estimator: Estimator,
    pub normals: NormalKind,
}

impl Shot {
    /// For pixels: the exhaustive sum over a cloud of 8000 samples, with interpolated normals.
    pub fn new(seed: u64) -> Shot {
        Shot {
            sampling: by_area(8000, seed),
            medium: built_in("marble").expect("a built-in medium"),
            model: Model::DirectionalDipole,
            estimator: Estimator::Exhaustive,
            normals: NormalKind::Shading,
        }
    }

    /// For means: in a medium four times thinner the standard dipole spreads light over a centimetre, so that
    /// hundreds of samples light a pixel and clouds differ little.
    pub fn smooth(seed: u64) -> Shot {
        let shot = Shot::new(seed).scaled(4.0);
        let sampling = Sampling { samples: 12_000 * EFFORT, ..shot.sampling };
        Shot { sampling, model: Model::StandardDipole, ..shot }
    }

    /// For meshes without normals.
    pub fn faceted(self) -> Shot {
        Shot { normals: NormalKind::Geometric, ..self }
    }

    pub fn choosing(self, choice: Choice) -> Shot {
        Shot { sampling: Sampling { choice, ..self.sampling }, ..self }
    }

    /// A medium that looks the same in an object that is so many times larger.
    pub fn scaled(self, size: f64) -> Shot {
        let channel = |c: Coefficients| Coefficients { sigma_a: c.sigma_a / size, sigma_s: c.sigma_s / size, ..c };
        let scaled = medium(self.medium.channels.map(channel), self.medium.eta);
        Shot { medium: scaled, ..self }
    }

    /// Both phases, seen by the scene's first camera.
    pub fn of(&self, world: &World) -> Image {
        self.of_cloud(world, &filed(&sampled_with(world, &self.sampling, self.normals)))
    }

    /// Phase two.
    pub fn of_cloud(&self, world: &World, cloud: &Cloud) -> Image {
        let media = std::slice::from_ref(&self.medium);
        let camera = &world.scene.cameras[0];
        let input = input(world, std::slice::from_ref(cloud), media, camera);
        let settings =
            Settings { estimator: self.estimator, normals: self.normals, ..settings(self.model, SIZE, SIZE) };
        let rendered = gather::render(&input, &settings, |_| ());
        assert_eq!(rendered.non_finite_count, 0);
        assert!(rendered.counts.gathers > 100, "{:?}", rendered.counts);
        gather::film::image(&rendered.pixels, SIZE, SIZE)
    }
}

/// A channel's samples.
pub fn channel<'a>(image: &'a Image, name: &str) -> &'a [f32] {
    image.channel(name).expect("every image has this channel")
}

/// Sum over the pixels of three channels.
pub fn sum(image: &Image, names: [&str; 3]) -> DVec3 {
    DVec3::from_array(names.map(|name| channel(image, name).iter().map(|x| f64::from(*x)).sum()))
}

/// Pixels that show scattered light.
pub fn lit(image: &Image) -> usize {
    channel(image, SUBSURFACE[1]).iter().filter(|x| **x > 0.0).count()
}

/// Fails unless `scaled` turns the numbers of the first image into those of the other, bit for bit, in all channels
/// of light.
pub fn assert_multiple(what: &str, a: &Image, b: &Image, factor: f32) {
    let light = a.channels.iter().filter(|c| !["N.", "P.", "Z", "var"].iter().any(|start| c.name.starts_with(start)));
    for c in light {
        let equal = c.samples.iter().zip(channel(b, &c.name)).all(|(x, y)| x * factor == *y);
        assert!(equal, "{what}: channel {} is not {factor} times the same", c.name);
    }
    assert!(lit(a) > 100, "{what}: {} pixels show the figure", lit(a));
}

/// Fails unless the pixels of the subsurface layer agree within a relative `tolerance`, except for `exceptions` of
/// them; `pixel` maps a pixel of the first image to one of the other.
pub fn assert_close_at(
    what: &str,
    [a, b]: [&Image; 2],
    tolerance: f64,
    exceptions: usize,
    pixel: impl Fn(usize) -> usize,
) {
    let difference = |k: usize| {
        let worst = SUBSURFACE.map(|name| {
            let [x, y] = [channel(a, name)[k], channel(b, name)[pixel(k)]].map(f64::from);
            if x == y { 0.0 } else { (x - y).abs() / x.max(y) }
        });
        worst.into_iter().fold(0.0, f64::max)
    };
    let mut differences: Vec<f64> = (0..SIZE * SIZE).map(difference).collect();
    differences.sort_by(f64::total_cmp);
    let beyond = differences.iter().filter(|d| **d > tolerance).count();
    let within = differences[SIZE * SIZE - 1 - beyond];
    println!("{what}: {beyond} of {} pixels differ by more than {tolerance:.0e}, the others by {within:.1e}", lit(a));
    assert!(lit(a) > 100, "{what}: {} pixels show the figure", lit(a));
    assert!(beyond <= exceptions, "{what}: {beyond} pixels differ by more than {tolerance:e}");
}

/// [`assert_close_at`] for pixels at the same position.
pub fn assert_close(what: &str, images: [&Image; 2], tolerance: f64, exceptions: usize) {
    assert_close_at(what, images, tolerance, exceptions, |k| k);
}

/// Fails unless two numbers that each cloud gives with the same random numbers have one mean in each channel, within
/// four standard errors of the difference, in which the shared noise cancels. The test says something only if that
/// error is a small share of the mean, at most `roughest`.
pub fn assert_paired(what: &str, first: u64, roughest: f64, pair: impl Fn(u64) -> [DVec3; 2] + Send + Sync) {
    let runs: Vec<[DVec3; 2]> = (first..first + SEEDS).into_par_iter().map(pair).collect();
    let mean = runs.iter().map(|[a, _]| a).sum::<DVec3>() / SEEDS as f64;
    for c in 0..3 {
        let differences: Vec<f64> = runs.iter().map(|[a, b]| (b[c] - a[c]) / mean[c]).collect();
        if differences.iter().all(|d| *d == 0.0) {
            continue;
        }
        let Estimate { mean, error, freedom } = Estimate::of(&differences);
        let ratio = Estimate { mean: 1.0 + mean, error, freedom };
        assert_mean(&format!("{what}, channel {c}"), ratio, 1.0);
        assert!(ratio.deviation(1.0).abs() <= 4.0, "{what}: {ratio:?}");
        assert!(error < roughest, "{what}: {ratio:?} is too rough to tell");
    }
}
