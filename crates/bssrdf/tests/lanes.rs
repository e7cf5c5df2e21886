//! The models in float32 against those in float64, for random media and configurations that float32 represents exactly;
//! and all vector widths against each other, bit for bit.

mod block;

use block::Evaluate;
use bssrdf::{
    Bssrdf, Coefficients, DVec3, Interface, Medium, Model, Separation, fresnel,
    lanes::{
        BetterLanes, DirectionalLanes, Directions, Entered, EntryRefraction, HalfSpaceLanes, LANES, Lane, LaneModel,
        StandardLanes,
    },
    simd::{self, Kernel, Level},
};
use test_support::Random;

/// Distances in reduced mean free paths, `σ_t' r`.
const RANGES: [[f64; 2]; 4] = [[1e-3, 1.0], [1.0, 10.0], [10.0, 100.0], [100.0, 1000.0]];

/// Blocks of sixteen for each range: enough that the 99.9th percentile is one of dozens of values.
const BLOCKS: usize = 8000;

/// Blocks with one medium, in turn for each of its channels: to prepare a medium takes longer than many blocks.
const BLOCKS_OF_MEDIUM: usize = 6;

/// Relative error that 999 of 1000 values keep: far below the noise of any image.
const TOLERANCE: f64 = 1e-5;

/// A random medium from clear to white; a tenth of the channels have no absorption.
fn medium(random: &mut Random) -> Medium {
    let eta = random.between(1.0, 2.0);
    let channels = [0; 3].map(|_| Coefficients {
        sigma_a: if random.uniform() < 0.1 { 0.0 } else { random.log_between(1e-1, 1e5) },
        sigma_s: random.log_between(10.0, 1e5),
        asymmetry: random.between(-0.5, 0.95),
    });
    Medium { name: "random".into(), source: String::new(), channels, eta, interface: Interface::new(eta) }
}

