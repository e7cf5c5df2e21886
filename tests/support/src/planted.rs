//! Clouds of samples that a test chooses, ordered as `sample-surface` orders its own.

use crate::pipeline::filed;
use formats::cloud::{
    Choice, Cloud, Content, Group, LightUnit, Meta, Normals, Options, Pattern, Record, Sample, SampledMaterial, Shard,
};
use sample_surface::{Sampled, hierarchy};
use std::collections::BTreeMap;

/// The samples of one material in two halves.
pub type Halves = [Vec<Sample>; 2];

/// Puts even samples into the first half, odd ones into the second.
pub fn alternating(samples: impl IntoIterator<Item = Sample>) -> Halves {
    let mut halves = Halves::default();
    samples.into_iter().enumerate().for_each(|(k, sample)| halves[k % 2].push(sample));
    halves
}

/// The samples of a cloud's materials in their halves.
pub fn stored(cloud: &Cloud) -> Vec<Halves> {
    let list = |material: &SampledMaterial| {
        let mut first: Vec<Sample> = cloud.samples(material).collect();
        let second = first.split_off(material.halves[0].samples as usize);
        [first, second]
    };
    cloud.meta().materials.iter().map(list).collect()
}

/// A cloud of these samples, one entry for each material, with the other metadata of `facts`.
pub fn planted(facts: &Meta, materials: &[Halves]) -> Sampled {
    assert_eq!(facts.materials.len(), materials.len());
    let mut content = Content::default();
    let mut meta = facts.clone();
    for (material, halves) in meta.materials.iter_mut().zip(materials) {
        material.halves = halves.each_ref().map(|samples| add(&mut content, samples));
    }
    meta.samples_drawn = meta.samples_drawn.max(content.samples);
    Sampled { content, meta }
}

fn add(content: &mut Content, samples: &[Sample]) -> Group {
    let records: Vec<Record> = samples.iter().map(Record::new).collect();
    let (tiles, nodes) = hierarchy::build(&records);
    let (first_tile, first_node) = (content.tiles.len() as u64, content.nodes.len() as u64);
    content.tiles.extend(tiles);
    content.nodes.extend(nodes);
    content.samples += samples.len() as u64;
    Group { samples: samples.len() as u64, first_tile, first_node }
}

/// A cloud of one material that holds exactly these samples, about the origin of the world.
pub fn cloud_of(halves: &Halves) -> Cloud {
    filed(&planted(&facts(), std::slice::from_ref(halves)))
}

/// Metadata of a cloud that belongs to no scene.
fn facts() -> Meta {
    let options = Options {
        seed: 0,
        shard: Shard::ALONE,
        choice: Choice::Area,
        pattern: Pattern::Independent,
        shares: Vec::new(),
        normals: Normals::Geometric,
        metres_per_unit: 1.0,
        light_unit: LightUnit::Radiometric,
        emission_unit: LightUnit::Radiometric,
        pose: String::new(),
        environment: "0,0,0".into(),
    };
    let material = SampledMaterial { name: "test".into(), index: 0, halves: [Group::default(); 2], area_m2: 1.0 };
    Meta {
        content: [0; 32],
        geometry: [0; 32],
        lights: [0; 32],
        options,
        samples_drawn: 1,
        samples_dropped: BTreeMap::new(),
        shadow_rays: 0,
        mesh_faults: BTreeMap::new(),
        surface_area_m2: 1.0,
        mean_flux_w: [0.0; 3],
        diagonal_m: 1.0,
        origin_m: [0.0; 3],
        materials: vec![material],
    }
}
