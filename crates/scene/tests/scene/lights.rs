//! Irradiance by each kind of light against values known on paper, and the choice among lights.

use crate::meshes::{direction, mesh, random};
use scene::{
    DVec3, Mesh, Rays, SurfacePoint, Vec3,
    light::{
        AreaLight, DirectionalLight, Environment, EnvironmentMap, Illumination, Light, LightChoice, LightTree, Lit,
        Pick, PointLight, ReceiverBounds, Spot, all_light_at, light_at,
    },
};
use std::f64::consts::PI;

fn facing(position: DVec3, normal: DVec3) -> SurfacePoint {
    SurfacePoint::smooth(position, normal, normal, 0, 0)
}

fn irradiance(light: &dyn Light, at: &SurfacePoint) -> f64 {
    light.illuminate(at, [0.5; 2]).map_or(0.0, |l| l.irradiance.x)
}

fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{found} instead of {expected}");
}

/// A unit vector at this angle to +Z, degrees.
fn tilted(degrees: f64) -> DVec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    DVec3::new(sine * 0.6, sine * 0.8, cosine)
}

fn bulb(position: DVec3) -> PointLight {
    PointLight { position, intensity: DVec3::splat(20.0), spot: None, range: None }
}

#[test]
fn directional_light_falls_with_the_cosine() {
    let light = DirectionalLight { direction: DVec3::Z, irradiance: DVec3::splat(7.0) };
    for degrees in [0.0, 30.0, 60.0, 89.0] {
        let expected = 7.0 * f64::to_radians(degrees).cos();
        assert_close(irradiance(&light, &facing(DVec3::ONE, tilted(degrees))), expected);
    }
    assert!(light.illuminate(&facing(DVec3::ONE, tilted(91.0)), [0.5; 2]).is_none());
    let seen = light.illuminate(&facing(DVec3::ONE, DVec3::Z), [0.5; 2]).expect("lit");
    assert_eq!((seen.direction, seen.distance), (DVec3::Z, f64::INFINITY));
}

#[test]
fn point_light_falls_with_the_cosine_and_the_square_of_the_distance() {
    for distance in [1e-6, 0.5, 3.0, 1e6] {
        let light = bulb(DVec3::new(1.0, 2.0, 3.0 + distance));
        for degrees in [0.0, 45.0, 80.0] {
            let at = facing(DVec3::new(1.0, 2.0, 3.0), tilted(degrees));
            let real = (3.0 + distance) - 3.0; // as it is after rounding
            let lit = light.illuminate(&at, [0.5; 2]).expect("lit");
            assert_close(lit.irradiance.x, 20.0 * f64::to_radians(degrees).cos() / (real * real));
            assert_close(lit.distance, real);
            assert_close(light.importance(&at), 3.0 * lit.irradiance.x);
        }
    }
}

#[test]
fn spot_light_falls_off_between_its_cones() {
    let (inner, outer) = (20f64.to_radians(), 40f64.to_radians());
    let spot = Spot::new(DVec3::NEG_Z, inner, outer);
    let light = PointLight { spot: Some(spot), ..bulb(DVec3::ZERO) };
    let at = |degrees: f64| irradiance(&light, &facing(-2.0 * tilted(degrees), tilted(degrees)));
    assert_close(at(0.0), 5.0);
    assert_close(at(19.999), 5.0);
    let half_way = (30f64.to_radians().cos() - outer.cos()) / (inner.cos() - outer.cos());
    assert_close(at(30.0), 5.0 * half_way * half_way);
    let half_cosine = ((inner.cos() + outer.cos()) / 2.0).acos().to_degrees();
    assert!((at(half_cosine) - 5.0 / 4.0).abs() < 1e-12);
    assert!(at(39.9) > 0.0 && at(39.9) < 1e-3);
    assert_eq!((at(40.1), at(90.0), at(180.0)), (0.0, 0.0, 0.0));
}

