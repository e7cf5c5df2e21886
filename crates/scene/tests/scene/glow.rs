//! Emissive textures: they are seen, and light as much as they are seen.

use crate::import_textures::{encoded, with_picture};
use image::{ImageFormat, Rgba, RgbaImage};
use scene::{DVec3, Scene, SurfacePoint, light::Light};
use serde_json::{Value, json};
use test_support::glb::Asset;

const NEAREST: u32 = 9728;
const LINEAR: u32 = 9729;

/// The square over x and y from 0 to 1 that emits with this picture, seen from +Z.
fn glowing(picture: &RgbaImage, factor: [f64; 3], sampler: Value) -> Asset {
    let material = json!({ "name": "Screen", "emissiveFactor": factor, "emissiveTexture": { "index": 0 } });
    with_picture(&encoded(picture, ImageFormat::Png), material, sampler)
}

fn import(asset: &Asset) -> Scene {
    let scene = asset.import().expect("imports");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene
}

/// A point above the square that faces it.
fn above(scene: &Scene, position: DVec3) -> SurfacePoint {
    let normal = DVec3::NEG_Z;
    SurfacePoint::smooth(position - scene.origin, normal, normal, 0, 0)
}

/// Irradiance of a point by a sum over the square of what is seen of it, W/m².
fn by_sight(scene: &Scene, at: &SurfacePoint) -> DVec3 {
    // A multiple of the texels along both axes.
    const N: usize = 384;
    let mut sum = DVec3::ZERO;
    for k in 0..N * N {
        let [x, y] = [k % N, k / N].map(|i| (i as f64 + 0.5) / N as f64);
        let (triangle, weights) = if x > y { (0, [1.0 - x, x - y, y]) } else { (1, [1.0 - y, x, y - x]) };
        let offset = DVec3::new(x, y, 0.0) - scene.origin - at.position;
        let cosine = offset.normalize().dot(at.normal);
        sum += scene.emission(triangle, weights) * cosine * cosine / offset.length_squared();
    }
    sum / (N * N) as f64
}

/// The mean of what the light gives, and the share of samples that find it bright.
fn by_samples(light: &dyn Light, at: &SurfacePoint) -> (DVec3, f64) {
    const N: u64 = 1 << 16;
    let (mut sum, mut bright) = (DVec3::ZERO, 0);
    for k in 0..N {
        // A lattice: its error is far below that of as many independent points.
        let xi = [(k as f64 + 0.5) / N as f64, (k as f64 * 0.618_033_988_749_895).fract()];
        let Some(lit) = light.illuminate(at, xi) else { continue };
        sum += lit.irradiance;
        bright += u32::from(lit.irradiance != DVec3::ZERO);
        let expected = light.radiance(at.position, lit.direction) * at.normal.dot(lit.direction);
        let found = lit.irradiance * light.pdf_solid_angle(at, lit.direction);
        // On an edge between two parts either may be met.
        assert!(
            found.distance(expected) <= 1e-6 * expected.length() || found.distance(expected) < 0.2,
            "{found} {expected}"
        );
    }
    (sum / N as f64, f64::from(bright) / N as f64)
}

/// A dark picture with a few lights of different colors.
fn lights_in_the_dark() -> RgbaImage {
    let color = |x, y| match (x, y) {
        (10..13, 20..23) => [255, 120, 0, 255],
        (50, 7) => [0, 0, 255, 0],
        _ => [0, 0, 0, 255],
    };
    RgbaImage::from_fn(64, 48, |x, y| Rgba(color(x, y)))
}

/// What a textured light gives is what is seen of it.
///
/// Seen to catch: the brightness of a part left out of its density; texels by the mean of the whole picture, of which
/// one sample in 300 finds a light.
#[test]
fn textures_light_as_much_as_they_are_seen() {
    let half = RgbaImage::from_fn(2, 1, |x, _| Rgba([255 * x as u8, 188, 0, 255]));
    for (picture, factor, least) in [(lights_in_the_dark(), [2.0, 1.0, 4.0], 0.3), (half, [0.5, 0.0, 1.0], 0.4)] {
        for filter in [NEAREST, LINEAR] {
            let scene =
                import(&glowing(&picture, factor, json!({ "magFilter": filter, "wrapS": 33071, "wrapT": 33071 })));
            let [light] = &scene.file_lights[..] else { panic!("one light") };
            for position in [DVec3::new(0.3, 0.4, 0.5), DVec3::new(-0.4, 1.3, 1.5)] {
                let at = above(&scene, position);
                let (seen, (found, bright)) = (by_sight(&scene, &at), by_samples(&**light, &at));
                assert!(found.distance(seen) < 0.01 * seen.length(), "{filter} {position}: {found}, seen {seen}");
                assert!(bright > least, "{bright} of the samples are bright");
            }
        }
    }
}

