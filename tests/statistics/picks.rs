//! The samples that the cut picks to stand for closed nodes.

use bssrdf::Model;
use formats::cloud::{Cloud, Sample};
use gather::{
    estimator::{Estimator, Scatterer, Sum},
    samples::{Exit, LitSamples},
};
use glam::{DVec3, Vec3};
use test_support::{
    EFFORT,
    chi_square::assert_fits,
    lit::{scatterer, sum},
    pipeline::gray,
    planted::cloud_of,
    random::Random,
};

/// An accuracy so loose that every node that may be closed is closed.
const LOOSE: Estimator = Estimator::Cut { accuracy: 1e9 };

/// Samples at one point, told apart by their flux: 1, 2, 3 and so on.
fn numbered(x: f32, count: usize, color: Vec3) -> impl Iterator<Item = Sample> {
    let position = Vec3::new(x, 0.0, 0.0);
    (1..=count).map(move |k| Sample { position, normal: DVec3::Z, direction: DVec3::Z, flux: color * k as f32 })
}

/// All samples in the first half of a cloud.
fn in_one_half(samples: impl Iterator<Item = Sample>) -> Cloud {
    cloud_of(&[samples.collect(), Vec::new()])
}

struct Experiment {
    scatterer: Scatterer,
    random: Random,
}

impl Experiment {
    fn new(seed: u64) -> Experiment {
        let scatterer = scatterer(Model::StandardDipole, &gray(1.0, 10.0, 0.0, 1.3));
        Experiment { scatterer, random: Random(seed) }
    }

    /// A sum at `x`, by fresh random numbers.
    fn sum(&mut self, cloud: &Cloud, x: f64) -> Sum {
        let samples = LitSamples::new(cloud, &cloud.meta().materials[0].halves[0], 1.3);
        let exit = Exit::new(DVec3::new(x, 0.0, 0.0), DVec3::Z, self.random.bits());
        sum(&self.scatterer, &samples, &exit, LOOSE)
    }
}

/// The integer that `x` is, up to rounding.
fn whole(x: f64) -> usize {
    assert!((x - x.round()).abs() < 1e-3, "{x} is the number of no sample");
    x.round() as usize
}

/// A tree of one closed node gives one of its samples, each equally often, to stand for all. Neither the number of
/// samples nor that of tiles is a power of two, and the last tile is not full.
///
/// Seen to catch: picks from all lanes of the last tile; a last sample that is never picked.
#[test]
fn a_closed_node_picks_its_samples_evenly() {
    const COUNT: usize = 333;
    let (many, one) = (in_one_half(numbered(0.0, COUNT, Vec3::ONE)), in_one_half(numbered(0.0, 1, Vec3::ONE)));
    let mut experiment = Experiment::new(21);
    let unit = experiment.sum(&one, 1.0).radiance.x;
    let mut observed = vec![0; COUNT];
    let draws = 60_000 * EFFORT;
    for _ in 0..draws {
        let picked = experiment.sum(&many, 1.0);
        assert_eq!(picked.evaluations, 1);
        observed[whole(picked.radiance.x / unit / COUNT as f64) - 1] += 1;
    }
    assert_fits("picks of one node", &observed, &vec![draws as f64 / COUNT as f64; COUNT]);
}

/// The cut of a large tree begins with sixteen nodes, of which ten have samples here: they stand for all of them.
///
/// Seen to catch: a node that is left out, and one that counts twice.
#[test]
fn the_first_nodes_of_a_large_tree_stand_for_all_samples() {
    const COUNT: usize = 40_000;
    let alike = |count: usize| in_one_half(numbered(0.0, count, Vec3::ONE).map(|s| Sample { flux: Vec3::ONE, ..s }));
    let (many, one) = (alike(COUNT), alike(1));
    let mut experiment = Experiment::new(23);
    let unit = experiment.sum(&one, 1.0).radiance.x;
    let all = experiment.sum(&many, 1.0);
    assert_eq!((all.evaluations, whole(all.radiance.x / unit)), (10, COUNT));
}

/// Two nodes, red and green, on either side of the exitant point, and a blue one farther away: every pair of picks from
/// red and blue is equally frequent. The red and the green one have one parent, and pick at opposite places.
///
/// Seen to catch: one random number for all nodes of a sum; picks of siblings that are independent.
#[test]
fn nodes_pick_independently_of_all_but_their_siblings() {
    const COUNT: usize = 256;
    let sides = numbered(-1.0, COUNT, Vec3::X).chain(numbered(1.0, COUNT, Vec3::Y));
    let all = in_one_half(sides.chain(numbered(4.0, 2 * COUNT, Vec3::Z)));
    let mut experiment = Experiment::new(22);
    let [near, far] = [-1.0, 4.0].map(|x| experiment.sum(&in_one_half(numbered(x, 1, Vec3::ONE)), 0.0).radiance.x);
    let mut observed = vec![0; 256];
    let draws = 60_000 * EFFORT;
    for _ in 0..draws {
        let picked = experiment.sum(&all, 0.0);
        assert_eq!(picked.evaluations, 3);
        let number = |light: f64, unit: f64, count: usize| whole(light / (unit * count as f64));
        let [red, green] = [picked.radiance.x, picked.radiance.y].map(|light| number(light, near, COUNT));
        assert_eq!(red + green, COUNT + 1);
        let blue = number(picked.radiance.z, far, 2 * COUNT);
        observed[16 * ((red - 1) / 16) + (blue - 1) / 32] += 1;
    }
    assert_fits("pairs of picks", &observed, &vec![draws as f64 / 256.0; 256]);
}