/// Where angles are small the falloff depends on their squares: with `x` from the axis, `(o² - x²)/(o² - i²)`, squared.
/// Seen to catch: a least width of 0.001 of the difference of cosines, which left 4 % on the axis at 0.02 rad.
#[test]
fn narrow_spots_are_as_bright_as_wide_ones() {
    for (inner, outer) in [(0.0, 0.02), (0.01, 0.02), (0.0, 1e-4), (5e-8, 1e-7), (0.0, 1e-9), (1e-9, 1e-9), (0.5, 0.5)]
    {
        let spot = Spot::new(DVec3::NEG_Z, inner, outer);
        let light = PointLight { spot: Some(spot), ..bulb(DVec3::Z * 2.0) };
        let at = |angle: f64| irradiance(&light, &facing(DVec3::X * (2.0 * angle.tan()), DVec3::Z));
        let share = |angle: f64| at(angle) / (5.0 * angle.cos().powi(3));
        assert_close(at(0.0), 5.0);
        assert_close(share(0.999 * inner), 1.0);
        assert_eq!(at(1.001 * outer), 0.0, "{inner} {outer}");
        let middle = 0.5 * (inner + outer);
        let expected = (outer * outer - middle * middle) / (outer * outer - inner * inner);
        if outer < 0.03 && inner < outer {
            assert!((share(middle) / (expected * expected) - 1.0).abs() < 1e-3, "{inner} {outer}: {}", share(middle));
        }
        assert!(light.bounds().is_some_and(|bounds| bounds.cone.half_angle >= outer));
    }
}

#[test]
fn range_fades_to_nothing() {
    let light = |z| PointLight { range: Some(2.0), ..bulb(DVec3::Z * z) };
    let at = |distance: f64| irradiance(&light(distance), &facing(DVec3::ZERO, DVec3::Z));
    assert_close(at(1.0), 20.0 * (1.0 - 1.0 / 16.0));
    assert_close(at(0.01), 20.0 / 1e-4 * (1.0 - (0.005f64).powi(4)));
    assert_eq!((at(2.0), at(2.5), at(1e9)), (0.0, 0.0, 0.0));
}

#[test]
fn constant_environment_gives_pi_times_its_radiance() {
    let light = Environment::Constant(DVec3::new(0.5, 1.0, 2.0));
    let normal = tilted(70.0);
    let n = 64;
    let mut sum = DVec3::ZERO;
    let mut weighted = DVec3::ZERO;
    for k in 0..n * n {
        let xi = [(k / n) as f64 + 0.5, (k % n) as f64 + 0.5].map(|x| x / n as f64);
        let lit = light.illuminate(&facing(DVec3::ZERO, normal), xi).expect("lit from everywhere");
        assert!(lit.direction.dot(normal) > 0.0 && lit.distance.is_infinite());
        sum += lit.irradiance;
        weighted += lit.direction;
    }
    assert!((sum / (n * n) as f64).distance(PI * DVec3::new(0.5, 1.0, 2.0)) < 1e-12);
    // Directions have the density cos/pi: their mean is two thirds of the normal.
    assert!((weighted / (n * n) as f64).distance(normal * (2.0 / 3.0)) < 1e-3);
}

/// Lambert's formula for the irradiance by a polygon of unit radiance that lies above the horizon:
/// `E = 1/2 Σ θ_i n·γ_i`, with the angle and the unit normal of each edge as seen from the point.
fn lambert(polygon: &[DVec3], at: &SurfacePoint) -> f64 {
    let corners: Vec<DVec3> = polygon.iter().map(|c| (*c - at.position).normalize()).collect();
    let edge = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        a.angle_between(b) * a.cross(b).normalize().dot(at.normal)
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / 2.0
}

const SQUARE: [DVec3; 4] =
    [DVec3::new(-0.5, 0.5, 2.0), DVec3::new(0.5, 0.5, 2.0), DVec3::new(0.5, -0.5, 2.0), DVec3::new(-0.5, -0.5, 2.0)];

/// A unit square two above the origin, facing down, of three uneven triangles.
fn square() -> Mesh {
    let points = [SQUARE.as_slice(), &[DVec3::new(0.5, 0.3, 2.0)]].concat();
    mesh(&points, &[[0, 1, 4], [0, 4, 2], [0, 2, 3]])
}

#[test]
fn area_light_has_the_form_factor_of_its_shape() {
    let light = AreaLight::new(&square(), &[0, 1, 2], DVec3::splat(3.0), false).expect("it has an area");
    let n = 400_000;
    for (position, normal) in [
        (DVec3::ZERO, DVec3::Z),
        (DVec3::new(0.2, -0.1, 1.5), DVec3::Z),
        (DVec3::new(2.0, 1.0, 0.0), tilted(30.0)),
        (DVec3::new(0.0, 0.0, -100.0), tilted(60.0)),
    ] {
        let at = facing(position, normal);
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 0..n {
            let item = random(k);
            let e = light.illuminate(&at, [item.uniform(0), item.uniform(1)]).map_or(0.0, |l| l.irradiance.x);
            sum += e;
            squares += e * e;
        }
        let mean = sum / n as f64;
        let error = ((squares / n as f64 - mean * mean) / n as f64).sqrt();
        let expected = 3.0 * lambert(&SQUARE, &at);
        assert!((mean - expected).abs() < 4.0 * error + 1e-12 && error < 0.002 * mean, "{mean} ± {error}, {expected}");
    }
    // The oracle itself: a square of half edge h at distance d, head-on.
    let (h, d) = (0.5f64, 2.0f64);
    let far = (h * h + d * d).sqrt();
    let closed = 4.0 * (h / far) * (h / far).atan();
    assert!((lambert(&SQUARE, &facing(DVec3::ZERO, DVec3::Z)) - closed).abs() < 1e-12);
}

