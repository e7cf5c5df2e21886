//! Meshes that modeling programs make: without area, with needles, duplicates, holes, or inside out.

use crate::{
    evaluate::assert_is,
    scenes::{Clear, aimed_at, assert_invisible, channel, render},
};
use bssrdf::{Exitant, Incident, Model, evaluate};
use formats::cloud::{Cloud, Sample};
use gather::{Filter, Settings, estimator::Estimator};
use glam::{DVec3, Vec3};
use sample_surface::Choice;
use scene::NormalKind;
use test_support::{
    meshes::{Light, Mesh, Part, World, quad, rectangle, slab, sphere, world},
    pipeline::{Lit, MODELS, Point, Sampling, by_area, cloud, gray, settings},
};

fn sun() -> Light {
    Light::Directional { towards: DVec3::new(0.36, 0.48, 0.8), irradiance: DVec3::ONE }
}

/// The given mesh under a directional light.
fn sunny(mesh: Mesh) -> World {
    world(&[Part::translucent(mesh)], &[sun()], DVec3::ZERO)
}

fn list(cloud: &Cloud) -> Vec<Sample> {
    cloud.samples(&cloud.meta().materials[0]).collect()
}

fn spread(model: Model) -> Settings {
    Settings { paths_per_pixel: 16, filter: Filter::Box, ..settings(model, 8, 8) }
}

/// Degenerate triangles have no normal and no density: the importer leaves them out and counts them, and N of either
/// rule of choice does not include them.
#[test]
fn zero_area_triangles_change_nothing() {
    let clean = slab(DVec3::new(1.0, 0.5, 0.25), 2);
    let mut dirty = clean.clone();
    for k in 0..10 {
        dirty.triangles.insert(4 * k as usize, [k, k, k + 1]);
    }
    dirty.triangles.extend([[0, 0, 0], [0, 1, 2]]); // a point, and three vertices in a row
    let (clean, dirty) = (sunny(clean), sunny(dirty));
    assert!(clean.scene.degenerate_triangles.is_empty());
    assert_eq!(dirty.scene.degenerate_triangles.values().sum::<u64>(), 12);
    for choice in [Choice::Area, Choice::Uniform] {
        let sampling = Sampling { choice, ..by_area(1000, 1) };
        let (clean, dirty) = (cloud(&clean, &sampling), cloud(&dirty, &sampling));
        assert_eq!(list(&clean), list(&dirty));
        assert_eq!(clean.meta().surface_area_m2, dirty.meta().surface_area_m2);
    }
}

/// Needles of 1 m by 1 µm between ordinary triangles: their area and normal keep all digits, and no ray passes
/// between them.
#[test]
fn slivers_of_a_millionth() {
    let mut mesh = rectangle([-1.0, 0.0], 1.0, 0.0, 1);
    let mut add = |part: Mesh| {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(part.positions);
        mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + first)));
    };
    (0..20).for_each(|k| add(rectangle([f64::from(k) * 1e-6, f64::from(k + 1) * 1e-6], 1.0, 0.0, 1)));
    add(rectangle([2e-5, 1.0], 1.0, 0.0, 1));
    let world = sunny(mesh);
    let needle = world.scene.mesh.point(5, [0.3, 0.3, 0.4], NormalKind::Geometric);
    assert_eq!(needle.normal, DVec3::Z);
    for choice in [Choice::Area, Choice::Uniform] {
        let cloud = cloud(&world, &Sampling { choice, ..by_area(1000, 1) });
        assert!((cloud.meta().surface_area_m2 - 4.0).abs() < 1e-6);
        assert_eq!(cloud.len(), 1000, "a flat mesh has no shadow");
        let settings = spread(Model::DirectionalDipole);
        let camera = aimed_at(DVec3::new(1e-5, 0.0, 0.0), DVec3::new(0.3, 0.0, 1.0), 2e-5);
        let rendered = render(&world, &cloud, &[gray(1.0, 10.0, 0.0, 1.3)], &camera, &settings);
        assert!(channel(&rendered, &settings, "Z").iter().all(|z| *z > 0.0), "a ray slipped through");
    }
}

