//! Objects and lights that neither the figure nor the camera sees change nothing.

use crate::{
    figure::{FLOOR, Figure},
    picture::{DIFFUSE, SIZE, SUBSURFACE, Shot, assert_close, assert_paired, channel, sum},
};
use glam::{DVec3, Vec3};
use sample_surface::Choice;
use test_support::{
    meshes::{Mesh, slab},
    pipeline::MODELS,
};

/// A box of 4 cm about a point.
fn box_at(center: Vec3) -> Mesh {
    let mut mesh = slab(DVec3::splat(0.02), 2);
    mesh.positions.iter_mut().for_each(|p| *p += center);
    mesh
}

/// An opaque, unlit box on the floor behind the camera. In its first position it leaves the bounds of the scene as
/// they are, and the subsurface layer keeps its bits. In the second it moves the center up by 0.13 m: coordinates of
/// the figure are then rounded to float32 at that height, by up to 8·10⁻⁹ m or 10⁻⁵ of a mean free path, areas of
/// triangles 0.4 mm across change by 4·10⁻⁵, and so does the flux of their samples. The uniform choice keeps the
/// triangles; a sample or two may become shadowed.
///
/// Seen to catch: triangles chosen from all materials, with those of opaque ones dropped afterwards.
#[test]
fn a_box_out_of_view() {
    let without = Figure::read().world();
    let inside = Figure::read().with_mesh(&box_at(Vec3::new(0.4, 0.03, 1.5)), FLOOR).world();
    let above = Figure::read().with_mesh(&box_at(Vec3::new(0.4, 0.3, 1.5)), FLOOR).world();
    assert_eq!(inside.scene.origin, without.scene.origin);
    assert!((above.scene.origin - without.scene.origin).length() > 0.1);
    for model in MODELS {
        let shot = Shot { model, ..Shot::new(11).choosing(Choice::Uniform) };
        let image = shot.of(&without);
        let seen = shot.of(&inside);
        for name in SUBSURFACE {
            assert_eq!(channel(&image, name), channel(&seen, name), "{}", model.name());
        }
        assert_close(&format!("box above, {}", model.name()), [&image, &shot.of(&above)], 1e-4, 3);
    }
}

/// A strong lamp below the floor: samples that face down pick it most of the time and find it hidden. The mean stays,
/// and so does the layer of the floor.
///
/// Seen to catch: irradiance not divided by the probability of the light's choice; lights picked alike, but divided by
/// their share of importance; division by the number of stored samples.
#[test]
fn a_light_behind_a_wall() {
    let without = Figure::read().world();
    let lamp = Figure::read().with_lamp(DVec3::new(0.0, -0.1, 0.05), 0.02).world();
    assert_eq!(lamp.scene.lights().count(), without.scene.lights().count() + 1);
    assert_paired("hidden lamp", 500, 1e-2, |seed| {
        [&without, &lamp].map(|world| sum(&Shot::smooth(seed).of(world), SUBSURFACE))
    });
    let [a, b] = [&without, &lamp].map(|world| Shot::new(12).of(world));
    for name in DIFFUSE {
        assert_eq!(channel(&a, name), channel(&b, name));
        assert!(channel(&a, name).iter().filter(|x| **x > 0.0).count() > SIZE, "{name} is dark");
    }
}