/// The nearest vector of float32.
fn rounded(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// Light that enters at the first normal and leaves at the second, `distance` m away: in the plane of the first normal,
/// or in any direction.
fn separation(random: &mut Random, eta: f64, normals: [DVec3; 2], distance: f64, plane: bool) -> Separation {
    let [normal_in, normal_out] = normals;
    let light = random.direction();
    let light = light * light.dot(normal_in).signum();
    let refracted = fresnel::enter(normal_in, light, eta).map_or(-light, |entry| entry.direction);
    let mut direction = random.direction();
    if plane {
        direction = direction.cross(normal_in).normalize();
    }
    Separation {
        offset: rounded(direction * distance),
        normal_in: rounded(normal_in),
        refracted: rounded(refracted),
        normal_out: rounded(normal_out),
    }
}

/// Sixteen configurations with one exitant normal, at distances of a range in mean free paths of a channel.
fn separations(
    random: &mut Random,
    medium: &Medium,
    channel: usize,
    range: [f64; 2],
    plane: bool,
) -> [Separation; LANES] {
    let normal_out = random.direction();
    [0; LANES].map(|_| {
        let normal_in = if plane { normal_out } else { random.direction() };
        let distance = random.log_between(range[0], range[1]) / medium.channels[channel].reduced_extinction();
        separation(random, medium.eta, [normal_in, normal_out], distance, plane)
    })
}

/// The float64 value; none where rounding of `n_o` and `ω12` decides the depth of the source, which jumps at `μ₀ = 0`,
/// and where `S` is below 10⁻¹² of its value at the sample itself, or underflows.
fn reference(model: &dyn Bssrdf, channel: usize, separation: &Separation) -> Option<f64> {
    let value = model.bare(channel, separation);
    let peak = model.bare(channel, &Separation { offset: DVec3::ZERO, ..*separation });
    let decided = separation.normal_out.dot(separation.refracted).abs() > 1e-5;
    (decided && value > 1e-12 * peak && value > 1e-30).then_some(value)
}

/// Relative errors, sorted, and the configuration of the last.
fn errors<M: LaneModel>(model: Model, range: [f64; 2], plane: bool) -> (Vec<f64>, String) {
    let mut random = Random(range[1].to_bits() ^ u64::from(plane));
    let mut errors = Vec::new();
    let mut worst = (0.0, String::new());
    for _ in 0..BLOCKS.div_ceil(BLOCKS_OF_MEDIUM) {
        let medium = medium(&mut random);
        let (exact, fast) = (model.of(&medium), M::new(&medium));
        for channel in (0..BLOCKS_OF_MEDIUM).map(|block| block % 3) {
            let separations = separations(&mut random, &medium, channel, range, plane);
            let values = simd::dispatch(Evaluate::new(&fast, &separations));
            for (separation, value) in separations.iter().zip(values[channel]) {
                assert!(value.is_finite() && value >= 0.0, "{separation:?}");
                let Some(exact) = reference(&*exact, channel, separation) else { continue };
                let error = (f64::from(value) / exact - 1.0).abs();
                errors.push(error);
                if error > worst.0 {
                    let coefficients = medium.channels[channel];
                    worst = (error, format!("S {exact:e}, {coefficients:?}, eta {}, {separation:?}", medium.eta));
                }
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    (errors, worst.1)
}

fn assert_close<M: LaneModel>(model: Model, tolerance: f64) {
    for plane in [false, true] {
        for range in RANGES {
            let (errors, worst) = errors::<M>(model, range, plane);
            let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
            let shape = if plane { "plane" } else { "general" };
            let (name, error) = (model.name(), at(0.999));
            println!(
                "{name} {shape} {range:?}: {} values, median {:.1e}, 99 % {:.1e}, 99.9 % {error:.1e}, worst {:.1e}\n  {worst}",
                errors.len(),
                at(0.5),
                at(0.99),
                at(1.0)
            );
            assert!(errors.len() > 10_000, "{name} {shape} {range:?}: only {} values", errors.len());
            assert!(error < tolerance, "{name} {shape} {range:?}: {error:.1e}");
        }
    }
}

#[test]
fn directional_dipole_is_close_to_float64() {
    assert_close::<DirectionalLanes>(Model::DirectionalDipole, TOLERANCE);
}

#[test]
fn half_space_model_is_close_to_float64() {
    // On a plane x·n_i is a sum that cancels, and its rounding a depth: 7·10⁻⁵ mean free paths at a distance of 1000.
    assert_close::<HalfSpaceLanes>(Model::HalfSpace, 5e-5);
}

#[test]
fn better_dipole_is_close_to_float64() {
    assert_close::<BetterLanes>(Model::BetterDipole, TOLERANCE);
}

#[test]
fn standard_dipole_is_close_to_float64() {
    assert_close::<StandardLanes>(Model::StandardDipole, TOLERANCE);
}

fn bits(values: [Lane; 3]) -> [[u32; LANES]; 3] {
    values.map(|lane| lane.map(f32::to_bits))
}

/// All instruction sets that this processor has; one with AVX-512 has AVX2 as well.
fn bodies() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|level| level.is_available())
}

fn assert_same_bits<M: LaneModel>() {
    let mut random = Random(7);
    for _ in 0..BLOCKS / 8 {
        let medium = medium(&mut random);
        let model = M::new(&medium);
        for k in 0..8 {
            let mut separations = separations(&mut random, &medium, k % 3, RANGES[k % 4], k < 4);
            // The rare branches: no distance, and a distance along the normal.
            separations[3].offset = DVec3::ZERO;
            separations[9].offset = separations[9].normal_in;
            let plain = bits(simd::run_plain(Evaluate::new(&model, &separations)));
            for level in bodies() {
                let wide = simd::run_as(level, Evaluate::new(&model, &separations));
                assert_eq!(plain, bits(wide), "{level:?} {medium:?}");
            }
            assert_eq!(plain, bits(simd::dispatch(Evaluate::new(&model, &separations))), "{medium:?}");
        }
    }
}

#[test]
fn all_vector_widths_give_the_same_bits() {
    assert_same_bits::<DirectionalLanes>();
    assert_same_bits::<HalfSpaceLanes>();
    assert_same_bits::<BetterLanes>();
    assert_same_bits::<StandardLanes>();
}

/// Light enters for sixteen samples.
struct Enter {
    entry: EntryRefraction,
    normals: Directions,
    directions: Directions,
}

impl Kernel for &Enter {
    type Output = Entered;

    #[inline(always)]
    fn run(self) -> Entered {
        self.entry.enter(&self.normals, &self.directions)
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

#[test]
fn all_vector_widths_let_the_same_light_enter() {
    let mut random = Random(8);
    for _ in 0..BLOCKS {
        let entry = EntryRefraction::new(random.between(0.41, 2.5));
        let enter = Enter { entry, normals: directions(&mut random), directions: directions(&mut random) };
        let bits =
            |entered: Entered| (bits(entered.normal), bits(entered.refracted), entered.transmittance.map(f32::to_bits));
        let plain = bits(simd::run_plain(&enter));
        for level in bodies() {
            assert_eq!(plain, bits(simd::run_as(level, &enter)), "{level:?}");
        }
    }
}

/// Configurations that float32 leaves to float64: along the normal, at the sample itself, and so close that squares
/// leave the range of float32.
#[test]
fn hard_places_have_the_float64_value() {
    let mut random = Random(9);
    for k in 0..2000 {
        let medium = medium(&mut random);
        let mut all = separations(&mut random, &medium, 0, RANGES[k % 4], false);
        let length = 1.0 / medium.channels[0].reduced_extinction();
        for (i, separation) in all.iter_mut().enumerate() {
            let along = [0.0, 1.0, -1.0, 1e-6, 1e-12, 1e-18, 1e-30][i % 7] * length;
            separation.offset = rounded(separation.normal_in * along);
        }
        let model = DirectionalLanes::new(&medium);
        let exact = Model::DirectionalDipole.of(&medium);
        let values = simd::dispatch(Evaluate::new(&model, &all));
        for (separation, value) in all.iter().zip(values[0]) {
            if let Some(exact) = reference(&*exact, 0, separation) {
                assert!((f64::from(value) / exact - 1.0).abs() < 1e-6, "{exact:e} {value:e} {medium:?} {separation:?}");
            }
        }
    }
}
