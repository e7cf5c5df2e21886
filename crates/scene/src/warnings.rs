//! Warnings about properties of a file that the image does not show.

use crate::{
    material::Alpha,
    scene::Scene,
    unhonoured::{Holder, first_of, quoted},
};
use std::collections::HashMap;

/// The number of properties that the warning names, and of holders for each.
const MAX_PROPERTIES: usize = 12;
const MAX_HOLDERS: usize = 3;

impl Scene {
    /// Adds one warning that names every property that the image does not show, though something visible or a light has
    /// it. What counts for a material depends on whether it is `translucent`.
    pub fn warn_of_unhonoured(&mut self, translucent: impl Fn(u16) -> bool) {
        let mut found: Vec<(String, Vec<&Holder>)> = Vec::new();
        let mut known = HashMap::new();
        for one in &self.unhonoured {
            let is_translucent =
                matches!(&one.holder, Some(Holder::Material(k)) if translucent(*k) || self.is_pane(*k));
            let Some(taken) = one.on[usize::from(is_translucent)] else { continue };
            if matches!(&one.holder, Some(Holder::Material(k)) if self.is_shown_by_wall(*k, &one.property)) {
                continue;
            }
            let property = format!("{}{}", one.property, taken_as(taken));
            let index = *known.entry(property).or_insert_with_key(|property| {
                found.push((property.clone(), Vec::new()));
                found.len() - 1
            });
            found[index].1.extend(&one.holder);
        }
        if !found.is_empty() {
            let named = first_of(found.iter().map(|(p, holders)| self.named(p, holders)), MAX_PROPERTIES);
            self.warnings.push(format!("not honoured: {named}; docs/scenes.md says what is"));
        }
    }

    /// Adds a warning for each translucent material whose alpha or vertex colors are not used, or whose texture cannot be
    /// read. Vertex colors are used with a texture.
    pub fn warn_of_colors(&mut self, translucent: impl Fn(u16) -> bool) {
        let mut colored = vec![false; self.materials.len()];
        for t in &self.mesh.triangles {
            colored[t.material as usize] |= t.vertices.iter().any(|i| self.mesh.vertex_color(*i) != [1.0; 4]);
        }
        for (k, material) in self.materials.iter().enumerate() {
            // Alpha that blends media is used, whatever the mode.
            let alpha = Some(material.alpha).filter(|_| material.blend.is_none());
            let unused = [
                (matches!(alpha, Some(Alpha::Cutoff(_))), "alphaMode MASK"),
                (alpha == Some(Alpha::Coverage), "alphaMode BLEND"),
                (colored[k] && !material.is_tinted(), "vertex colors"),
            ];
            let unused: Vec<&str> = unused.iter().filter(|u| u.0).map(|u| u.1).collect();
            if translucent(k as u16) && !unused.is_empty() {
                let (name, what) = (&material.name, unused.join(", "));
                self.warnings.push(format!("material `{name}`: not used on a translucent surface: {what}"));
            }
            if let Some(fault) = self.texture_faults.get(&(k as u16)).filter(|_| translucent(k as u16)) {
                self.warnings.push(format!("{fault}: its medium has one color"));
            }
        }
    }

    /// Whether a material is a thin wall, and the property is one of those that define it.
    fn is_shown_by_wall(&self, material: u16, property: &str) -> bool {
        let Some(wall) = self.materials.get(usize::from(material)).and_then(|m| m.wall.as_ref()) else { return false };
        let of = |name: &str| property.contains(&format!("extensions.KHR_materials_{name}"));
        let own = if wall.anisotropy.is_some() { of("scatter.") } else { of("diffuse_transmission.") };
        self.is_wall(material) && (own || of("transmission.transmissionFactor"))
    }

    /// A property with its holders.
    fn named(&self, property: &str, holders: &[&Holder]) -> String {
        if holders.is_empty() {
            return property.to_owned();
        }
        let name = |holder: &&Holder| match holder {
            Holder::Material(k) => quoted(self.materials.get(usize::from(*k)).map_or("", |m| &m.name)),
            Holder::Named(name) => quoted(name),
            Holder::Numbered(k) => k.to_string(),
        };
        format!("{property} ({})", first_of(holders.iter().map(name), MAX_HOLDERS))
    }
}

fn taken_as(numbers: &[f64]) -> String {
    match numbers {
        [] => String::new(),
        [first, others @ ..] if others.iter().all(|x| x == first) => format!(" taken as {first}"),
        all => format!(" taken as {all:?}"),
    }
}
