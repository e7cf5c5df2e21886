//! Evaluations per second and core of each model, and of the entry of light; one evaluation is one pair of points in
//! three channels. Run with `cargo bench -p bssrdf`; an instruction set that the processor lacks runs plain.
//!
//! One evaluation takes 185 (standard dipole), 227 (better) and 468 (directional) floating point operations (additions,
//! multiplications, divisions, roots) in the AVX-512 bodies. That number times the evaluations per second, over the
//! operations per second of `peak`, is the share of the core's peak: 0.6 on a Xeon of 2024 at 3.7 GHz, with 340, 245
//! and 135 million evaluations per second. Fused multiply-adds would double the peak and gain a tenth (directional) to
//! a quarter (the others); they are not used, so that all processors give the same bits.

use bssrdf::{
    DVec3, Medium, built_in, fresnel,
    lanes::{
        BetterLanes, Block, DirectionalLanes, Directions, EntryRefraction, HalfSpaceLanes, LANES, Lane, LaneModel,
        StandardLanes,
    },
    simd::{self, Kernel, Level},
};
use divan::{Bencher, black_box, counter::ItemsCount};
use test_support::Random;

fn main() {
    divan::main();
}

/// Blocks of one sum: they stay in the second-level cache, as packets of samples do in a gather.
const BLOCKS: usize = 512;

/// The sum of a model over blocks, in float64 and a fixed order, as a gather does it.
struct Sum<'a, M> {
    model: &'a M,
    blocks: &'a [Block],
    normal_out: [f32; 3],
}

impl<M: LaneModel> Kernel for Sum<'_, M> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let mut sum = [0.0f64; LANES];
        for block in self.blocks {
            let [r, g, b] = self.model.bare(block, self.normal_out);
            for i in 0..LANES {
                sum[i] += f64::from(r[i] + g[i] + b[i]);
            }
        }
        sum.iter().sum()
    }
}

/// Light that enters a sphere of radius 20 mm at random points, with the exitant point at its pole.
fn blocks(medium: &Medium) -> Vec<Block> {
    let mut random = Random(1);
    let radius = 0.02;
    let zero: [Lane; 3] = [[0.0; LANES]; 3];
    let mut blocks = vec![Block { offset: zero, normal_in: zero, refracted: zero }; BLOCKS];
    for block in &mut blocks {
        for i in 0..LANES {
            let normal = random.direction();
            let light = random.direction();
            let light = light * light.dot(normal).signum();
            let entry = fresnel::enter(normal, light, medium.eta).expect("light from above");
            for c in 0..3 {
                block.offset[c][i] = ((DVec3::Z - normal) * radius)[c] as f32;
                block.normal_in[c][i] = normal[c] as f32;
                block.refracted[c][i] = entry.direction[c] as f32;
            }
        }
    }
    blocks
}

#[divan::bench(
    types = [StandardLanes, BetterLanes, DirectionalLanes, HalfSpaceLanes],
    args = Level::ALL,
)]
fn model<M: LaneModel>(bencher: Bencher, level: Level) {
    let medium = built_in("skimmilk").expect("a medium");
    let (model, blocks) = (M::new(&medium), blocks(&medium));
    bencher.counter(ItemsCount::new(BLOCKS * LANES)).bench(|| {
        simd::run_as(level, Sum { model: black_box(&model), blocks: black_box(&blocks), normal_out: [0.0, 0.0, 1.0] })
    });
}

/// The entry of samples, reduced to one number.
struct Enter<'a> {
    entry: EntryRefraction,
    samples: &'a [[Directions; 2]],
}

impl Kernel for Enter<'_> {
    type Output = Lane;

    #[inline(always)]
    fn run(self) -> Lane {
        let mut sum = [0.0; LANES];
        for [normal, direction] in self.samples {
            let entered = self.entry.enter(normal, direction);
            for i in 0..LANES {
                let vectors = entered.normal.iter().chain(&entered.refracted);
                sum[i] += vectors.fold(entered.transmittance[i], |sum, lane| sum + lane[i]);
            }
        }
        sum
    }
}

/// Sixteen random directions as integers.
fn directions(random: &mut Random) -> Directions {
    let vectors = [0; LANES].map(|_| {
        let v = random.direction();
        (v * (32767.0 / v.abs().element_sum())).round().as_ivec3()
    });
    [0, 1, 2].map(|c| vectors.map(|v| v[c]))
}

#[divan::bench(args = Level::ALL)]
fn entry(bencher: Bencher, level: Level) {
    let mut random = Random(2);
    let samples: Vec<_> = (0..BLOCKS).map(|_| [0; 2].map(|_| directions(&mut random))).collect();
    let entry = EntryRefraction::new(1.3);
    let kernel = || Enter { entry: black_box(entry.clone()), samples: black_box(&samples) };
    bencher.counter(ItemsCount::new(BLOCKS * LANES)).bench(|| simd::run_as(level, kernel()));
}

/// Independent multiplications and additions: the peak of the core.
struct Peak {
    factor: f32,
    summand: f32,
}

/// Enough numbers that none is needed again before it is stored.
const NUMBERS: usize = 512;
const TURNS: usize = 200;

impl Kernel for Peak {
    type Output = [f32; NUMBERS];

    #[inline(always)]
    fn run(self) -> [f32; NUMBERS] {
        let step = |x| x * self.factor + self.summand;
        let mut numbers = [1.0; NUMBERS];
        for _ in 0..TURNS {
            for x in &mut numbers {
                *x = step(step(step(step(*x))));
            }
        }
        numbers
    }
}

/// Floating point operations per second, not fused.
#[divan::bench(args = Level::ALL)]
fn peak(bencher: Bencher, level: Level) {
    let kernel = || Peak { factor: black_box(0.5), summand: black_box(1.0) };
    bencher.counter(ItemsCount::new(TURNS * NUMBERS * 8)).bench(|| simd::run_as(level, kernel()));
}
