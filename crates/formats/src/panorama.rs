//! Pictures of light from all around: OpenEXR or Radiance HDR, told apart by their first bytes.

use crate::{Error, Image, ImageError};
use std::path::Path;

mod radiance;

/// Pixels of scene-linear red, green and blue as the file has them: a bad number is still in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row, top row first.
    pub pixels: Vec<[f32; 3]>,
}

impl Panorama {
    /// Reads a file; memory is taken as the file fills it.
    pub fn read(path: &Path) -> Result<Panorama, Error> {
        let file = std::fs::metadata(path).map_err(|source| Error::read(path, source))?;
        if !file.is_file() {
            return Err(Error::invalid(path, "not a regular file; give an OpenEXR or Radiance HDR image"));
        }
        let bytes = std::fs::read(path).map_err(|source| Error::read(path, source))?;
        Panorama::decode(&bytes).map_err(|what| Error::invalid(path, what))
    }

    fn decode(bytes: &[u8]) -> Result<Panorama, String> {
        if bytes.starts_with(b"#?") {
            return radiance::decode(bytes);
        }
        match Image::decode(bytes) {
            Ok(image) => from_channels(&image),
            Err(ImageError::NotOpenExr) => Err("neither an OpenEXR nor a Radiance HDR image; convert it to one".into()),
            Err(error) => Err(error.to_string()),
        }
    }
}

/// Most pixels of a picture.
const MAX_PIXELS: usize = 1 << 27;

/// `R`, `G` and `B`, or `Y` alone.
fn from_channels(image: &Image) -> Result<Panorama, String> {
    let grey = ["R", "G", "B", "RY", "BY"].iter().all(|name| image.channel(name).is_none());
    let plane = |name: &str| image.channel(if grey { "Y" } else { name });
    let (Some(r), Some(g), Some(b)) = (plane("R"), plane("G"), plane("B")) else {
        let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        return Err(format!("channels: R, G and B, or Y, are needed; it has {}", names.join(", ")));
    };
    let pixels = r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]).collect();
    Ok(Panorama { width: image.width, height: image.height, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;

    fn exr(names: &[&str]) -> Vec<u8> {
        let channel = |(k, name): (usize, &&str)| Channel {
            name: (*name).into(),
            samples: vec![k as f32, 0.5, 2.0, 1e-3, 7.0, 1e5],
        };
        let channels = names.iter().enumerate().map(channel).collect();
        Image { width: 3, height: 2, channels, ..Image::default() }.encode().expect("encodes")
    }

    #[test]
    fn the_same_picture_as_either_format_is_the_same() {
        let picture = Panorama::decode(&exr(&["R", "G", "B"])).expect("a picture");
        assert_eq!((picture.width, picture.height, picture.pixels.len()), (3, 2, 6));
        assert_eq!((picture.pixels[0], picture.pixels[1]), ([0.0, 1.0, 2.0], [0.5; 3]));
        let exact = [[0.0, 1.0, 2.0], [0.5, 0.5, 0.5], [256.0, 0.0, 2.0]];
        let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n".to_vec();
        hdr.extend([0, 64, 128, 130, 128, 128, 128, 128, 128, 0, 1, 137]);
        let channel = |k: usize| Channel { name: "RGB"[k..=k].into(), samples: exact.map(|p: [f32; 3]| p[k]).to_vec() };
        let image = Image { width: 3, height: 1, channels: (0..3).map(channel).collect(), ..Image::default() };
        let from_exr = Panorama::decode(&image.encode().expect("encodes")).expect("a picture");
        assert_eq!(from_exr, Panorama::decode(&hdr).expect("a picture"));
        assert_eq!(from_exr.pixels, exact);
    }

    #[test]
    fn grey_is_a_colour_and_other_layers_are_not() {
        let grey = Panorama::decode(&exr(&["Y"])).expect("a picture");
        assert_eq!(grey.pixels[5], [1e5; 3]);
        let message = Panorama::decode(&exr(&["sky.R", "sky.G"])).expect_err("no colour");
        assert!(message.contains("sky.G") && message.contains("R, G and B"), "{message}");
        assert!(Panorama::decode(&exr(&["R", "Y"])).is_err() && Panorama::decode(&exr(&["Y", "RY", "BY"])).is_err());
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = exr(&["R", "G", "B"]);
        for length in 0..whole.len() {
            assert!(Panorama::decode(&whole[..length]).is_err(), "{length}");
        }
        assert!(Panorama::decode(b"\x89PNG").expect_err("refused").contains("neither"));
        let folder = tempfile::tempdir().expect("a folder");
        assert!(Panorama::read(folder.path()).expect_err("refused").to_string().contains("not a regular file"));
    }
}
