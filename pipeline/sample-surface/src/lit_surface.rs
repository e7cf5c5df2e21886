//! The surface that is sampled, and the light on it.

use scene::{Mesh, NormalKind, Rays, light::LightTree};

/// A surface and its light.
pub struct LitSurface<'a> {
    pub mesh: &'a Mesh,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub normals: NormalKind,
}
