//! Synthetic renders: all pixels of an image share the error of its cloud, and each pixel has an error of its own.

use formats::image::{Attribute, Channel, Image};
use test_support::Random;

/// The side of an image in pixels.
pub const SIZE: usize = 9;
/// The relative standard deviation of the cloud's error, which all pixels of a replicate share.
pub const SHARED: f64 = 0.01;
/// The relative standard deviation of a pixel's own error.
pub const OWN: f64 = 0.02;
/// The hash of the scene.
const SCENE: &str = "5ce4e";

/// A fault of the test images.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    /// The factor on the light in red.
    pub red: f64,
    /// The factor on the standard deviation between replicates.
    pub scatter: f64,
    /// The factor on the variance that images claim.
    pub claimed: f64,
}

/// No fault.
pub const SOUND: Fault = Fault { red: 1.0, scatter: 1.0, claimed: 1.0 };

/// A replicate from the cloud of this seed: a lit object in front of black, and a layer that is black.
pub fn replicate(seed: u64, fault: Fault) -> Image {
    let mut random = Random(seed.wrapping_mul(0xd134_2543_de82_ef95));
    let shared = 1.0 + fault.scatter * SHARED * random.normal();
    let mut channels = Vec::new();
    for (name, light) in [("R", 0.5), ("G", 0.4), ("B", 0.2)] {
        let light = if name == "R" { light * fault.red } else { light };
        let mut plane = vec![0.0f32; SIZE * SIZE];
        for y in 2..SIZE {
            for x in 0..SIZE - 2 {
                plane[y * SIZE + x] = (light * (shared + fault.scatter * OWN * random.normal())) as f32;
            }
        }
        let variance = 1e-4 * fault.claimed * (1.0 + 0.1 * random.normal());
        channels.push(Channel { name: format!("variance.{name}"), samples: vec![variance as f32; SIZE * SIZE] });
        channels.push(Channel { name: format!("transmission.{name}"), samples: vec![0.0; SIZE * SIZE] });
        channels.push(Channel { name: name.to_owned(), samples: plane.clone() });
        channels.push(Channel { name: format!("subsurface.{name}"), samples: plane });
    }
    channels.push(Channel { name: "Z".to_owned(), samples: vec![1.0; SIZE * SIZE] });
    let text = |name: &str, value: String| (format!("pcsss/{name}"), Attribute::Text(value));
    let attributes = [text("cloud", format!("{seed:016x}")), text("scene", SCENE.to_owned())].into();
    Image { width: SIZE, height: SIZE, channels, attributes, ..Image::default() }
}
