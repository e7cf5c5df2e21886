//! What random walks in place of a BSSRDF need (docs/method.md section 14).

use crate::image::Input;
use bssrdf::Medium;
use walks::{Beams, Matter, Solid};

/// What the walks in one medium need.
pub struct Walks<'a> {
    pub solid: Solid<'a>,
    /// The channels; none for one that does not scatter.
    pub matter: [Option<Matter>; 3],
    pub eta: f64,
    /// The light of delta distributions; none below a rough boundary, which walks meet it through.
    pub beams: Vec<Beams<'a>>,
}

impl<'a> Walks<'a> {
    /// The walks below the surface of a material; none if it has no triangle, or its medium does not scatter.
    pub fn new(
        input: &Input<'a>,
        material: u16,
        medium: &Medium,
        is_rough: bool,
        translucent: impl Fn(u16) -> bool,
    ) -> Option<Self> {
        let connected = |matter: Matter| if is_rough { matter } else { matter.with_connections() };
        let matter = [0, 1, 2].map(|c| Matter::new(&medium.channels[c], medium.eta).map(connected));
        let extinction = matter.iter().flatten().map(|m| m.extinction).fold(f64::INFINITY, f64::min);
        if extinction == f64::INFINITY {
            return None;
        }
        let solid = Solid::new(&input.scene.mesh, input.rays, material, translucent)?;
        let lights = input.scene.lights().filter(|_| !is_rough);
        let beams = lights.filter_map(|light| Beams::new(&solid, light, medium.eta, extinction)).collect();
        Some(Walks { solid, matter, eta: medium.eta, beams })
    }
}

impl Walks<'_> {
    /// The directional lights whose reflections inside are left out.
    pub fn incomplete(&self) -> u64 {
        self.beams.iter().filter(|beams| beams.is_parallel() && !beams.complete).count() as u64
    }
}

/// Whether a ray can meet light that is no delta distribution.
pub fn meets_light(input: &Input, is_opaque: impl Fn(u16) -> bool) -> bool {
    input.scene.lights().any(|light| light.delta().is_none())
        || input.scene.mesh.triangles.iter().any(|t| is_opaque(t.material))
}