/// A triangle that is there twice, or a second time with the opposite winding, is one surface: it is lit once, no
/// copy shadows it, and a camera path meets it once.
///
/// Seen to catch: copies that were kept, which doubled the scattered light, or left none where they lay back to back.
#[test]
fn duplicate_triangles_are_one_surface() {
    let once = quad(0.5, 0.0, 3);
    let one = cloud(&sunny(once.clone()), &by_area(1000, 1));
    for corners in [[0, 1, 2], [0, 2, 1]] {
        let mut twice = once.clone();
        twice.triangles.extend(once.triangles.iter().map(|triangle| corners.map(|k| triangle[k])));
        let twice = sunny(twice);
        let two = cloud(&twice, &by_area(1000, 1));
        assert_eq!((one.len(), two.len()), (1000, 1000));
        assert_eq!(two.meta().surface_area_m2, one.meta().surface_area_m2);
        assert_is("flux", DVec3::from_array(two.meta().mean_flux_w), DVec3::splat(0.8), 1e-6);
        let settings = spread(Model::StandardDipole);
        let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 0.2);
        let counts = render(&twice, &two, &[gray(1.0, 10.0, 0.0, 1.3)], &camera, &settings).counts;
        assert_eq!((counts.nested, counts.rays), (0, 3 * counts.paths));
    }
}

/// A sheet without a back: refracted light never leaves it. In an absorbing medium it is absorbed; in a clear one it
/// reaches the sky and is counted.
#[test]
fn open_mesh() {
    let world = sunny(quad(1.0, 0.0, 3));
    let cloud = cloud(&world, &by_area(1000, 1));
    let clear = Clear::new(sunny(quad(1.0, 0.0, 3)));
    let above = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 0.2);
    let below = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, -1.0), 0.2);
    for model in MODELS {
        let settings = spread(model);
        let counts = render(&world, &cloud, &[gray(1.0, 10.0, 0.0, 1.5)], &above, &settings).counts;
        assert_eq!((counts.gathers, counts.escaped_inside), (counts.paths, 0), "{counts:?}");
        assert_eq!((counts.rays, counts.cut_by_depth, counts.nested), (3 * counts.paths, 0, 0));
        let behind = render(&world, &cloud, &[gray(1.0, 10.0, 0.0, 1.5)], &below, &settings);
        assert_eq!(behind.counts.gathers, 0);
        let [above, below] =
            [&above, &below].map(|camera| assert_invisible("open and clear", &clear, &[1.5], camera, &settings));
        assert_eq!(above.escaped_inside, above.paths);
        // Met from behind, the sheet reflects 4 % into the medium.
        assert!(below.escaped_inside > 0 && below.escaped_inside < below.paths / 10, "{below:?}");
    }
}

/// All normals point inwards: the lit side faces away, the far side lies in its shadow, and no light is stored.
#[test]
fn inside_out_mesh() {
    let mut mesh = sphere(1.0, 3);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let camera = aimed_at(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), 1.2);
    let world = world(&[Part::translucent(mesh)], &[sun()], DVec3::ONE);
    let cloud = cloud(&world, &by_area(1000, 1));
    assert!(cloud.is_empty());
    assert_eq!(cloud.meta().samples_dropped.values().sum::<u64>(), 1000);
    let settings = spread(Model::DirectionalDipole);
    let rendered = render(&world, &cloud, &[gray(1.0, 10.0, 0.0, 1.3)], &camera, &settings);
    assert!(channel(&rendered, &settings, "subsurface.R").iter().all(|x| *x == 0.0));
    assert_invisible("inside out", &Clear::new(world), &[1.0], &camera, &settings);
}

/// Two objects at the same position: neither shadows the other, and a path that enters one of them leaves one of them,
/// never both or none.
#[test]
fn two_coincident_shells() {
    let shell = Part::translucent(sphere(1.0, 3));
    let world = world(&[shell.clone(), shell], &[sun()], DVec3::ZERO);
    let sampled = cloud(&world, &by_area(4000, 1));
    assert_eq!(sampled.meta().samples_dropped["shadowed"], 0);
    let camera = aimed_at(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), 1.2);
    let settings = spread(Model::BetterDipole);
    let milky = [gray(1.0, 10.0, 0.0, 1.3), gray(1.0, 5.0, 0.0, 1.5)];
    let counts = render(&world, &sampled, &milky, &camera, &settings).counts;
    assert_eq!((counts.escaped_inside, counts.nested), (0, 0));
    let clear = Clear::new(world);
    for etas in [[1.5, 1.5], [1.0, 1.5]] {
        let counts = assert_invisible("two shells", &clear, &etas, &camera, &settings);
        assert_eq!((counts.escaped_inside, counts.nested), (0, 0));
    }
}

