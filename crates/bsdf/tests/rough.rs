//! Rough surfaces keep energy, are reciprocal, and are sampled with the densities that they state.

use bsdf::{Bsdf, DVec3, Gloss, Lobe, RoughBoundary, Schlick, Side, Stated, View};
use std::f64::consts::{PI, TAU};

/// Points that are spread evenly over the unit cube, by the powers of the root of `x⁴ = x + 1` (Roberts 2018).
fn even(count: usize) -> impl Iterator<Item = [f64; 3]> {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let steps = [1, 2, 3].map(|power| ROOT.powi(-power));
    (0..count).map(move |k| steps.map(|step| (0.5 + (k + 1) as f64 * step).fract()))
}

/// Linear congruential, high half: test data only.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    ((*state >> 32) as f64 + 0.5) / 4_294_967_296.0
}

/// The mean weight of the samples of a lobe.
fn albedo(bsdf: &impl Bsdf, view: &View, lobe: Lobe, count: usize) -> DVec3 {
    let one = |[a, b, c]: [f64; 3]| {
        let mut calls = [[b, c], [a, 0.0]].into_iter();
        bsdf.sample(view, lobe, || calls.next().expect("two calls")).map_or(DVec3::ZERO, |sample| sample.weight)
    };
    even(count).map(one).sum::<DVec3>() / count as f64
}

fn direction(cosine: f64, azimuth: f64) -> DVec3 {
    let sine = (1.0 - cosine * cosine).sqrt();
    DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
}

fn view(cosine: f64, side: Side) -> View {
    View { normal: DVec3::Z, direction: direction(cosine, 0.0), side }
}

const COSINES: [f64; 5] = [0.02, 0.1, 0.3, 0.7, 1.0];

fn gloss(metallic: f64, roughness: f64, base_color: DVec3) -> Gloss {
    let dielectric = Stated::dielectric(1.5, 1.0, DVec3::ONE);
    Gloss::new(&Stated { base_color, metallic, roughness, dielectric })
}

/// The white furnace: a metal that reflects everything returns all light within 0.5 %, and so does a white dielectric,
/// from its layer and its base together.
///
/// Seen to catch: no light given back, visible normals that are not stretched back.
#[test]
fn white_surfaces_lose_nothing() {
    for roughness in [0.1, 0.2, 0.45, 1.0] {
        for view in COSINES.map(|cosine| view(cosine, Side::Outside)) {
            for metallic in [0.0, 1.0] {
                let gloss = gloss(metallic, roughness, DVec3::ONE);
                let layer = albedo(&gloss, &view, Lobe::Reflection, 150_000).x;
                let base = |[a, b, _]: [f64; 3]| gloss.base(&view, direction(a.sqrt(), TAU * b)).x * PI;
                let sum = layer + even(4000).map(base).sum::<f64>() / 4000.0;
                let at = format!("metallic {metallic} roughness {roughness} {}", view.direction);
                assert!((sum - 1.0).abs() < 5e-3, "{at}: {sum}");
                assert!((layer - gloss.albedo(view.direction.z).x).abs() < 5e-3, "{at}: {layer}");
            }
        }
    }
}

/// Reflected and transmitted light add up to all of it within 0.5 %, from both sides.
///
/// Seen to catch: no light given back, refraction without the shadows of the refracted side.
#[test]
fn a_rough_boundary_loses_nothing() {
    for (eta, roughness) in [(1.01, 0.3), (1.33, 0.6), (1.5, 1.0), (2.5, 0.1), (2.5, 0.7)] {
        let boundary = RoughBoundary::new(eta, roughness);
        let bsdf = boundary.surface(roughness);
        for (cosine, side) in COSINES.into_iter().flat_map(|c| [(c, Side::Outside), (c, Side::Inside)]) {
            let view = view(cosine, side);
            let share = bsdf.transmittance(&view);
            let reflected = (1.0 - share) * albedo(&bsdf, &view, Lobe::Reflection, 100_000).x;
            let transmitted = share * albedo(&bsdf, &view, Lobe::Transmission, 100_000).x;
            let at = format!("index {eta} roughness {roughness} {side:?} {cosine}: {reflected} + {transmitted}");
            assert!((reflected + transmitted - 1.0).abs() < 5e-3, "{at}");
            assert!((transmitted - share).abs() < 2e-2, "{at}, {share}");
        }
    }
}

/// Without roughness, the transmittance is Fresnel's; a little roughness changes it little.
#[test]
fn slight_roughness_transmits_as_a_smooth_boundary() {
    let boundary = RoughBoundary::of_any_roughness(1.4);
    for cosine in [0.2, 0.5, 1.0] {
        let smooth = bsdf::fresnel::transmittance(cosine, 1.4);
        assert_eq!(boundary.transmittance(cosine, 0.0), smooth);
        assert!((boundary.transmittance(cosine, 0.1) - smooth).abs() < 4e-3, "{cosine}");
    }
    assert_eq!(boundary.transmittance(-0.1, 0.5), 0.0);
}

