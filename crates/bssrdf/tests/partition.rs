//! The two parts of a BSSRDF: the step itself, and the far part of each model in lanes and in float64.

mod block;

use block::Evaluate;
use bssrdf::{
    Bssrdf, Coefficients, DVec3, Far, Interface, Medium, Model, Partition, Separation, fresnel,
    lanes::{BetterLanes, DirectionalLanes, HalfSpaceLanes, LANES, Lane, LaneModel, StandardLanes},
    simd::{self, Level},
};
use test_support::Random;

/// Partitions of very different widths, from and to m.
const STEPS: [[f64; 2]; 5] = [[0.0, 1e-3], [1e-3, 3e-3], [1e-3, 1.001e-3], [1e-7, 3e-7], [0.5, 40.0]];

/// Seen to catch: `NONE` as a step that begins at 0.
#[test]
fn without_a_near_part_all_is_far() {
    let tiny = [0.0, 1e-300, 1e-30, f64::EPSILON];
    let others = (-200..200).map(|k| 1.3f64.powi(k));
    for distance in tiny.into_iter().chain(others).chain([1e150, f64::MAX.sqrt(), f64::INFINITY]) {
        assert_eq!(Partition::NONE.far(distance * distance), 1.0, "{distance}");
    }
    assert!(STEPS.iter().all(|[from, to]| Partition::new(*from, *to).far(0.5 * to * to) < 1.0));
}

/// Nothing inside, all beyond, one half where the squared distance is that of neither, and smooth and monotone between.
///
/// Seen to catch: a step in the distance instead of its square; the step's cubic with 2 and 1 for 3 and 2.
#[test]
fn the_step_rises_from_0_to_1() {
    const PLACES: i32 = 10_000;
    for [from, to] in STEPS {
        let step = Partition::new(from, to);
        let at = |share: f64| step.far(from * from + share * (to * to - from * from));
        for share in [0.0, 0.5, 1.0 - 1e-9] {
            assert_eq!(step.far(from * from * share), 0.0, "{from} {to} {share}");
        }
        for share in [1.0 + 1e-9, 2.0, 1e9, f64::INFINITY] {
            assert_eq!(step.far(to * to * share), 1.0, "{from} {to} {share}");
        }
        assert!((at(0.5) - 0.5).abs() < 1e-9 && (at(0.25) - 0.15625).abs() < 1e-9, "{}", at(0.25));
        let values: Vec<f64> =
            (-PLACES / 10..=PLACES + PLACES / 10).map(|k| at(f64::from(k) / f64::from(PLACES))).collect();
        for pair in values.windows(2) {
            let rise = pair[1] - pair[0];
            assert!((0.0..=1.6 / f64::from(PLACES)).contains(&rise), "{from} {to}: {pair:?}");
        }
    }
}

/// A random medium from clear to white.
fn medium(random: &mut Random) -> Medium {
    let eta = random.between(1.0, 2.0);
    let channels = [0; 3].map(|_| Coefficients {
        sigma_a: random.log_between(1.0, 1e4),
        sigma_s: random.log_between(1e2, 1e5),
        asymmetry: random.between(-0.5, 0.95),
    });
    Medium { name: "random".into(), source: String::new(), channels, eta, interface: Interface::new(eta) }
}

/// The nearest vector of float32.
fn rounded(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// Sixteen configurations with one exitant normal, up to three mean free paths apart; one of them without a distance.
fn separations(random: &mut Random, medium: &Medium) -> [Separation; LANES] {
    let normal_out = rounded(random.direction());
    let length = 1.0 / medium.channels[0].reduced_extinction();
    let mut all = [0; LANES].map(|_| {
        let normal_in = random.direction();
        let light = random.direction();
        let light = light * light.dot(normal_in).signum();
        let refracted = fresnel::enter(normal_in, light, medium.eta).map_or(-light, |entry| entry.direction);
        let offset = rounded(random.direction() * length * random.log_between(1e-2, 3.0));
        Separation { offset, normal_in: rounded(normal_in), refracted: rounded(refracted), normal_out }
    });
    all[5].offset = DVec3::ZERO;
    all
}

fn bits(values: [Lane; 3]) -> [[u32; LANES]; 3] {
    values.map(|lane| lane.map(f32::to_bits))
}

/// The far part of `M` in lanes against `M` itself and against `w` and the model in float64.
fn assert_far<M: LaneModel + Clone>(model: Model, seed: u64) {
    let mut random = Random(seed);
    for _ in 0..500 {
        let medium = medium(&mut random);
        let (exact, lanes) = (model.of(&medium), M::new(&medium));
        let separations = separations(&mut random, &medium);
        let length = 1.0 / medium.channels[0].reduced_extinction();
        let from = length * random.log_between(1e-2, 1.0);
        let partition = Partition::new(from, from * random.between(1.5, 4.0));
        let whole = Far { model: lanes.clone(), partition: Partition::NONE };
        let far = Far { model: lanes.clone(), partition };
        let plain = simd::run_plain(Evaluate::new(&lanes, &separations));
        assert_eq!(bits(plain), bits(simd::run_plain(Evaluate::new(&whole, &separations))), "{medium:?}");
        let values = simd::run_plain(Evaluate::new(&far, &separations));
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            assert_eq!(bits(values), bits(simd::run_as(level, Evaluate::new(&far, &separations))), "{level:?}");
        }
        let reference = Far { model: exact, partition };
        for (channel, lane) in [0, 1, 2].into_iter().flat_map(|c| (0..LANES).map(move |lane| (c, lane))) {
            let (s, peak) = (&separations[lane], f64::from(plain[channel][lane]));
            let w = partition.far(s.offset.length_squared());
            let value = f64::from(values[channel][lane]);
            assert!((value - w * peak).abs() <= 2e-6 * peak, "{value:e} instead of {w} of {peak:e}, {s:?}");
            assert_eq!(reference.bare(channel, s), w * reference.model.bare(channel, s));
        }
        assert_eq!(reference.transport(), model.of(&medium).transport());
    }
}

/// Without a near part the bits are those of the model alone; with one they are `w` times it, at all vector widths.
///
/// Seen to catch: `w` of the squared distance across the plane of the entry alone; `1 − w` for `w` in lanes; `NONE` as a
/// step that begins at 0.
#[test]
fn lanes_carry_w_times_the_model() {
    assert_far::<DirectionalLanes>(Model::DirectionalDipole, 1);
    assert_far::<HalfSpaceLanes>(Model::HalfSpace, 2);
    assert_far::<BetterLanes>(Model::BetterDipole, 3);
    assert_far::<StandardLanes>(Model::StandardDipole, 4);
}

/// The same through the model that is chosen when the program runs.
///
/// Seen to catch: the partition of one model not set.
#[test]
fn the_chosen_model_takes_its_partition() {
    let mut random = Random(5);
    for model in Model::ALL {
        let medium = medium(&mut random);
        let separations = separations(&mut random, &medium);
        let block = Evaluate::new(&(), &separations);
        let length = 1.0 / medium.channels[0].reduced_extinction();
        let value = |lanes: bssrdf::AnyLanes| lanes.bare(&block.block, block.normal_out);
        let whole = value(model.lanes(&medium));
        assert_eq!(bits(whole), bits(value(model.lanes(&medium).far(Partition::NONE))), "{}", model.name());
        let all_near = value(model.lanes(&medium).far(Partition::new(4.0 * length, 5.0 * length)));
        assert_eq!(all_near, [[0.0; LANES]; 3], "{}", model.name());
        assert!(whole.iter().flatten().any(|x| *x > 0.0));
    }
}
