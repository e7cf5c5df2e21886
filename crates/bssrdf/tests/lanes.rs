//! The float32 evaluation against the float64 one, over random configurations and media.

use bssrdf::{
    Bssrdf, DVec3, Medium, Model, Separation, fresnel,
    lanes::{BetterLanes, Block, DirectionalLanes, LANES, LaneModel, StandardLanes},
    simd::{self, Kernel},
};

/// SplitMix64: test data only.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (s, c) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * c, radius * s, z)
    }
}

fn medium(random: &mut Random) -> Medium {
    let mut three = |f: &mut dyn FnMut(&mut Random) -> f64| [f(random), f(random), f(random)].map(|x| x.to_string());
    let sigma_s = three(&mut |r| 10f64.powf(r.between(-2.0, 2.0)));
    let sigma_a = three(&mut |r| if r.uniform() < 0.1 { 0.0 } else { 10f64.powf(r.between(-4.0, 2.0)) });
    let g = random.between(-0.5, 0.95);
    let eta = random.between(1.0, 2.0);
    let json = format!(
        r#"{{"name":"random","unit":"1/mm","sigma_s":[{}],"sigma_a":[{}],"g":{g},"eta":{eta}}}"#,
        sigma_s.join(","),
        sigma_a.join(",")
    );
    Medium::from_json(&json).expect("valid")
}

/// A separation that float32 holds exactly, at a distance of `low..high` reduced mean free paths of a channel.
fn separation(random: &mut Random, medium: &Medium, range: [f64; 2], plane: bool) -> Separation {
    let exact = |v: DVec3| v.as_vec3().as_dvec3();
    let normal_in = random.direction();
    let mut light = random.direction();
    if light.dot(normal_in) < 0.0 {
        light = -light;
    }
    let refracted = fresnel::enter(normal_in, light, medium.eta).map_or(-light, |e| e.direction);
    let distance =
        10f64.powf(random.between(range[0].log10(), range[1].log10())) / medium.channels[0].reduced_extinction();
    let direction = random.direction();
    let (direction, normal_out) = if plane {
        ((direction - direction.dot(normal_in) * normal_in).normalize(), normal_in)
    } else {
        (direction, random.direction())
    };
    Separation {
        offset: exact(direction * distance),
        normal_in: exact(normal_in),
        refracted: exact(refracted),
        normal_out: exact(normal_out),
    }
}

fn block_of(separations: &[Separation; LANES]) -> Block {
    let lanes = |f: fn(&Separation) -> DVec3| [0, 1, 2].map(|c| separations.map(|s| f(&s)[c] as f32));
    Block { offset: lanes(|s| s.offset), normal_in: lanes(|s| s.normal_in), refracted: lanes(|s| s.refracted) }
}

struct Evaluate<'a, M>(&'a M, &'a Block, [f32; 3]);

impl<M: LaneModel> Kernel for Evaluate<'_, M> {
    type Output = [[f32; LANES]; 3];
    #[inline(always)]
    fn run(self) -> Self::Output {
        self.0.bare(self.1, self.2)
    }
}

/// Relative errors of red wherever S exceeds 10⁻¹² of its value at the sample itself, sorted; and the worst case.
fn errors<M: LaneModel>(model: Model, range: [f64; 2], plane: bool, blocks: usize) -> Vec<(f64, Separation)> {
    let mut random = Random(blocks as u64 ^ range[1].to_bits() ^ u64::from(plane));
    let mut errors = Vec::new();
    for _ in 0..blocks {
        let medium = medium(&mut random);
        let (reference, fast) = (model.of(&medium), M::new(&medium));
        let mut separations = [separation(&mut random, &medium, range, plane); LANES];
        for s in &mut separations {
            let normal_out = s.normal_out;
            *s = separation(&mut random, &medium, range, plane);
            if !plane {
                s.normal_out = normal_out;
            }
        }
        if plane {
            // One exitant normal a block: turn all lanes' surfaces into the first one's.
            separations = [separations[0]; LANES];
        }
        let normal_out = separations[0].normal_out.as_vec3().to_array();
        let values = simd::dispatch(Evaluate(&fast, &block_of(&separations), normal_out));
        for (i, s) in separations.iter().enumerate().take(if plane { 1 } else { LANES }) {
            let s = &Separation { normal_out: separations[0].normal_out, ..*s };
            let exact = reference.bare(0, s);
            let peak = reference.bare(0, &Separation { offset: DVec3::ZERO, ..*s });
            if exact > 1e-12 * peak && exact > 1e-30 && -s.normal_out.dot(s.refracted) > 1e-5 {
                errors.push(((f64::from(values[0][i]) / exact - 1.0).abs(), *s));
            }
        }
    }
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    errors
}

fn check<M: LaneModel>(model: Model) {
    for plane in [false, true] {
        for range in [[1e-3, 1.0], [1.0, 10.0], [10.0, 100.0], [100.0, 1000.0]] {
            let errors = errors::<M>(model, range, plane, if plane { 20_000 } else { 2_000 });
            let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize].0;
            println!(
                "{} plane {plane} {range:?}: {} values, median {:.1e}, 99 % {:.1e}, 99.9 % {:.1e}, worst {:.1e}",
                model.name(),
                errors.len(),
                at(0.5),
                at(0.99),
                at(0.999),
                at(1.0)
            );
            if std::env::var_os("WORST").is_some() {
                println!("   {:?}", errors[errors.len() - 1]);
            }
        }
    }
}

#[test]
fn print() {
    check::<DirectionalLanes>(Model::DirectionalDipole);
    check::<BetterLanes>(Model::BetterDipole);
    check::<StandardLanes>(Model::StandardDipole);
}