#[test]
fn area_light_shines_to_its_front_or_to_both_sides() {
    let light = |double_sided| AreaLight::new(&square(), &[0, 1, 2], DVec3::ONE, double_sided).expect("an area");
    let (below, above) = (facing(DVec3::ZERO, DVec3::Z), facing(DVec3::Z * 4.0, DVec3::NEG_Z));
    assert!(irradiance(&light(false), &below) > 0.0 && irradiance(&light(false), &above) == 0.0);
    assert_close(irradiance(&light(true), &above), irradiance(&light(false), &below));
    assert!(AreaLight::new(&square(), &[], DVec3::ONE, false).is_none());
}

fn tree_of(lights: &[Box<dyn Light>]) -> LightTree<'_> {
    LightTree::new(lights.iter().map(|light| &**light))
}

fn any_picked(lights: &[Box<dyn Light>], at: &SurfacePoint) -> bool {
    LightChoice::new(&tree_of(lights), &ReceiverBounds::point(at), 1).pick(at, 0.5).is_some()
}

fn lights() -> Vec<Box<dyn Light>> {
    let spot = Spot::new(DVec3::NEG_Z, 0.9f64.acos(), 0.5f64.acos());
    let pixels = (0..72).map(|k| Vec3::splat([0.0, 0.0, 1.0][k % 3])).collect();
    let map = EnvironmentMap::new((12, 6), pixels, 1.0, 20.0).expect("good pixels");
    vec![
        Box::new(DirectionalLight { direction: tilted(20.0), irradiance: DVec3::new(0.0, 3.0, 0.0) }),
        Box::new(PointLight { range: Some(9.0), ..bulb(DVec3::Z) }),
        Box::new(PointLight { spot: Some(spot), ..bulb(DVec3::Z * 3.0) }),
        Box::new(AreaLight::new(&square(), &[0, 1, 2], DVec3::X, false).expect("an area")),
        Box::new(AreaLight::new(&square(), &[0, 1, 2], DVec3::Z, true).expect("an area")),
        Box::new(Environment::Constant(DVec3::splat(0.1))),
        Box::new(Environment::Map(map.into())),
    ]
}

/// A light that could reach a point from above its triangle must have a chance to be picked.
#[test]
fn importance_is_positive_wherever_there_is_light() {
    let lights = lights();
    let mut lit = [0; 7];
    for k in 0..200_000 {
        let item = random(k);
        let position = direction(item, 0) * (5.0 * item.uniform(2));
        let mut at = facing(position, direction(item, 3));
        // An interpolated normal that is not the triangle's.
        at.normal = (at.normal + 0.5 * direction(item, 5)).normalize();
        for (which, light) in lights.iter().enumerate() {
            let Some(l) = light.illuminate(&at, [item.uniform(7), item.uniform(8)]) else { continue };
            assert!(l.irradiance.is_finite() && l.irradiance.min_element() >= 0.0 && l.distance > 0.0);
            if l.irradiance != DVec3::ZERO && l.direction.dot(at.geometric_normal) > 0.0 {
                lit[which] += 1;
                assert!(light.importance(&at) > 0.0, "light {which} at {position}");
            }
        }
    }
    assert!(lit.iter().all(|n| *n > 1000), "the scan meets every light: {lit:?}");
}

