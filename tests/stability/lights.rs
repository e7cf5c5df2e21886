//! Lights that touch the surface, graze it, or lie on the wrong side.

use crate::scenes::{aimed_at, render};
use formats::cloud::Cloud;
use gather::{Filter, Settings};
use glam::DVec3;
use scene::{
    SurfacePoint,
    light::{Light as _, LightChoice, LightTree, Lit as Lighting, PointLight, ReceiverBounds, Spot, light_at},
};
use test_support::{
    meshes::{Light, Part, World, quad, rectangle, slab, world},
    pipeline::{ESTIMATORS, MODELS, by_area, cloud, gray, settings},
};

/// The center of the square in z = 0.
fn middle() -> SurfacePoint {
    SurfacePoint::smooth(DVec3::ZERO, DVec3::Z, DVec3::Z, 0, 0)
}

/// A square of one metre under a point light of 1 W/sr.
fn under(height: f64) -> World {
    let light = Light::Point { position: DVec3::new(0.0, 0.0, height), intensity: DVec3::ONE };
    world(&[Part::translucent(quad(0.5, 0.0, 1))], &[light], DVec3::ZERO)
}

/// An image of the center by all models and estimators.
fn render_all(world: &World, cloud: &Cloud) {
    for (estimator, model) in ESTIMATORS.into_iter().flat_map(|estimator| MODELS.map(|model| (estimator, model))) {
        let settings = Settings { paths_per_pixel: 4, filter: Filter::Box, estimator, ..settings(model, 8, 8) };
        let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 0.4);
        render(world, cloud, &[gray(10.0, 1000.0, 0.5, 1.3)], &camera, &settings);
    }
}

/// `E = I/d²` reaches 10¹² directly below the light; the rest of the square is lit at a cosine of 10⁻⁶ and does not
/// shadow itself.
#[test]
fn light_a_millionth_above_the_surface() {
    for height in [1e-6, 1e-7] {
        let world = under(height);
        let tree = LightTree::new(world.scene.lights());
        let choice = LightChoice::new(&tree, &ReceiverBounds::point(&middle()), 1);
        let Lighting::Light { direction, irradiance } = light_at(&choice, &world.rays, &middle(), [0.5; 3], &mut 0)
        else {
            panic!("the light is hidden {height} m above the surface");
        };
        assert_eq!(direction, DVec3::Z);
        assert!((irradiance.x * height * height - 1.0).abs() < 1e-12);
        let cloud = cloud(&world, &by_area(10_000, 1));
        assert_eq!(cloud.len(), 10_000, "{:?}", cloud.meta().samples_dropped);
        render_all(&world, &cloud);
    }
}

/// A light in the plane of the surface, where `n·ω = 0` and at one point the distance is 0 as well: it gives no
/// light, and no division by zero.
#[test]
fn light_in_the_surface() {
    let world = under(0.0);
    assert!(world.scene.file_lights[0].illuminate(&middle(), [0.5; 2]).is_none());
    assert_eq!(world.scene.file_lights[0].importance(&middle()), 0.0);
    let cloud = cloud(&world, &by_area(1000, 1));
    assert_eq!(cloud.meta().samples_dropped["facing_away"], 1000);
    render_all(&world, &cloud);
}

#[test]
fn light_behind_the_surface_and_inside_the_object() {
    let inside = Light::Point { position: DVec3::new(0.1, 0.2, 0.0), intensity: DVec3::ONE };
    let closed = world(&[Part::translucent(slab(DVec3::ONE, 2))], &[inside], DVec3::ZERO);
    for world in [under(-1e-6), closed] {
        let cloud = cloud(&world, &by_area(1000, 1));
        assert_eq!(cloud.meta().samples_dropped["facing_away"], 1000);
        render_all(&world, &cloud);
    }
}

/// cos θ = 10⁻⁷: all samples are lit, with the flux of that cosine. The stored direction resolves cosines down to
/// 5·10⁻⁵, below which T12 transmits next to nothing.
#[test]
fn grazing_sun() {
    let sun = Light::Directional { towards: DVec3::new(1.0, 0.0, 1e-7).normalize(), irradiance: DVec3::ONE };
    let world = world(&[Part::translucent(quad(0.5, 0.0, 4))], &[sun], DVec3::ZERO);
    let cloud = cloud(&world, &by_area(1000, 1));
    assert_eq!(cloud.len(), 1000, "{:?}", cloud.meta().samples_dropped);
    assert!((cloud.meta().mean_flux_w[0] / 1e-7 - 1.0).abs() < 1e-6);
    render_all(&world, &cloud);
}

/// An emissive plate on the object, or 10⁻⁶ above it; in its plane beside it, turned away, or below.
#[test]
fn area_light_on_the_surface() {
    let body = Part::translucent(quad(0.5, 0.0, 2));
    // The plate is black: rounding lights its back by 10⁻³⁸ of what it emits.
    let glowing = |mesh| Part { emission: DVec3::ONE, color: DVec3::ZERO, ..Part::opaque(mesh) };
    for height in [0.0, 1e-6, 1e-3] {
        let mut plate = quad(0.3, height, 2);
        plate.triangles.iter_mut().for_each(|t| t.swap(1, 2)); // it shines down
        let world = world(&[body.clone(), glowing(plate)], &[], DVec3::ZERO);
        let cloud = cloud(&world, &by_area(2000, 1));
        assert_eq!(cloud.is_empty(), height == 0.0, "{height}");
        render_all(&world, &cloud);
    }
    for (where_from, dark) in [
        ("within its own plane", rectangle([0.5, 1.0], 0.5, 0.0, 2)),
        ("the back of a plate", quad(0.3, 1e-3, 2)),
        ("below", quad(0.3, -1e-3, 2)),
    ] {
        let world = world(&[body.clone(), glowing(dark)], &[], DVec3::ZERO);
        let cloud = cloud(&world, &by_area(2000, 1));
        assert!(cloud.is_empty(), "lit from {where_from}");
        render_all(&world, &cloud);
    }
}

/// A cone without a soft edge, whose two angles are equal: all light on one side of it, none on the other.
#[test]
fn spot_without_a_soft_edge() {
    let spot = Spot::new(DVec3::NEG_Z, 0.8f64.acos(), 0.8f64.acos());
    let light = |x: f64| PointLight {
        position: DVec3::new(x, 0.0, 1.0),
        intensity: DVec3::ONE,
        spot: Some(spot),
        range: Some(1e9),
    };
    let lit = light(0.0).illuminate(&middle(), [0.5; 2]).expect("on the axis");
    assert!((lit.irradiance - DVec3::ONE).length() < 1e-12);
    let within = light(0.7499).illuminate(&middle(), [0.5; 2]).expect("within the edge");
    assert!((within.irradiance.x * (1.0f64 + 0.7499 * 0.7499).powf(1.5) - 1.0).abs() < 1e-12);
    assert!(light(0.7501).illuminate(&middle(), [0.5; 2]).is_none(), "beyond the edge");
    assert!(light(1.0).illuminate(&middle(), [0.5; 2]).is_none());
}
