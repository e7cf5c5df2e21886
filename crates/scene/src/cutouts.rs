//! Holes in opaque surfaces: where their alpha is below a threshold, by chance where it is the share that they cover, and
//! by chance in panes of glass, which are met where they mirror, and in thin walls, which let some light through straight.

use crate::{
    material::{Alpha, Material},
    mesh::unit,
    panes::{self, Sheet},
    random::mix,
    scene::Scene,
};
use glam::DVec3;

/// The surfaces of a scene that have holes.
#[derive(Clone)]
pub(crate) struct Cutouts<'a> {
    scene: &'a Scene,
    /// What decides on the surfaces of each material.
    rules: Vec<Rule>,
}

/// What decides whether a ray passes.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    Alpha(Alpha),
    /// Glass of this relative index.
    Pane(f64),
    /// Where the surface is by its alpha, this share of rays crosses it straight; none where a texture varies it.
    Wall(Alpha, Option<f64>),
}

const SOLID: Rule = Rule::Alpha(Alpha::Ignored);

impl<'a> Cutouts<'a> {
    /// None if no opaque surface has holes. Emitting surfaces have none: light is sampled on all of them.
    pub fn new(scene: &'a Scene, translucent: impl Fn(u16) -> bool) -> Option<Self> {
        let rule = |k: usize| {
            let material = &scene.materials[k];
            if translucent(k as u16) || material.emits() {
                return SOLID;
            }
            match (scene.sheets[k], &material.wall) {
                (Some(Sheet::Pane(ior)), _) => return Rule::Pane(ior),
                (Some(Sheet::Wall), Some(wall)) if wall.clear_varies() => return Rule::Wall(material.alpha, None),
                (Some(Sheet::Wall), Some(wall)) if wall.plain().clear > 0.0 => {
                    return Rule::Wall(material.alpha, Some(wall.plain().clear));
                }
                _ => {}
            }
            let covers_all = material.alpha == Alpha::Coverage && scene.mesh.colors.is_empty() && is_solid(material);
            if covers_all { SOLID } else { Rule::Alpha(material.alpha) }
        };
        let rules: Vec<Rule> = (0..scene.materials.len()).map(rule).collect();
        rules.iter().any(|rule| *rule != SOLID).then_some(Cutouts { scene, rules })
    }

    /// Whether a ray passes through a triangle at the point with these barycentric weights. By coverage, chance decides:
    /// the same for the same ray and triangle, in all queries.
    pub fn is_hole(
        &self,
        triangle: u32,
        (origin, direction): (DVec3, DVec3),
        weights: impl FnOnce() -> [f64; 3],
    ) -> bool {
        let material = self.scene.mesh.triangles[triangle as usize].material;
        let alpha = |weights| self.scene.color(triangle, weights).w;
        match self.rules[material as usize] {
            Rule::Alpha(Alpha::Ignored) => false,
            // Both are float32 in the file: an alpha that equals the cutoff in decimals must not be a hole.
            Rule::Alpha(Alpha::Cutoff(cutoff)) => (alpha(weights()) as f32) < cutoff,
            Rule::Alpha(Alpha::Coverage) => chance(triangle, origin, direction) >= alpha(weights()),
            Rule::Wall(rule, clear) => {
                let weights = weights();
                let local = || {
                    let wall = self.scene.materials[material as usize].wall.as_ref();
                    wall.map_or(0.0, |wall| self.scene.wall_shares(wall, triangle, weights).clear)
                };
                let clear = clear.unwrap_or_else(local);
                let covered = match rule {
                    Alpha::Ignored => 1.0,
                    Alpha::Cutoff(cutoff) => f64::from(u8::from((alpha(weights) as f32) >= cutoff)),
                    Alpha::Coverage => alpha(weights),
                };
                chance(triangle, origin, direction) >= covered * (1.0 - clear)
            }
            Rule::Pane(ior) => {
                let [a, b, c] = self.scene.mesh.corners(triangle as usize);
                let cosine = unit((b - a).cross(c - a)).dot(direction);
                chance(triangle, origin, direction) >= panes::reflectance(cosine, ior)
            }
        }
    }
}

/// Whether neither factor nor texture has an alpha below 1.
fn is_solid(material: &Material) -> bool {
    let texels = material.base_texture.as_ref().map_or(&[][..], |texture| &texture.picture.texels);
    material.base_color.w >= 1.0 && texels.iter().all(|texel| texel[3] == u8::MAX)
}

/// A number in [0, 1) that looks random, of a ray and a triangle.
fn chance(triangle: u32, origin: DVec3, direction: DVec3) -> f64 {
    let numbers = origin.to_array().into_iter().chain(direction.to_array());
    let hash = numbers.fold(mix(u64::from(triangle)), |hash, x| mix(hash ^ x.to_bits()).wrapping_add(hash << 1));
    (mix(hash) >> 11) as f64 / (1u64 << 53) as f64
}