/// Sampling, density and emitted radiance are one: `E p(ω) = L (n·ω)` wherever a direction has a density.
///
/// Seen to catch: a density without the cosine at the emitter.
#[test]
fn density_and_radiance_are_those_of_the_samples() {
    let lights = lights();
    let (mut compared, mut equal) = ([0; 7], [0; 7]);
    for k in 0..50_000 {
        let item = random(k);
        let at = facing(direction(item, 0) * (5.0 * item.uniform(2)), direction(item, 3));
        for (which, light) in lights.iter().enumerate() {
            let Some(l) = light.illuminate(&at, [item.uniform(7), item.uniform(8)]) else { continue };
            let (pdf, radiance) = (light.pdf_solid_angle(&at, l.direction), light.radiance(at.position, l.direction));
            if pdf > 0.0 {
                let expected = radiance * at.normal.dot(l.direction);
                compared[which] += 1;
                let is_stated = (l.density - pdf).abs() <= 1e-9 * pdf;
                let fits = (l.irradiance * pdf).distance(expected) <= 1e-9 * expected.length();
                equal[which] += u32::from(is_stated && fits);
            } else {
                assert_eq!(l.density, 0.0);
                assert_eq!(radiance, DVec3::ZERO);
            }
        }
    }
    assert_eq!(compared[..3], [0; 3], "directional and point lights have no density");
    // On an edge, rounding may put a direction into either of two pixels.
    let all_but_few = |k: usize| equal[k] > 1000 && compared[k] - equal[k] <= compared[k] / 10_000;
    assert!((3..7).all(all_but_few), "{equal:?} of {compared:?}");
}

/// Clouds are known by their lights: whatever defines one must change its identity.
///
/// Seen to catch: a range that is left out.
#[test]
fn every_parameter_of_a_light_is_a_part_of_its_identity() {
    let spot = |axis, inner, outer| PointLight { spot: Some(Spot::new(axis, inner, outer)), ..bulb(DVec3::Z) };
    let sun = |direction, irradiance| DirectionalLight { direction, irradiance };
    let area = |triangles: &[usize], radiance, double_sided| {
        AreaLight::new(&square(), triangles, radiance, double_sided).expect("an area")
    };
    let map = |size, value, scale, degrees| {
        Environment::Map(EnvironmentMap::new(size, vec![Vec3::splat(value); 8], scale, degrees).expect("good").into())
    };
    let all: Vec<Box<dyn Light>> = vec![
        Box::new(bulb(DVec3::Z)),
        Box::new(bulb(DVec3::X)),
        Box::new(PointLight { intensity: DVec3::X, ..bulb(DVec3::Z) }),
        Box::new(PointLight { range: Some(9.0), ..bulb(DVec3::Z) }),
        Box::new(spot(DVec3::X, 0.1, 0.2)),
        Box::new(spot(DVec3::Y, 0.1, 0.2)),
        Box::new(spot(DVec3::X, 0.0, 0.2)),
        Box::new(spot(DVec3::X, 0.1, 0.3)),
        Box::new(sun(DVec3::X, DVec3::ONE)),
        Box::new(sun(DVec3::Y, DVec3::ONE)),
        Box::new(sun(DVec3::X, DVec3::X)),
        Box::new(area(&[0], DVec3::ONE, false)),
        Box::new(area(&[0], DVec3::X, false)),
        Box::new(area(&[0], DVec3::ONE, true)),
        Box::new(Environment::Constant(DVec3::ONE)),
        Box::new(Environment::Constant(DVec3::X)),
        Box::new(map((4, 2), 1.0, 1.0, 0.0)),
        Box::new(map((8, 1), 1.0, 1.0, 0.0)),
        Box::new(map((4, 2), 2.0, 1.0, 0.0)),
        Box::new(map((4, 2), 1.0, 2.0, 0.0)),
        Box::new(map((4, 2), 1.0, 1.0, 5.0)),
    ];
    let identity = |light: &dyn Light| {
        let mut hasher = blake3::Hasher::new();
        light.hash_into(&mut hasher);
        hasher.finalize()
    };
    let identities: Vec<_> = all.iter().map(|light| identity(&**light)).collect();
    for (k, one) in identities.iter().enumerate() {
        assert!(!identities[..k].contains(one), "{k}");
    }
}

