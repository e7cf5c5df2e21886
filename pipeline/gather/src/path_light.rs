//! The light of one camera path, by the layers of the image.

use scene::DVec3;

/// What a path's light is filed under: its first event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Layer {
    /// Light sources and the environment, seen directly or through the first interface.
    Emission = 0,
    /// Through the first interface and out again without being scattered.
    Transmission = 1,
    /// Scattered below the first surface.
    Subsurface = 2,
    /// Mirrored by the first interface.
    Specular = 3,
    /// Reflected by an opaque surface.
    Diffuse = 4,
}

/// Their names in the channels of an image.
pub const LAYERS: [&str; 5] = ["emission", "transmission", "subsurface", "specular", "diffuse"];

/// Light of one path, by layer, W/(m² sr).
pub type Layers = [DVec3; 5];

/// Light of one path, W/(m² sr).
#[derive(Clone, Copy, Debug, Default)]
pub struct PathLight {
    pub layers: Layers,
    /// All of it as each half of the cloud alone has it; of a half that the path did not gather from, what is left.
    pub halves: [DVec3; 2],
    /// Which share of the light below the first interface gets through to the camera; 0 without such an interface.
    pub through: f64,
}

/// What the ray through the pixel's centre meets first; zero where it meets nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guide {
    pub normal: DVec3,
    /// World position, m.
    pub position: DVec3,
    /// Distance along the view direction, m.
    pub depth: f64,
}
