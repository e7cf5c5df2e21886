//! Two media below one surface, by a mask (docs/method.md section 20).

use crate::stripes::{Stripes, along, medium};
use bssrdf::{Medium, Model};
use gather::{Input, Settings};
use glam::DVec3;
use scene::{
    SurfaceColors,
    texture::{Picture, Texture, Wrap},
};
use std::{slice::from_ref, sync::Arc};
use test_support::{
    meshes::{Light, Part, sphere, world},
    pipeline::{cloud, orthographic, settings, stratified},
};
use tint::{Tint, Tinted};

/// Stripes of two media: beyond one mean free path from their edges the light is within 10 % of random walks, if what
/// crosses from one to the other is scattered by the medium between them.
///
/// Seen to catch: no light from one medium to the other (19 %); the mean of both BSSRDFs for it (13 %).
#[test]
fn striped_media_exchange_light_by_the_one_between() {
    const BINS: usize = 32;
    const PERIOD: f64 = 16.0;
    let pairs: [[[f64; 2]; 2]; 6] = [
        [[1.0, 0.9], [1.0, 0.6]],
        [[1.0, 0.9], [2.0, 0.9]],
        [[1.0, 0.97], [1.5, 0.7]],
        [[1.0, 0.99], [1.0, 0.9]],
        [[1.0, 0.99], [3.0, 0.99]],
        [[1.0, 0.7], [3.0, 0.97]],
    ];
    for media in pairs {
        let stripes = Stripes { media, period: PERIOD, bins: BINS };
        let [first, second] = media.map(medium);
        let own = [along(&first), along(&second)];
        let between = along(&first.mixed(&second, 0.5));
        let model = stripes.model(|a, b, x| if a == b { own[a](x) } else { between(x) });
        let worst = stripes.worst(&model);
        println!("{media:?}: within {:.1} %", 100.0 * worst);
        assert!(worst < 0.1, "{media:?}: {worst}");
    }
}

/// An image of a sphere in the sun whose texture is white with this alpha, of two media or of the first alone.
fn image(alpha: u8, media: &[Medium; 2], blends: bool) -> Vec<DVec3> {
    let towards = DVec3::new(0.3, 0.2, 1.0).normalize();
    let sun = Light::Directional { towards, irradiance: DVec3::splat(3.0) };
    let mut world = world(&[Part::translucent(sphere(0.01, 3))], &[sun], DVec3::ZERO);
    let picture = Arc::new(Picture { width: 1, texels: vec![[255, 255, 255, alpha]] });
    world.scene.materials[0].base_texture = Some(Texture { picture, wrap: [Wrap::Clamp; 2], nearest: true });
    world.scene.mesh.coordinates = vec![[0.5; 2]; world.scene.mesh.positions.len()];
    let cloud = cloud(&world, &stratified(5000, 3));
    let (scene, rays, clouds) = (&world.scene, &world.rays, from_ref(&cloud));
    let share = SurfaceColors::new(scene, 0).mean_of(|color| 1.0 - color.base.w);
    let medium = if blends { media[0].mixed(&media[1], share) } else { media[0].clone() };
    let tinted = blends.then(|| {
        let (tint, _) = Tint::new(scene, 0, &medium, Model::HalfSpace).expect("it has a texture");
        Tinted::blended(scene, rays, clouds, (0, tint), media)
    });
    let settings = Settings { max_depth: 1, ..settings(Model::HalfSpace, 12, 32) };
    let camera = orthographic(DVec3::new(0.2, -0.3, 1.0), 0.011);
    let (media, tints) = (from_ref(&medium), [tinted]);
    let input = Input { scene, rays, clouds, media, tints: &tints, calibration: None, camera: &camera };
    gather::render(&input, &settings, |_| ()).pixels.iter().map(|pixel| pixel.beauty()).collect()
}

/// Alpha of 1 and 0 everywhere show each medium alone. A constant alpha p shows p² of the first, (1 − p)² of the second and
/// 2 p (1 − p) of the medium between; the tolerance is for the noise of the points and the cut at 32 paths of 100 pixels.
///
/// Seen to catch: samples of the first medium for light that crosses from the second.
#[test]
fn constant_masks_show_the_media_and_what_is_between() {
    let of = |name: &str, sigma_s: f64| {
        let text = format!(
            r#"{{"name":"{name}","unit":"1/m","sigma_a":[50,100,200],"sigma_s":[{sigma_s},{sigma_s},{sigma_s}],"eta":1.3}}"#
        );
        Medium::from_json(&text).expect("a medium")
    };
    let media = [of("dense", 4000.0), of("thin", 1000.0)];
    let [first, second] = media.clone();
    let between = first.mixed(&second, 0.5);
    let pure = [&first, &second, &between].map(|m| image(255, &[m.clone(), m.clone()], false));
    for (alpha, pure) in [(255, &pure[0]), (0, &pure[1])] {
        for (own, pure) in image(alpha, &media, true).iter().zip(pure) {
            assert!((*own - *pure).abs().max_element() <= 1e-5 * pure.max_element(), "{alpha}: {own} {pure}");
        }
    }
    let p = 128.0 / 255.0;
    let total = |image: &[DVec3]| image.iter().sum::<DVec3>();
    let [a, b, c] = pure.each_ref().map(|image| total(image));
    let expected = a * (p * p) + b * ((1.0 - p) * (1.0 - p)) + c * (2.0 * p * (1.0 - p));
    let found = total(&image(128, &media, true));
    assert!(((found - expected) / expected).abs().max_element() < 0.02, "{found} {expected}");
}