/// `f(a, b) = f(b, a)` for reflection, and `f(a, b)/η_b² = f(b, a)/η_a²` for transmission.
///
/// Seen to catch: refraction with its index once instead of squared, a base with the light of one direction through the
/// layer, refraction without the shadows of the refracted side.
#[test]
fn light_goes_back_the_way_it_came() {
    let (mut state, eta) = (1, 1.5);
    let boundary = RoughBoundary::new(eta, 0.6);
    let rough = boundary.surface(0.6);
    let plastic = gloss(0.3, 0.5, DVec3::new(0.2, 0.5, 0.9));
    for _ in 0..200 {
        let mut any = || direction(random(&mut state).max(0.02), TAU * random(&mut state));
        let (a, b) = (any(), any());
        let from = |direction: DVec3, side: Side| View {
            normal: if side == Side::Outside { DVec3::Z } else { DVec3::NEG_Z },
            direction,
            side,
        };
        let [there, back] = [(a, b), (b, a)].map(|(a, b)| (from(a, Side::Outside), b));
        let both = |bsdf: &dyn Fn(&View, DVec3) -> DVec3| [bsdf(&there.0, there.1), bsdf(&back.0, back.1)];
        for [there, back] in [
            both(&|view, light| plastic.evaluate(view, light)),
            both(&|view, light| plastic.base(view, light)),
            both(&|view, light| rough.evaluate(view, light)),
        ] {
            assert!(there.abs_diff_eq(back, 1e-9 * there.max_element()), "{a} {b}: {there} {back}");
        }
        let into = rough.evaluate(&from(a, Side::Outside), -b).x / (eta * eta);
        let out = rough.evaluate(&from(-b, Side::Inside), a).x;
        assert!((into - out).abs() < 1e-9 * into.max(1e-3), "{a} {b}: {into} {out}");
    }
}

const BINS: [usize; 2] = [10, 8];

/// The bin of a direction by its cosine and its azimuth.
fn bin(direction: DVec3) -> usize {
    let across = (direction.y.atan2(direction.x) / TAU + 0.5).rem_euclid(1.0);
    let index = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
    index(0.5 * (direction.z + 1.0), BINS[0]) * BINS[1] + index(across, BINS[1])
}

/// The probability of each bin on the side of a lobe, by its density, and of no direction.
fn expected(view: &View, density: impl Fn(DVec3) -> (f64, Lobe)) -> Vec<f64> {
    const CELLS: usize = 48;
    let mut shares = vec![0.0; BINS[0] * BINS[1] + 1];
    for (k, share) in shares.iter_mut().enumerate().take(BINS[0] * BINS[1]) {
        let corner = [k / BINS[1], k % BINS[1]];
        for cell in 0..CELLS * CELLS {
            let at = |axis: usize, cell: usize| {
                (corner[axis] as f64 + (cell as f64 + 0.5) / CELLS as f64) / BINS[axis] as f64
            };
            let light = direction(2.0 * at(0, cell / CELLS) - 1.0, TAU * (at(1, cell % CELLS) - 0.5));
            let (density, lobe) = density(light);
            if (light.dot(view.normal) > 0.0) == (lobe == Lobe::Reflection) {
                *share += density * 2.0 * TAU / ((BINS[0] * BINS[1] * CELLS * CELLS) as f64);
            }
        }
    }
    let sum: f64 = shares.iter().sum();
    *shares.last_mut().expect("the last bin") = (1.0 - sum).max(0.0);
    shares
}

const DRAWN: usize = 60_000;

