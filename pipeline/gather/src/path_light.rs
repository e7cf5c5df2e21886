//! The light of one camera path, by layers of the image.

use scene::DVec3;

/// The layer of a path's light is its first event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Layer {
    /// Light sources and the environment, seen directly or through the first interface.
    Emission = 0,
    /// Light that crosses the first interface and leaves again without being scattered.
    Transmission = 1,
    /// Light that is scattered below the first interface.
    Subsurface = 2,
    /// Light that the first interface mirrors.
    Specular = 3,
    /// Light that an opaque surface reflects.
    Diffuse = 4,
}

/// The names of the layers in the channels of an image.
pub const LAYERS: [&str; 5] = ["emission", "transmission", "subsurface", "specular", "diffuse"];

/// Light of one path, by layer, W/(m² sr).
pub type Layers = [DVec3; 5];

/// Light of one path, W/(m² sr).
#[derive(Clone, Copy, Debug, Default)]
pub struct PathLight {
    pub layers: Layers,
    /// The sum of the layers as each half of the cloud alone estimates it. A half that the path did not gather from has
    /// no scattered light.
    pub halves: [DVec3; 2],
    /// Transmittance of the first interface for scattered light; 0 without such an interface.
    pub through: f64,
}

/// The first surface that the ray through a pixel's center meets; zero where there is none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guide {
    pub normal: DVec3,
    /// World position, m.
    pub position: DVec3,
    /// Distance along the view direction, m.
    pub depth: f64,
}
