//! The identity of a scene, by which clouds recognize it.

use crate::{
    material::{Alpha, Material, Wall},
    panes::Sheet,
    scene::Scene,
    texture::Texture,
};
use std::{collections::BTreeMap, sync::Arc};

impl Scene {
    /// Identity of the file's lights, as a BLAKE3 digest. The environment has one of its own.
    pub fn light_digest(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        self.file_lights.iter().for_each(|light| light.hash_into(&mut hasher));
        *hasher.finalize().as_bytes()
    }

    /// Identity of the geometry, of which material covers which triangle, and of its colors and holes, as a BLAKE3
    /// digest.
    pub fn geometry_digest(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        let mut put = |bytes: &[u8]| {
            hasher.update(bytes);
        };
        self.origin.to_array().iter().for_each(|x| put(&x.to_le_bytes()));
        for v in self.mesh.positions.iter().chain(&self.mesh.normals) {
            v.to_array().iter().for_each(|x| put(&x.to_le_bytes()));
        }
        for t in &self.mesh.triangles {
            t.vertices.iter().for_each(|i| put(&i.to_le_bytes()));
            put(&t.material.to_le_bytes());
        }
        for m in &self.materials {
            put(&(m.name.len() as u64).to_le_bytes());
            put(m.name.as_bytes());
        }
        self.put_colors(&mut put);
        self.put_bumps(&mut put);
        for (k, sheet) in self.sheets.iter().enumerate().filter_map(|(k, sheet)| Some((k, (*sheet)?))) {
            let numbers = match (sheet, &self.materials[k].wall) {
                (Sheet::Pane(ior), _) => ("pane", vec![ior]),
                (Sheet::Wall, wall) => ("wall", wall.iter().flat_map(Wall::numbers).collect()),
            };
            put(numbers.0.as_bytes());
            put(&(k as u64).to_le_bytes());
            numbers.1.iter().for_each(|x| put(&x.to_le_bytes()));
            let wall = self.materials[k].wall.as_ref().filter(|_| sheet == Sheet::Wall);
            for (which, texture) in wall.iter().flat_map(|wall| wall.textures.iter().enumerate()) {
                let Some(texture) = texture else { continue };
                put(&(which as u64).to_le_bytes());
                put_texture(texture, &mut put);
            }
        }
        for (k, material) in self.materials.iter().enumerate().filter(|(k, _)| !self.is_wall(*k as u16)) {
            let Some(texture) = &material.scatter_texture else { continue };
            put(b"scatter");
            put(&(k as u64).to_le_bytes());
            put_texture(texture, &mut put);
        }
        for coordinates in &self.mesh.scatter_coordinates {
            coordinates.as_flattened().iter().for_each(|x| put(&x.to_le_bytes()));
        }
        *hasher.finalize().as_bytes()
    }

    /// Identity of what the file states of metal and roughness, as a BLAKE3 digest; none if all surfaces are matt or, if
    /// marked as translucent, smooth.
    pub fn gloss_digest(&self) -> Option<[u8; 32]> {
        let mut hasher = blake3::Hasher::new();
        let shown = |m: &'_ Material| m.gloss.clone().filter(|gloss| !m.volume || gloss.is_rough());
        let all: Vec<_> = self.materials.iter().enumerate().filter_map(|(k, m)| Some((k, shown(m)?))).collect();
        for (k, gloss) in &all {
            let schlick = [gloss.dielectric.normal, gloss.dielectric.grazing].map(|v| v.to_array());
            let numbers = [*k as f64, gloss.metallic, gloss.roughness];
            let numbers = numbers.into_iter().chain(schlick.into_iter().flatten());
            numbers.for_each(|x| _ = hasher.update(&x.to_le_bytes()));
            if let Some(texture) = &gloss.texture {
                hasher.update(&[texture.wrap[0] as u8, texture.wrap[1] as u8, u8::from(texture.nearest)]);
                hasher.update(&(texture.picture.width as u64).to_le_bytes());
                hasher.update(texture.picture.texels.as_flattened());
            }
        }
        self.mesh.gloss_coordinates.as_flattened().iter().for_each(|x| _ = hasher.update(&x.to_le_bytes()));
        (!all.is_empty()).then(|| *hasher.finalize().as_bytes())
    }

