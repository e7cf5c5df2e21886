//! OpenEXR images, and panoramas as OpenEXR or Radiance HDR files.

use crate::{comparison::check_comparison, file::with_file};
use formats::{Image, ImageError, Panorama};
use scene::{DVec3, Vec3, light::EnvironmentMap};

/// Larger images are only read: the checks would take long and find no more.
const MAX_PIXELS: usize = 1 << 14;

/// An accepted image is compared, written and read again as the same; an accepted panorama has all its pixels, and as
/// an environment a radiance in every direction.
pub fn image(bytes: &[u8]) -> bool {
    with_file("image.exr", bytes, |path| {
        let (image, panorama) = (Image::read(path), Panorama::read(path));
        panorama.iter().for_each(check_panorama);
        image.iter().for_each(check_image);
        image.is_ok() || panorama.is_ok()
    })
}

fn check_image(image: &Image) {
    let pixels = image.width * image.height;
    assert!(pixels > 0 && image.channels.iter().all(|c| c.samples.len() == pixels));
    assert!(image.channels.is_sorted_by(|a, b| a.name.as_bytes() < b.name.as_bytes()));
    if pixels * image.channels.len() > MAX_PIXELS {
        return;
    }
    check_comparison(image);
    match image.encode() {
        Ok(bytes) => {
            let again = Image::decode(&bytes).expect("what was written is read");
            assert_eq!(bytes, again.encode().expect("is written again"), "another image");
            assert_eq!(bits(image), bits(&again), "other samples");
        }
        // Other programs may give channels and attributes any name.
        Err(error) => assert!(matches!(error, ImageError::Unwritable(_)), "{error}"),
    }
}

/// The bits of the samples, since NaN equals nothing.
fn bits(image: &Image) -> Vec<(&str, Vec<u32>)> {
    image.channels.iter().map(|c| (c.name.as_str(), c.samples.iter().map(|x| x.to_bits()).collect())).collect()
}

fn check_panorama(panorama: &Panorama) {
    let size = (panorama.width, panorama.height);
    assert_eq!(size.0 * size.1, panorama.pixels.len());
    if panorama.pixels.len() > MAX_PIXELS {
        return;
    }
    let pixels = panorama.pixels.iter().copied().map(Vec3::from_array).collect();
    let Ok(map) = EnvironmentMap::new(size, pixels, 1.0, 30.0) else { return };
    for direction in [DVec3::X, DVec3::NEG_Y, DVec3::new(-1.0, 2.0, 3.0).normalize()] {
        let radiance = map.radiance(direction);
        assert!(radiance.is_finite() && radiance.min_element() >= 0.0, "{radiance}");
    }
}
