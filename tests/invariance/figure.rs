//! The glTF file of the figure, and edits of it.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::fs;
use test_support::{
    data,
    glb::Asset,
    meshes::{Mesh, World, imported, quad},
};

/// Primitives of this material are the figure.
pub const FIGURE: usize = 0;
/// Primitives of this material are opaque.
pub const FLOOR: usize = 1;

/// Radiance of a panel that lights the figure about as much as the other lights do, W/(m² sr).
pub const PANEL: f64 = 4.0;

/// The file of the figure, unchanged or edited.
#[derive(Clone)]
pub struct Figure(pub Asset);

impl Figure {
    /// The file as it is in the repository.
    pub fn read() -> Figure {
        Figure(Asset::read(&fs::read(data("scenes/figure.glb")).expect("the repository has the figure")))
    }

    /// Imported under a constant environment.
    pub fn world_under(&self, environment: DVec3) -> World {
        self.world_of(1.0, environment)
    }

    pub fn world(&self) -> World {
        self.world_of(1.0, DVec3::ZERO)
    }

    /// Imported with another unit of length.
    pub fn world_in(&self, metres_per_unit: f64) -> World {
        self.world_of(metres_per_unit, DVec3::ZERO)
    }

    fn world_of(&self, metres_per_unit: f64, environment: DVec3) -> World {
        imported(&self.0, metres_per_unit, environment)
    }

    /// Puts everything, lights and cameras too, below a new node with this transform.
    pub fn under(mut self, transform: Value) -> Figure {
        let mut parent = transform;
        parent["children"] = self.0.json["scenes"][0]["nodes"].take();
        let index = self.0.push("nodes", parent);
        self.0.json["scenes"][0]["nodes"] = json!([index]);
        self
    }

    /// Multiplies the power of every light.
    pub fn brighter(mut self, factor: f64) -> Figure {
        for light in list(&mut self.0.json["extensions"]["KHR_lights_punctual"]["lights"]) {
            light["intensity"] = json!(number(&light["intensity"]) * factor);
        }
        self
    }

    /// Removes the lights of these nodes.
    pub fn unlit_by(mut self, names: &[&str]) -> Figure {
        for name in names {
            self.node(name)["extensions"] = json!({});
        }
        self
    }

    /// Adds a light at the position of a node's light, with a color of its own.
    pub fn with_copy_of(mut self, name: &str, color: DVec3) -> Figure {
        let node = self.node(name).clone();
        let index = index_of(&node["extensions"]["KHR_lights_punctual"]["light"]);
        let mut light = self.0.json["extensions"]["KHR_lights_punctual"]["lights"][index].clone();
        light["color"] = json!(color.to_array());
        self.0.light(light, node);
        self
    }

    /// Adds a node at the root.
    pub fn with_node(mut self, node: Value) -> Figure {
        self.0.node(node);
        self
    }

    /// Adds a point light at the root; intensity in W/sr.
    pub fn with_lamp(mut self, position: DVec3, intensity: f64) -> Figure {
        let node = json!({ "name": "lamp", "translation": position.to_array() });
        self.0.light(json!({ "type": "point", "intensity": intensity }), node);
        self
    }

    /// Adds a mesh without normals at the root.
    pub fn with_mesh(mut self, mesh: &Mesh, material: usize) -> Figure {
        let primitive = self.primitive(mesh, material);
        let index = self.0.push("meshes", json!({ "primitives": [primitive] }));
        self.with_node(json!({ "mesh": index }))
    }

    /// Adds an emissive square behind the figure, in view.
    pub fn with_panel(mut self, radiance: f64) -> Figure {
        let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": radiance } });
        let material = json!({ "name": "Panel", "emissiveFactor": [1.0, 0.75, 0.5], "extensions": strength });
        let material = self.0.push("materials", material);
        let mut square = quad(0.05, -0.125, 2);
        square.positions.iter_mut().for_each(|p| p.y += 0.0625);
        self.with_mesh(&square, material)
    }

    /// The node of this name.
    pub fn node(&mut self, name: &str) -> &mut Value {
        let node = list(&mut self.0.json["nodes"]).iter_mut().find(|n| n["name"] == name);
        node.expect("the figure has such a node")
    }

    /// The figure's own primitives, one in the file.
    pub fn primitives(&mut self) -> &mut Value {
        &mut self.0.json["meshes"][0]["primitives"]
    }

    /// Positions and triangles of the figure, without its normals.
    pub fn mesh(&self) -> Mesh {
        let primitive = &self.0.json["meshes"][0]["primitives"][0];
        let indices: Vec<u32> = self.words(index_of(&primitive["indices"])).collect();
        let triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        Mesh { positions: self.vectors(index_of(&primitive["attributes"]["POSITION"])), triangles }
    }

    /// The vectors of one of the file's accessors.
    pub fn vectors(&self, accessor: usize) -> Vec<Vec3> {
        let floats: Vec<f32> = self.words(accessor).map(f32::from_bits).collect();
        floats.chunks_exact(3).map(Vec3::from_slice).collect()
    }

    /// The words of an accessor, which has a buffer view to itself.
    fn words(&self, accessor: usize) -> impl Iterator<Item = u32> {
        let view = index_of(&self.0.json["accessors"][accessor]["bufferView"]);
        let view = &self.0.json["bufferViews"][view];
        let (start, length) = (index_of(&view["byteOffset"]), index_of(&view["byteLength"]));
        let words = self.0.binary[start..start + length].chunks_exact(4);
        words.map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }

    /// Replaces the mesh of the figure by one without normals.
    pub fn remeshed(mut self, mesh: &Mesh) -> Figure {
        let primitive = self.primitive(mesh, FIGURE);
        *self.primitives() = json!([primitive]);
        self
    }

    /// A primitive for a mesh without normals, whose numbers are added to the buffer.
    fn primitive(&mut self, mesh: &Mesh, material: usize) -> Value {
        let corners: Vec<[f32; 3]> = mesh.positions.iter().map(Vec3::to_array).collect();
        let positions = self.0.vectors(&corners);
        let indices = self.0.long_indices(mesh.triangles.as_flattened());
        json!({ "attributes": { "POSITION": positions }, "indices": indices, "material": material })
    }
}

/// A list of the document.
fn list(value: &mut Value) -> &mut Vec<Value> {
    value.as_array_mut().expect("the figure's document has this list")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("the figure's document has this number")
}

/// An index of the document.
pub fn index_of(value: &Value) -> usize {
    value.as_u64().expect("the figure's document has this index") as usize
}
