//! The mirror image of a scene: scaled by −1 along X, with lights and cameras, it gives the mirrored image.
//!
//! The samples of the mirrored scene are no mirror images: to face outward again a mirrored triangle is wound the
//! other way, which exchanges two corners, and the same random numbers put the point elsewhere on it. So gathering is
//! compared pixel by pixel on the mirror image of a cloud, and sampling by its mean.

use crate::{
    figure::{Figure, PANEL},
    picture::{SIZE, SUBSURFACE, Shot, assert_close_at, assert_paired, sum},
};
use bssrdf::Medium;
use formats::cloud::{Cloud, Sample};
use glam::{DVec3, Vec3};
use sample_surface::Choice;
use serde_json::json;
use test_support::{
    meshes::World,
    pipeline::{MODELS, filed, sampled_with},
    planted::{planted, stored},
};

const MIRROR: DVec3 = DVec3::new(-1.0, 1.0, 1.0);

fn mirrored() -> World {
    Figure::read().with_panel(PANEL).under(json!({ "scale": MIRROR.to_array() })).world()
}

/// A medium with the index 1: no path is reflected, whatever the random numbers, which belong to the pixel.
fn matched(medium: &Medium) -> Medium {
    test_support::pipeline::medium(medium.channels, 1.0)
}

/// The mirror image of a cloud.
fn mirror(cloud: &Cloud) -> Cloud {
    let image = |s: Sample| {
        let position = s.position * Vec3::new(-1.0, 1.0, 1.0);
        Sample { position, normal: s.normal * MIRROR, direction: s.direction * MIRROR, ..s }
    };
    let materials: Vec<_> =
        stored(cloud).into_iter().map(|halves| halves.map(|half| half.into_iter().map(image).collect())).collect();
    filed(&planted(cloud.meta(), &materials))
}

/// Signs change, digits do not: camera rays, hits and offsets are mirror images of each other up to the order of sums
/// of three, and so are the codes of normals and directions.
///
/// Seen to catch: the winding of mirrored meshes left as it is; interpolated normals not mirrored; a camera's
/// right taken from its node instead of from forward and up.
#[test]
fn the_mirror_image_of_a_cloud_gives_the_mirror_image() {
    let (original, reflection) = (Figure::read().with_panel(PANEL).world(), mirrored());
    for model in MODELS {
        let shot = Shot { model, ..Shot::new(7) };
        let shot = Shot { medium: matched(&shot.medium), ..shot };
        let cloud = filed(&sampled_with(&original, &shot.sampling, shot.normals));
        let images = [shot.of_cloud(&original, &cloud), shot.of_cloud(&reflection, &mirror(&cloud))];
        let pixel = |k: usize| k / SIZE * SIZE + (SIZE - 1 - k % SIZE);
        assert_close_at(model.name(), [&images[0], &images[1]], 1e-6, 0, pixel);
    }
}

/// The means are compared cloud by cloud: the same numbers choose the same triangles, so that most of the noise
/// cancels.
///
/// Seen to catch: the winding of mirrored meshes left as it is; interpolated normals, or the axes of spot lights, not
/// mirrored.
#[test]
fn phase_one_has_the_same_mean_in_the_mirror() {
    let (original, reflection) = (Figure::read().with_panel(PANEL).world(), mirrored());
    for (first, choice) in [(100, Choice::Area), (200, Choice::Uniform)] {
        let pair = |seed: u64| {
            let shot = Shot::smooth(seed).choosing(choice);
            let shot = Shot { medium: matched(&shot.medium), ..shot };
            [&original, &reflection].map(|world| sum(&shot.of(world), SUBSURFACE))
        };
        assert_paired(&format!("mirrored, {}", choice.name()), first, 5e-3, pair);
    }
}
