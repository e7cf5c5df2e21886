//! Walks below a rough boundary: what they do not lose, from the light against from the camera, and beside a smooth
//! boundary. Seeds are fixed; were they drawn anew, a correct program would fail one decision in 15 000 (four standard
//! errors).

use bsdf::{RoughBoundary, RoughDielectric};
use bssrdf::Coefficients;
use scene::{
    DVec3, SurfacePoint,
    light::{DirectionalLight, Light, LightTree, PointLight},
    random::{Purpose, Stream},
    warp,
};
use test_support::meshes::{self, Mesh, Part, World, uniform_point, world};
use walks::{Boundary, End, Lamps, Matter, Meeting, Rough, Sequence, Slab, Smooth, Solid, Start, observed_walk};

/// A mean and its squared standard error.
type Mean = [f64; 2];

fn mean(values: impl Iterator<Item = f64>) -> Mean {
    let (n, sum, squares) = values.fold((0.0, 0.0, 0.0), |(n, s, q), x| (n + 1.0, s + x, q + x * x));
    [sum / n, (squares / n - (sum / n).powi(2)) / n]
}

/// Fails unless two means are equal within four standard errors, which are at most `most` of them.
fn assert_equal(what: &str, a: Mean, b: Mean, most: f64) {
    let error = (a[1] + b[1]).sqrt();
    println!("{what}: {:.5} {:.5}, error {error:.5}", a[0], b[0]);
    assert!((a[0] - b[0]).abs() < 4.0 * error + 1e-12, "{what}: {a:?} {b:?}");
    assert!(error < most * a[0], "{what}: too rough to tell");
}

fn matter(albedo: f64, g: f64, eta: f64) -> Matter {
    let coefficients = Coefficients { sigma_a: 1.0 - albedo, sigma_s: albedo / (1.0 - g), asymmetry: g };
    Matter::new(&coefficients, eta).expect("it scatters")
}

/// The share of light of this direction that leaves a slab through each face, after a collision or without one.
fn shares(slab: Slab, matter: &Matter, boundary: &impl Boundary, light: DVec3, walks: u64) -> [Mean; 2] {
    let stream = Stream::new(7, Purpose::LightWalk);
    let end = |k: u64| {
        let mut random = Sequence::new(stream.item(k));
        let meeting = Meeting { position: DVec3::ZERO, face: Slab::FRONT, normal: DVec3::NEG_Z, direction: light };
        let direction = boundary.enter(&meeting, &mut random).expect("it enters");
        let start = Start { position: DVec3::ZERO, direction, face: Some(Slab::FRONT) };
        observed_walk(&slab, matter, boundary, &start, &mut random, &mut ())
    };
    let ends: Vec<End> = (0..walks).map(end).collect();
    [Slab::FRONT, Slab::BACK].map(|face| {
        mean(ends.iter().map(|end| match end {
            End::Scattered(exit) | End::Unscattered(exit) if exit.face == face => exit.weight,
            _ => 0.0,
        }))
    })
}

/// Without absorption, all light that enters leaves again, to rounding: a boundary takes none of the walks' weight.
///
/// Seen to catch: a thousandth of the weight lost at each reflection.
#[test]
fn what_enters_leaves() {
    let light = DVec3::new(0.6, 0.0, 0.8);
    for (eta, roughness) in [(1.4, 0.3), (1.5, 0.9), (0.8, 0.5)] {
        let boundary = RoughBoundary::new(eta, roughness);
        let rough = Rough(|_: &Meeting| boundary.surface(roughness));
        for (albedo, g, thickness) in [(1.0, 0.0, 1.0), (1.0, 0.7, 14.0)] {
            let [front, back] = shares(Slab { thickness }, &matter(albedo, g, eta), &rough, light, 4000);
            assert!((front[0] + back[0] - 1.0).abs() < 1e-9, "index {eta} roughness {roughness}: {front:?} {back:?}");
            assert!(front[0] > 0.05 && back[0] > 0.01, "{front:?} {back:?}");
        }
    }
}

/// A slightly rough boundary is a smooth one, and a rough one is not: it lets more light out of a medium that absorbs.
///
/// Seen to catch: the index of the way in for the way out.
#[test]
fn without_roughness_the_boundary_is_smooth() {
    let (light, matter) = (DVec3::new(0.8, 0.0, 0.6), matter(0.9, 0.3, 1.4));
    let reflected = |roughness: f64| {
        let boundary = RoughBoundary::new(1.4, roughness);
        let rough = Rough(|_: &Meeting| boundary.surface(roughness));
        shares(Slab { thickness: 4.0 }, &matter, &rough, light, 200_000)
    };
    let smooth = shares(Slab { thickness: 4.0 }, &matter, &Smooth { eta: 1.4 }, light, 200_000);
    for (face, (a, b)) in smooth.into_iter().zip(reflected(0.03)).enumerate() {
        assert_equal(&format!("face {face}"), a, b, 0.01);
    }
    let rough = reflected(0.6)[0];
    assert!(rough[0] > 1.03 * smooth[0][0], "{rough:?} {smooth:?}");
}

/// Light below a rough boundary.
struct Case {
    world: World,
    light: Box<dyn Light>,
    matter: Matter,
    boundary: RoughBoundary,
    roughness: f64,
}

impl Case {
    fn new(mesh: Mesh, light: impl Light + 'static, [albedo, g, eta]: [f64; 3], roughness: f64) -> Case {
        let (matter, boundary) = (matter(albedo, g, eta), RoughBoundary::new(eta, roughness));
        let world = world(&[Part::translucent(mesh)], &[], DVec3::ZERO);
        Case { world, light: Box::new(light), matter, boundary, roughness }
    }