/// A black texture does not emit, a few lights make no lamp, and their surface may be translucent by default.
///
/// Seen to catch: the factor alone.
#[test]
fn what_is_dark_is_no_lamp() {
    let of = |picture: &RgbaImage, factor: [f64; 3]| {
        let scene = import(&glowing(picture, factor, json!({})));
        (scene.materials[0].emits(), scene.file_lights.len(), scene.translucent().map(|(list, _)| list))
    };
    let black = RgbaImage::from_pixel(4, 4, Rgba([0, 0, 0, 255]));
    let red = RgbaImage::from_pixel(4, 4, Rgba([255, 0, 0, 255]));
    assert_eq!(of(&black, [1.0; 3]), (false, 0, Ok(vec![0])));
    assert_eq!(of(&red, [0.0, 1.0, 1.0]), (false, 0, Ok(vec![0])));
    assert_eq!(of(&red, [1.0; 3]), (true, 1, Ok(vec![])));
    assert_eq!(of(&lights_in_the_dark(), [1.0; 3]), (true, 1, Ok(vec![0])));
}

/// The set of coordinates and the transform are those of the emissive texture, whatever the base color has.
///
/// Seen to catch: the coordinates of the base color.
#[test]
fn emission_has_coordinates_of_its_own() {
    let half = RgbaImage::from_fn(2, 1, |x, _| Rgba([255 * x as u8, 0, 0, 255]));
    let mut asset = glowing(&half, [1.0; 3], json!({ "magFilter": NEAREST }));
    let turned = json!({ "offset": [0.5, 0] });
    asset.json["materials"][0]["emissiveTexture"]["extensions"] = json!({ "KHR_texture_transform": turned });
    asset.json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
    let scene = import(&asset);
    // x is 0.8, and 0.2.
    for (weights, emission, color) in [([0.1, 0.8, 0.1], 0.0, 1.0), ([0.85, 0.05, 0.1], 1.0, 0.0)] {
        assert_eq!((scene.emission(0, weights).x, scene.color(0, weights).x), (emission, color), "{weights:?}");
    }
}

/// Clouds of other emissive textures are other clouds.
///
/// Seen to catch: the picture left out of the identity.
#[test]
fn the_identity_of_a_light_depends_on_its_texture() {
    let digest = |picture: &RgbaImage, sampler: Value, offset: f64| {
        let mut asset = glowing(picture, [1.0; 3], sampler);
        let moved = json!({ "KHR_texture_transform": { "offset": [offset, 0] } });
        asset.json["materials"][0]["emissiveTexture"]["extensions"] = moved;
        import(&asset).light_digest()
    };
    let [one, two] = [200, 201].map(|red| RgbaImage::from_pixel(2, 2, Rgba([red, 9, 0, 255])));
    let all = [
        digest(&one, json!({}), 0.0),
        digest(&two, json!({}), 0.0),
        digest(&one, json!({ "magFilter": NEAREST }), 0.0),
        digest(&one, json!({ "wrapS": 33071 }), 0.0),
        digest(&one, json!({}), 0.25),
    ];
    for (k, one) in all.iter().enumerate() {
        assert!(!all[..k].contains(one), "{k}");
    }
}

/// A picture that glows on half of its texels or more is a lamp, and one with a few spots is none.
///
/// Seen to catch: every surface that emits taken for a lamp.
#[test]
fn a_few_spots_are_no_lamp() {
    let lit = |bright: u32| {
        let picture = RgbaImage::from_fn(8, 8, |x, y| Rgba(if 8 * y + x < bright { [255; 4] } else { [0, 0, 0, 255] }));
        let scene = import(&glowing(&picture, [1.0; 3], json!({ "magFilter": NEAREST })));
        assert!(!scene.file_lights.is_empty());
        scene.has_lamp()
    };
    assert!(!lit(3) && !lit(31) && lit(32) && lit(64));
}
