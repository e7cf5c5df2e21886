//! The properties that are not honoured, of all parts of the file that the image shows or that light it.

use super::{
    base_color, clipping,
    container::Document,
    gloss,
    honoured::{self, Fate},
    nodes::SceneNode,
    survey::{Finding, Survey},
    textures, volumes,
};
use crate::{
    mesh::Mesh,
    unhonoured::{Holder, Unhonoured},
    view::Camera,
};
use glam::DVec3;
use gltf::json::{self, Root};
use std::collections::BTreeSet;

/// The parts of the scene.
pub(super) struct RenderedParts<'a> {
    pub mesh: &'a Mesh,
    pub nodes: &'a [SceneNode<'a>],
    /// One camera for each node that carries one, in the order of the nodes.
    pub cameras: &'a [Camera],
    pub origin: DVec3,
    pub metres_per_unit: f64,
}

/// Collects the properties that are not honoured.
pub(super) fn of(document: &Document, parts: &RenderedParts) -> Vec<Unhonoured> {
    let root = &document.root;
    let mut list = Collected { survey: &document.survey, list: Vec::new() };
    let materials: BTreeSet<u16> = parts.mesh.triangles.iter().map(|t| t.material).collect();
    for k in &materials {
        list.add(honoured::MATERIALS, usize::from(*k), Some(Holder::Material(*k)));
    }
    list.add_pictures(root, &materials);
    list.add_nodes(root, parts.nodes);
    list.add_cameras(root, parts);
    let scene = root.scene.as_ref().map_or(0, |s| s.value());
    list.add_each(honoured::SCENES, [scene], |k| root.scenes.get(k)?.name.clone());
    for name in [honoured::ACCESSORS, honoured::VIEWS, honoured::BUFFERS] {
        list.add_each(name, 0..list.survey.len(name), |_| None);
    }
    list.add(honoured::DOCUMENT, 0, None);
    list.list
}

struct Collected<'a> {
    survey: &'a Survey,
    list: Vec<Unhonoured>,
}

impl Collected<'_> {
    /// Adds the findings about an element.
    fn add(&mut self, list: &'static str, index: usize, holder: Option<Holder>) {
        self.add_if(list, index, holder, |_| true);
    }

    /// Adds the findings about elements that are named in the file, or else by their index.
    fn add_each(
        &mut self,
        list: &'static str,
        indices: impl IntoIterator<Item = usize>,
        name: impl Fn(usize) -> Option<String>,
    ) {
        for index in indices {
            self.add(list, index, Some(name(index).map_or(Holder::Numbered(index), Holder::Named)));
        }
    }

    fn add_if(&mut self, list: &'static str, index: usize, holder: Option<Holder>, accept: impl Fn(&Finding) -> bool) {
        for find in self.survey.of(list, index).iter().filter(|find| accept(find)) {
            let start = if list == honoured::DOCUMENT { String::new() } else { format!("{list}[].") };
            let taken = |fate: Fate| if let Fate::TakenAs(numbers) = fate { numbers } else { &[][..] };
            let on = find.on.map(|fate| fate.map(taken));
            self.list.push(Unhonoured { property: format!("{start}{}", find.path), holder: holder.clone(), on });
        }
    }

    /// Adds the textures of base color, emission, metallic and roughness, normals, thin walls, and scattering with their
    /// samplers and images.
    fn add_pictures(&mut self, root: &Root, materials: &BTreeSet<u16>) {
        let materials = materials.iter().filter_map(|k| root.materials.get(usize::from(*k)));
        let own = |m: &json::Material| {
            let base = base_color::texture(m).map(|(info, _)| info.index.value());
            let others = [
                m.emissive_texture.as_ref().map(|info| info.index.value()),
                gloss::texture(m).map(|info| info.index.value()),
                m.normal_texture.as_ref().map(|texture| texture.index.value()),
            ];
            let walls = volumes::wall_textures(m).map(|stated| stated.map(|(info, _)| info.index.value()));
            let scatter = volumes::scatter_texture(m).map(|info| info.index.value());
            [base, others[0], others[1], others[2], walls[0], walls[1], scatter]
        };
        let textures: BTreeSet<usize> = materials.flat_map(own).flatten().collect();
        let (mut samplers, mut images) = (BTreeSet::new(), BTreeSet::new());
        for texture in textures.iter().filter_map(|k| root.textures.get(*k)) {
            samplers.extend(texture.sampler.as_ref().map(|s| s.value()));
            images.extend(textures::source_of(texture).map(|source| source.value()));
        }
        self.add_each(honoured::TEXTURES, textures, |k| root.textures.get(k)?.name.clone());
        self.add_each(honoured::SAMPLERS, samplers, |_| None);
        self.add_each(honoured::IMAGES, images, |k| root.images.get(k)?.name.clone());
    }

    /// Adds the nodes of the scene with their meshes and lights.
    fn add_nodes(&mut self, root: &Root, nodes: &[SceneNode]) {
        let (mut meshes, mut lights) = (BTreeSet::new(), BTreeSet::new());
        for placed in nodes {
            self.add(honoured::NODES, placed.index, Some(Holder::Named(placed.name.clone())));
            meshes.extend(placed.node.mesh.as_ref().map(|m| m.value()));
            let light = placed.node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
            lights.extend(light.map(|l| l.light.value()));
        }
        self.add_each(honoured::MESHES, meshes, |k| root.meshes.get(k)?.name.clone());
        let defined = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        self.add_each(honoured::LIGHTS, lights, |k| defined?.lights.get(k)?.name.clone());
    }

    /// Adds the cameras. Their planes are added only where they would cut anything off.
    fn add_cameras(&mut self, root: &Root, parts: &RenderedParts) {
        let (mut room, bounds) = (clipping::MAX_TESTS, parts.mesh.bounds());
        let indices = parts.nodes.iter().filter_map(|placed| placed.node.camera.as_ref());
        for (index, camera) in indices.zip(parts.cameras) {
            let Some(planes) = root.cameras.get(index.value()).and_then(planes) else { continue };
            let planes = planes.map(|z| z * parts.metres_per_unit);
            let cut = clipping::cuts((parts.mesh, bounds), parts.origin, camera, planes, &mut room);
            self.add_if(honoured::CAMERAS, index.value(), Some(Holder::Named(camera.name.clone())), |find| {
                let [near, far] = [".znear", ".zfar"].map(|plane| find.path.ends_with(plane));
                find.on[0] != Some(Fate::Cuts) || near && cut[0] || far && cut[1]
            });
        }
    }
}

/// Distances of the near and far planes, in units of the file.
fn planes(camera: &json::Camera) -> Option<[f64; 2]> {
    let perspective = camera.perspective.as_ref().map(|p| [Some(p.znear), p.zfar]);
    let planes = perspective.or_else(|| camera.orthographic.as_ref().map(|o| [Some(o.znear), Some(o.zfar)]))?;
    Some([planes[0].map_or(0.0, f64::from), planes[1].map_or(f64::INFINITY, f64::from)])
}
