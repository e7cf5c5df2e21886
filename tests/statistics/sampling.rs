//! Chi-square tests of draws against the density that is returned with them.

use glam::{DVec3, Vec3};
use sample_surface::{Choice, TriangleChoice};
use scene::{
    NormalKind, SurfacePoint,
    light::{LightChoice, LightTree, ReceiverBounds},
    random::{Item, Purpose, Stream},
    warp,
};
use std::f64::consts::PI;
use test_support::{
    EFFORT,
    chi_square::assert_fits,
    meshes::{Light, Part, World, graded_disc, slab, world},
    quadrature::integrate,
};

const DRAWS: u64 = 1_000_000 * EFFORT;

fn items(seed: u64) -> impl Iterator<Item = Item> {
    let stream = Stream::new(seed, Purpose::Surface);
    (0..DRAWS).map(move |k| stream.item(k))
}

/// Counts of triangles against the density per area that comes with each, times the area of the triangle. Densities
/// that do not add up to one fail the check of the total in the test itself.
///
/// Seen to catch: the uniform rule's density without N; the area rule choosing uniformly; the uniform rule never
/// choosing the last triangle.
#[test]
fn triangles_are_chosen_with_the_density_returned() {
    for (name, mesh) in [("disc", graded_disc(0.1, 1.0, 6)), ("slab", slab(DVec3::new(1.0, 2.0, 0.3), 4))] {
        let world = world(&[Part::translucent(mesh)], &[], DVec3::ONE);
        let mesh = &world.scene.mesh;
        for (seed, rule) in [(1, Choice::Area), (2, Choice::Uniform)] {
            let choice = TriangleChoice::new(mesh, rule, |_| true, &[]);
            let mut observed = vec![0; mesh.triangles.len()];
            let mut density = vec![0.0; mesh.triangles.len()];
            for item in items(seed) {
                let chosen = choice.choose(item.uniform(0));
                observed[chosen.triangle as usize] += 1;
                density[chosen.triangle as usize] = chosen.pdf_area;
            }
            let expected: Vec<f64> =
                density.iter().enumerate().map(|(k, pdf)| pdf * mesh.area(k) * DRAWS as f64).collect();
            assert_fits(&format!("{name}, {} rule", rule.name()), &observed, &expected);
        }
    }
}

/// Counts in a grid of congruent small triangles.
///
/// Seen to catch: the square root left out, which crowds the points around one corner.
#[test]
fn points_cover_a_triangle_evenly() {
    const SIDE: usize = 16;
    let mut observed = vec![0; SIDE * SIDE];
    for item in items(3) {
        let [_, b, c] = warp::triangle([item.uniform(1), item.uniform(2)]).map(|w| w * SIDE as f64);
        // Square cells of (b, c), each cut along its diagonal.
        let (i, j) = (b as usize, c as usize);
        let upper = usize::from(b.fract() + c.fract() > 1.0);
        // The cells of row i before j number 2j; the row has 2(SIDE − i) − 1.
        let row = i * (2 * SIDE - i);
        observed[(row + 2 * j + upper).min(SIDE * SIDE - 1)] += 1;
    }
    let expected = vec![DRAWS as f64 / (SIDE * SIDE) as f64; SIDE * SIDE];
    assert_fits("points on a triangle", &observed, &expected);
}

/// Counts in cells of cosine and azimuth against the integral of the density per solid angle.
///
/// Seen to catch: directions uniform over the hemisphere (a lost cosine).
#[test]
fn directions_follow_the_cosine() {
    const BANDS: usize = 16;
    let normal = DVec3::new(-0.48, 0.6, -0.64);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let mut observed = vec![0; BANDS * BANDS];
    for item in items(4) {
        let direction = warp::cosine_hemisphere(normal, [item.uniform(4), item.uniform(5)]);
        let azimuth = direction.dot(bitangent).atan2(direction.dot(tangent)) / (2.0 * PI) + 0.5;
        let cell = |x: f64| ((x * BANDS as f64) as usize).min(BANDS - 1);
        observed[cell(direction.dot(normal)) * BANDS + cell(azimuth)] += 1;
    }
    let width = 1.0 / BANDS as f64;
    let expected: Vec<f64> = (0..BANDS * BANDS)
        .map(|k| {
            let low = (k / BANDS) as f64 * width;
            let band = integrate(low, low + width, 1, warp::cosine_hemisphere_pdf_solid_angle);
            band * 2.0 * PI * width * DRAWS as f64
        })
        .collect();
    assert_fits("cosine hemisphere", &observed, &expected);
}

/// A scene with five lights, some of which do not reach all points.
fn lit_by_five() -> World {
    let point = |x: f64, z: f64, power: f64| Light::Point {
        position: DVec3::new(x, -1.5, z),
        intensity: DVec3::new(power, 0.5 * power, 0.0),
    };
    let sun = Light::Directional { towards: DVec3::new(0.6, -0.48, 0.64), irradiance: DVec3::splat(0.5) };
    let mut lamp = Part { emission: DVec3::new(2.0, 1.0, 0.5), ..Part::opaque(slab(DVec3::splat(0.1), 1)) };
    lamp.mesh.positions.iter_mut().for_each(|p| *p += Vec3::new(0.0, -2.5, 1.5));
    let body = Part::translucent(slab(DVec3::new(1.0, 1.0, 0.5), 2));
    world(&[body, lamp], &[point(0.5, 2.0, 3.0), point(-3.0, -2.0, 5.0), sun], DVec3::splat(0.1))
}

/// How often a light is picked against the probability returned with it.
///
/// Seen to catch: all lights picked alike; the returned probability left at one.
#[test]
fn lights_are_picked_with_the_probability_returned() {
    let world = lit_by_five();
    let count = world.scene.lights().count();
    assert_eq!(count, 5);
    let lights = LightTree::new(world.scene.lights());
    for triangle in [0, 12, 26, 34, 42] {
        let point: SurfacePoint = world.scene.mesh.point(triangle, [0.2, 0.5, 0.3], NormalKind::Geometric);
        let (mut observed, mut probability) = (vec![0; count], vec![0.0; count]);
        let choice = LightChoice::new(&lights, &ReceiverBounds::point(&point), 1);
        for item in items(u64::from(triangle)).take(DRAWS as usize / 4) {
            let pick = choice.pick(&point, item.uniform(3)).expect("the environment reaches every point");
            observed[pick.index] += 1;
            probability[pick.index] = pick.share;
        }
        let expected: Vec<f64> = probability.iter().map(|p| p * (DRAWS / 4) as f64).collect();
        assert_fits(&format!("lights seen from triangle {triangle}"), &observed, &expected);
    }
}