    /// Identity of the roughness of a translucent material, as a BLAKE3 digest; none if it is smooth.
    pub fn roughness_digest(&self, material: u16) -> Option<[u8; 32]> {
        let gloss = self.materials.get(usize::from(material))?.gloss.as_ref().filter(|gloss| gloss.is_rough())?;
        let mut hasher = blake3::Hasher::new();
        hasher.update(&gloss.roughness.to_le_bytes());
        if let Some(texture) = &gloss.texture {
            put_texture(texture, &mut |bytes| _ = hasher.update(bytes));
            self.mesh.gloss_coordinates.as_flattened().iter().for_each(|x| _ = hasher.update(&x.to_le_bytes()));
        }
        Some(*hasher.finalize().as_bytes())
    }

    /// Gives `put` all that normal maps depend on.
    fn put_bumps(&self, put: &mut impl FnMut(&[u8])) {
        let Some(bumps) = &self.mesh.bumps else { return };
        put(b"bumps");
        for (k, map) in bumps.maps.iter().enumerate().filter_map(|(k, map)| Some((k, map.as_ref()?))) {
            put(&(k as u64).to_le_bytes());
            put(&map.scale().to_le_bytes());
            put_texture(map.texture(), put);
        }
        bumps.coordinates.as_flattened().iter().for_each(|x| put(&x.to_le_bytes()));
        for frame in bumps.frames.as_flattened() {
            frame.tangent.to_array().iter().chain([&frame.sign]).for_each(|x| put(&x.to_le_bytes()));
        }
    }

    /// Gives `put` all that colors and holes depend on: they light and shadow the samples.
    fn put_colors(&self, put: &mut impl FnMut(&[u8])) {
        // A picture of several materials is put once, and referred to by its number afterwards.
        let mut numbers = BTreeMap::new();
        for material in &self.materials {
            let cutoff = match material.alpha {
                Alpha::Ignored => f64::INFINITY,
                Alpha::Cutoff(cutoff) => f64::from(cutoff),
                Alpha::Coverage => -1.0,
            };
            material.base_color.to_array().iter().chain([&cutoff]).for_each(|x| put(&x.to_le_bytes()));
            // What a metal mirrors lights no samples.
            if let Some(gloss) = material.gloss.as_ref().filter(|gloss| !material.volume && gloss.metallic > 0.0) {
                put(b"gloss");
                put(&gloss.metallic.to_le_bytes());
                gloss.texture.iter().for_each(|texture| put(texture.picture.texels.as_flattened()));
            }
            let Some(texture) = &material.base_texture else { continue };
            let [along, down] = texture.wrap.map(|w| w as u8);
            let next = numbers.len() as u64;
            let number = *numbers.entry(Arc::as_ptr(&texture.picture)).or_insert(next);
            let known = number < next;
            put(&[1 + u8::from(known), along, down, u8::from(texture.nearest)]);
            if known {
                put(&number.to_le_bytes());
                continue;
            }
            put(&(texture.picture.width as u64).to_le_bytes());
            put(&(texture.picture.texels.len() as u64).to_le_bytes());
            put(texture.picture.texels.as_flattened());
        }
        self.mesh.coordinates.as_flattened().iter().for_each(|x| put(&x.to_le_bytes()));
        self.mesh.colors.as_flattened().iter().for_each(|x| put(&x.to_le_bytes()));
    }
}

/// Gives `put` a texture.
fn put_texture(texture: &Texture, put: &mut impl FnMut(&[u8])) {
    let [along, down] = texture.wrap.map(|w| w as u8);
    put(&[along, down, u8::from(texture.nearest)]);
    put(&(texture.picture.width as u64).to_le_bytes());
    put(&(texture.picture.texels.len() as u64).to_le_bytes());
    put(texture.picture.texels.as_flattened());
}