/// Pearson's statistic of the bins of drawn directions against their probabilities. Under its approximate normal form
/// (Wilson and Hilferty 1931) one of these tests fails by chance once in 10⁶.
fn check_bins(name: &str, shares: &[f64], mut draw: impl FnMut() -> usize) {
    let mut counts = vec![0usize; shares.len()];
    (0..DRAWN).for_each(|_| counts[draw()] += 1);
    // Bins of few samples are counted together.
    let (mut statistic, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
    for (share, count) in shares.iter().zip(counts) {
        let (expected, count) = (share * DRAWN as f64, count as f64);
        if expected < 20.0 {
            rest = (rest.0 + expected, rest.1 + count);
        } else {
            statistic += (count - expected).powi(2) / expected;
            freedom += 1.0;
        }
    }
    if rest.0 > 5.0 {
        (statistic, freedom) = (statistic + (rest.1 - rest.0).powi(2) / rest.0, freedom + 1.0);
    }
    let spread = 2.0 / (9.0 * freedom);
    let deviation = ((statistic / freedom).cbrt() - (1.0 - spread)) / f64::sqrt(spread);
    assert!(deviation < 4.9, "{name}: {statistic} of {freedom} degrees, {deviation} standard deviations");
}

/// Samples against the density.
fn check(name: &str, bsdf: &impl Bsdf, view: &View, lobe: Lobe) {
    let (shares, mut state) = (expected(view, |light| (bsdf.density(view, light), lobe)), 7);
    check_bins(name, &shares, || {
        let sampled = bsdf.sample(view, lobe, || [random(&mut state), random(&mut state)]);
        sampled.map_or(shares.len() - 1, |sample| bin(sample.direction))
    });
}

/// Particles go where the value of the surface sends them, each with its whole weight, and those that cross go where the
/// value sends these.
///
/// Seen to catch: facets' neighbors that are in nobody's way; the side of what several microfacets scatter exchanged.
#[test]
fn particles_go_where_the_surface_sends_light() {
    for (eta, roughness) in [(1.5, 0.4), (1.4, 1.0), (0.7, 0.6)] {
        let boundary = RoughBoundary::new(eta, roughness);
        let surface = boundary.surface(roughness);
        for (cosine, side) in [(0.15, Side::Outside), (0.7, Side::Outside), (0.15, Side::Inside), (0.8, Side::Inside)] {
            let (view, name) = (view(cosine, side), format!("index {eta} roughness {roughness} {side:?} {cosine}"));
            let [reflected, transmitted] = [Lobe::Reflection, Lobe::Transmission]
                .map(|lobe| expected(&view, |light| (surface.scatter_density(&view, light), lobe)));
            let inner = reflected.len() - 1;
            let mut shares: Vec<f64> = (0..inner).map(|k| reflected[k] + transmitted[k]).collect();
            let sum: f64 = shares.iter().sum();
            // Tables and cells of the quadrature.
            assert!((sum - 1.0).abs() < 5e-3, "{name}: {sum}");
            shares.iter_mut().for_each(|share| *share /= sum);
            let mut state = 5;
            check_bins(&name, &shares, || bin(surface.scatter(&view, || random(&mut state)).1));
            let crossing: f64 = transmitted[..inner].iter().sum();
            let shares: Vec<f64> = transmitted[..inner].iter().map(|share| share / crossing).collect();
            check_bins(&format!("{name}, across"), &shares, || {
                bin(surface.cross(&view, || random(&mut state)).expect("it crosses"))
            });
        }
    }
}

/// The mean cosine below the boundary is that of particles, within four standard errors of 10⁵ and what the tables differ
/// by; below a smooth one it is Snell's.
///
/// Seen to catch: the cosine without what several microfacets send.
#[test]
fn light_goes_on_at_the_mean_cosine() {
    for (eta, roughness) in [(1.4, 0.55), (1.5, 0.9), (1.3, 0.05)] {
        let boundary = RoughBoundary::new(eta, roughness);
        for cosine in [0.1, 0.3, 0.8] {
            let (view, mut state) = (view(cosine, Side::Outside), 3);
            let mut one = || {
                let below = boundary.surface(roughness).cross(&view, || random(&mut state)).expect("it crosses");
                -below.dot(view.normal)
            };
            let mean = (0..100_000).map(|_| one()).sum::<f64>() / 1e5;
            let stated = boundary.refracted_cosine(cosine, roughness);
            assert!((mean - stated).abs() < 4.0 * 0.3 / 316.0 + 2e-3, "{eta} {roughness} {cosine}: {mean} {stated}");
            let snell = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
            assert!(roughness > 0.1 || (stated - snell).abs() < 2e-3, "{stated} {snell}");
        }
    }
}

/// Seen to catch: visible normals that are not stretched back, a density without the share of several microfacets,
/// refraction with its index once in the Jacobian.
#[test]
fn samples_have_the_density_that_is_stated() {
    for roughness in [0.4, 1.0] {
        let boundary = RoughBoundary::new(1.5, roughness);
        for cosine in [0.15, 0.7] {
            let at = format!("roughness {roughness} cosine {cosine}");
            let outside = view(cosine, Side::Outside);
            check(&format!("gloss {at}"), &gloss(0.5, roughness, DVec3::splat(0.7)), &outside, Lobe::Reflection);
            for (side, lobe) in [Side::Outside, Side::Inside]
                .into_iter()
                .flat_map(|side| [(side, Lobe::Reflection), (side, Lobe::Transmission)])
            {
                check(&format!("{side:?} {lobe:?} {at}"), &boundary.surface(roughness), &view(cosine, side), lobe);
            }
        }
    }
}

/// A mirror keeps the color of its metal, and a layer over black shows highlights alone.
#[test]
fn without_roughness_the_layer_is_a_mirror() {
    let color = DVec3::new(0.9, 0.6, 0.3);
    let mirror = gloss(1.0, 0.0, color);
    let sample = mirror.sample(&view(1.0, Side::Outside), Lobe::Reflection, || unreachable!()).expect("mirrored");
    assert!(mirror.is_specular() && sample.weight.abs_diff_eq(color, 1e-12) && sample.direction == DVec3::Z);
    let layer = Schlick { normal: DVec3::splat(0.04), grazing: DVec3::ONE };
    assert!(Stated::dielectric(1.5, 1.0, DVec3::ONE).normal.abs_diff_eq(layer.normal, 1e-12));
    assert_eq!(gloss(0.0, 0.0, DVec3::ZERO).base(&view(0.5, Side::Outside), DVec3::Z), DVec3::ZERO);
}