#[test]
fn lights_are_picked_in_proportion_to_their_importance() {
    let lights = lights();
    let tree = tree_of(&lights);
    for at in [facing(DVec3::ZERO, tilted(10.0)), facing(DVec3::splat(0.3), tilted(170.0))] {
        let choice = LightChoice::new(&tree, &ReceiverBounds::point(&at), 1);
        let importance: Vec<f64> = lights.iter().map(|l| l.importance(&at)).collect();
        let total: f64 = importance.iter().sum();
        let n = 100_000;
        let mut counts = vec![0u32; lights.len()];
        let mut probabilities = vec![0.0; lights.len()];
        for k in 0..n {
            let Pick { index, share: probability, .. } =
                choice.pick(&at, (f64::from(k) + 0.5) / f64::from(n)).expect("some light");
            counts[index] += 1;
            probabilities[index] = probability;
        }
        for (k, count) in counts.iter().enumerate() {
            assert!((f64::from(*count) / f64::from(n) - importance[k] / total).abs() < 2.0 / f64::from(n), "light {k}");
            assert!(importance[k] == 0.0 || (probabilities[k] - importance[k] / total).abs() < 1e-15);
        }
        assert!((probabilities.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(choice.pick(&at, 1.0 - f64::EPSILON / 2.0).is_some_and(|p| importance[p.index] > 0.0));
    }
    let behind: Vec<Box<dyn Light>> = vec![Box::new(bulb(DVec3::NEG_Z))];
    assert!(!any_picked(&behind, &facing(DVec3::ZERO, DVec3::Z)));
}

/// One light at random, divided by its probability, gives on average what all lights give; hidden ones give nothing.
#[test]
fn one_light_at_random_has_the_mean_of_all() {
    let floor = |z| [[-1.0, -1.0], [1.0, -1.0], [0.0, 2.0]].map(|[x, y]| DVec3::new(x, y, z));
    let mesh = mesh(&[floor(0.0), floor(4.0)].concat(), &[[0, 1, 2], [3, 4, 5]]);
    let rays = Rays::new(&mesh);
    let at = facing(DVec3::ZERO, DVec3::Z);
    let lights: Vec<Box<dyn Light>> = vec![
        Box::new(bulb(DVec3::new(0.0, 1.0, 2.0))),
        Box::new(bulb(DVec3::Z * 5.0)), // behind the upper triangle
        Box::new(DirectionalLight { direction: tilted(60.0), irradiance: DVec3::splat(2.0) }),
    ];
    let expected = 20.0 / 5.0 * (2.0 / 5f64.sqrt()) + 2.0 * 0.5;
    let tree = tree_of(&lights);
    let choice = LightChoice::new(&tree, &ReceiverBounds::point(&at), 1);
    let n = 10_000;
    let (mut sum, mut traced, mut shadowed) = (0.0, 0, 0);
    for k in 0..n {
        let xi = [(f64::from(k) + 0.5) / f64::from(n), 0.5, 0.5];
        match light_at(&choice, &rays, &at, xi, &mut traced) {
            Lit::Light { irradiance, .. } => sum += irradiance.x,
            Lit::Shadowed => shadowed += 1,
            Lit::FacingAway | Lit::NoBounce => panic!("no light is behind"),
        }
    }
    assert!((sum / f64::from(n) - expected).abs() < 1e-3 * expected, "{}", sum / f64::from(n));
    assert!(traced == u64::from(n as u32) && shadowed > 0);
    let all = all_light_at(&tree, &rays, &at, || [0.5; 2], &mut traced);
    assert_close(all.x, expected);
}

/// At a light, or within rounding of it: no direction, or a number.
#[test]
fn a_light_in_the_surface_gives_nothing_or_something_finite() {
    let finite = |l: &Illumination| l.irradiance.is_finite() && l.direction.is_finite() && l.irradiance.x >= 0.0;
    for distance in [0.0, 1e-320, 1e-200, 1e-100, 1e-12, 1e-6] {
        let at = facing(DVec3::ZERO, DVec3::Z);
        let light = bulb(DVec3::Z * distance);
        let lit = light.illuminate(&at, [0.5; 2]);
        assert!(lit.as_ref().is_none_or(finite), "{distance}: {lit:?}");
        assert!(light.importance(&at).is_finite());
        assert!(distance < 1e-12 || lit.is_some(), "{distance}");

        let area = AreaLight::new(&square(), &[0, 1, 2], DVec3::ONE, true).expect("an area");
        for k in 0..10_000 {
            let item = random(k);
            let position = DVec3::new(item.uniform(0) - 0.5, item.uniform(1) - 0.5, 2.0 - distance);
            let at = facing(position, DVec3::Z);
            let lit = area.illuminate(&at, [item.uniform(2), item.uniform(3)]);
            assert!(lit.as_ref().is_none_or(finite), "{lit:?}");
            assert!(area.importance(&at).is_finite());
        }
    }
    let lights: Vec<Box<dyn Light>> = vec![Box::new(bulb(DVec3::ZERO))];
    assert!(!any_picked(&lights, &facing(DVec3::ZERO, DVec3::Z)));
}