/// The smallest mesh: one node of the ray tree, one interval of the discrete density.
#[test]
fn one_triangle() {
    let triangle = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
    let world = sunny(triangle);
    let cloud = cloud(&world, &by_area(100, 1));
    assert_eq!((cloud.len(), cloud.meta().surface_area_m2), (100, 0.5));
    for model in MODELS {
        let settings = spread(model);
        let camera = aimed_at(DVec3::new(0.25, 0.25, 0.0), DVec3::new(0.1, 0.2, 1.0), 0.1);
        let rendered = render(&world, &cloud, &[gray(1.0, 10.0, 0.0, 1.3)], &camera, &settings);
        assert!(rendered.counts.gathers > 0);
        assert!(channel(&rendered, &settings, "subsurface.R").iter().all(|x| *x > 0.0));
    }
}

/// K = 1: one lane of sixteen holds a sample, or none does; the image is `S Φ` or black.
#[test]
fn one_sample() {
    let world = sunny(slab(DVec3::new(1.0, 1.0, 0.5), 1));
    let medium = gray(1.0, 3.0, 0.0, 1.3);
    let point = Point { position: DVec3::new(0.1, 0.2, 0.5), normal: DVec3::Z };
    let exitant = Exitant { position: point.position, normal: point.normal, direction: DVec3::Z };
    let mut unlit = 0;
    for seed in 0..20 {
        let cloud = cloud(&world, &by_area(1, seed));
        unlit += 1 - cloud.len();
        for model in MODELS {
            let of = model.of(&medium);
            let term = |s: Sample| {
                let position = s.position.as_dvec3() + DVec3::from_array(cloud.meta().origin_m);
                let incident = Incident { position, normal: s.normal, direction: s.direction };
                evaluate(&*of, medium.eta, 0, &incident, &exitant).gather * f64::from(s.flux.x)
            };
            let expected: f64 = list(&cloud).into_iter().map(term).sum();
            let lit = Lit::new(&cloud, &medium, model).radiance(Estimator::Exhaustive, point, 0);
            assert_is(&format!("{} {seed}", model.name()), lit, DVec3::splat(expected), 2e-5);
        }
        let settings = spread(Model::StandardDipole);
        let camera = aimed_at(point.position, DVec3::new(0.1, 0.2, 1.0), 0.1);
        let rendered = render(&world, &cloud, std::slice::from_ref(&medium), &camera, &settings);
        assert_eq!(rendered.counts.gathers > 0, !cloud.is_empty());
        assert_eq!(rendered.counts.evaluations, rendered.counts.gathers);
    }
    assert!(unlit > 0 && unlit < 20, "{unlit} of 20 in the dark");
}

/// Ten million triangles: counts and indices stay in range, and area and light equal those of few triangles.
#[cfg(feature = "slow")]
#[test]
fn ten_million_triangles() {
    let world = sunny(quad(0.5, 0.0, 2237));
    assert_eq!(world.scene.mesh.triangles.len(), 2 * 2237 * 2237);
    for choice in [Choice::Area, Choice::Uniform] {
        let cloud = cloud(&world, &Sampling { choice, ..by_area(100_000, 1) });
        assert_eq!(cloud.len(), 100_000);
        assert_is("flux", DVec3::from_array(cloud.meta().mean_flux_w), DVec3::splat(0.8), 1e-3);
        let settings = spread(Model::DirectionalDipole);
        let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 0.4);
        let rendered = render(&world, &cloud, &[gray(1.0, 10.0, 0.0, 1.3)], &camera, &settings);
        assert_eq!((rendered.counts.gathers, rendered.counts.escaped_inside), (rendered.counts.paths, 0));
        assert!(channel(&rendered, &settings, "Z").iter().all(|z| *z > 0.0));
    }
}