    fn surface<'a>(&'a self) -> impl Fn(&Meeting) -> RoughDielectric<'a> {
        |_| self.boundary.surface(self.roughness)
    }

    fn solid(&self) -> Solid<'_> {
        Solid::new(&self.world.scene.mesh, &self.world.rays, 0, |_| true).expect("it has triangles")
    }

    /// The beginning of a walk of light or of a view that arrives at a point from `towards`, and what share enters.
    fn entering(&self, point: &SurfacePoint, towards: DVec3, random: &mut Sequence) -> Option<(Start, f64)> {
        let (position, face, normal) = (point.position, point.triangle, point.normal);
        let meeting = Meeting { position, face, normal, direction: -towards };
        let direction = Rough(self.surface()).enter(&meeting, random)?;
        let share = self.boundary.transmittance(normal.dot(towards), self.roughness);
        Some((Start { position, direction, face: Some(face) }, share))
    }

    /// The power that walks from the light bring out, of the upper and the lower half.
    fn by_light(&self, walks: u64) -> [Mean; 2] {
        let (solid, stream) = (self.solid(), Stream::new(1, Purpose::LightWalk));
        self.powers(walks, |k| {
            let mut random = Sequence::new(stream.item(k));
            let (point, area) = uniform_point(&self.world.scene.mesh, [(); 3].map(|()| random.uniform()));
            let arriving = self.light.illuminate(&point, [0.0; 2])?;
            let from = Some(point.triangle);
            if !self.world.rays.visible(point.position, arriving.direction, arriving.distance, from) {
                return None;
            }
            let (start, share) = self.entering(&point, arriving.direction, &mut random)?;
            let boundary = Rough(self.surface());
            let end = observed_walk(&solid, &self.matter, &boundary, &start, &mut random, &mut ());
            let End::Scattered(exit) = end else { return None };
            Some((exit.position, arriving.irradiance.x * area * share * exit.weight))
        })
    }

    /// The power that walks from the camera see there.
    fn by_camera(&self, walks: u64) -> [Mean; 2] {
        let (solid, stream) = (self.solid(), Stream::new(2, Purpose::Gather));
        let lights = LightTree::new([&*self.light]);
        self.powers(walks, |k| {
            let mut random = Sequence::new(stream.item(k));
            let (point, area) = uniform_point(&self.world.scene.mesh, [(); 3].map(|()| random.uniform()));
            let (x, y) = point.normal.any_orthonormal_pair();
            let view = warp::cosine_hemisphere_in([x, y, point.normal], [random.uniform(), random.uniform()]);
            let (start, share) = self.entering(&point, view, &mut random)?;
            let mut light = Lamps::new(&self.world.rays, &lights, self.surface(), 0);
            observed_walk(&solid, &self.matter, &Rough(self.surface()), &start, &mut random, &mut light);
            Some((point.position, share * light.radiance * std::f64::consts::PI * area))
        })
    }

    fn powers(&self, walks: u64, one: impl Fn(u64) -> Option<(DVec3, f64)>) -> [Mean; 2] {
        let all: Vec<Option<(DVec3, f64)>> = (0..walks).map(one).collect();
        [false, true].map(|lower| {
            let of_half = |found: &Option<(DVec3, f64)>| found.filter(|(p, _)| (p.z < 0.0) == lower);
            mean(all.iter().map(|found| of_half(found).map_or(0.0, |(_, power)| power)))
        })
    }
}

/// The power out of both halves of a body is the same from the light and from the camera: of parallel light and of a
/// point, for smooth and rough microfacets, with jumps and without.
///
/// Seen to catch: light sampled before the first collision as well; a weight for the index at the boundary; a view from
/// outside where light leaves.
#[test]
fn from_the_light_and_from_the_camera() {
    let sun = DirectionalLight { direction: DVec3::new(0.5, 0.1, 0.8).normalize(), irradiance: DVec3::ONE };
    let position = DVec3::new(1.0, 0.5, 12.0);
    let lamp = PointLight { position, intensity: DVec3::splat(150.0), spot: None, range: None };
    let sphere = || meshes::sphere(4.0, 3);
    for (what, case, walks) in [
        ("sphere", Case::new(sphere(), sun.clone(), [0.9, 0.0, 1.4], 0.6), 60_000),
        ("rougher, forward", Case::new(sphere(), sun.clone(), [0.9, 0.6, 1.5], 0.9), 40_000),
        ("box", Case::new(meshes::slab(DVec3::new(6.0, 5.0, 4.0), 2), sun.clone(), [0.95, 0.0, 1.3], 0.8), 60_000),
        ("thin", Case::new(meshes::slab(DVec3::new(4.0, 4.0, 0.5), 2), sun.clone(), [0.9, 0.0, 1.4], 0.8), 60_000),
        ("lamp", Case::new(sphere(), lamp, [0.9, 0.0, 1.4], 0.8), 60_000),
        ("large", Case::new(meshes::slab(DVec3::new(30.0, 30.0, 12.0), 2), sun, [0.995, 0.0, 1.3], 0.7), 30_000),
    ] {
        let (light, camera) = (case.by_light(walks), case.by_camera(walks));
        for (half, (a, b)) in light.into_iter().zip(camera).enumerate() {
            assert_equal(&format!("{what}, half {half}"), a, b, 0.08);
        }
    }
}
