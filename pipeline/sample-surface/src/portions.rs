//! Draws the samples in portions, in parallel, and joins them in their order.

use crate::{
    choice::TriangleChoice,
    hierarchy,
    pattern::{Numbers, Pattern, SamplePoint},
    plan::{Plan, SampleError, Settings},
    sample::{SampleOutcome, draw},
};
use formats::cloud::{Content, Group, Meta, Record, SampledMaterial};
use rayon::prelude::*;
use scene::{
    DVec3, Rays, Scene,
    light::{Bounce, LightTree, LitSurface},
};
use std::collections::BTreeMap;

/// Samples that one task draws.
const PORTION: u64 = 1 << 14;

/// Neighboring samples for which lights are chosen together.
const GROUP: usize = 512;

/// A cloud in memory.
pub struct Sampled {
    pub content: Content,
    pub meta: Meta,
}

/// The result of one task.
#[derive(Default)]
struct Portion {
    /// Two lists for each sampled material: its even and its odd samples.
    groups: Vec<[Vec<Record>; 2]>,
    facing_away: u64,
    shadowed: u64,
    underflow: u64,
    no_bounce: u64,
    not_finite: u64,
    shadow_rays: u64,
    flux: DVec3,
}

/// Draws the samples and orders them, in parallel; `progress` is called with the number of samples that were
/// drawn. The cloud is the same for any
/// number of threads.
pub fn sample(
    scene: &Scene,
    rays: &Rays,
    settings: &Settings,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Result<Sampled, SampleError> {
    let choice = plan.choice(scene, settings);
    let pattern = settings.options.pattern;
    let numbers = Numbers::new(pattern, settings.seed(), settings.samples);
    let lights = LightTree::new(scene.lights());
    // Consecutive stratified samples are neighbors; independent ones lie anywhere.
    let group_size = if pattern == Pattern::Stratified || lights.is_flat() { GROUP } else { 1 };
    let bounce = Bounce::new(scene, |material| plan.samples(material));
    let surface = LitSurface { mesh: &scene.mesh, rays, lights, normals: settings.normals() };
    let portion = |index: u64| {
        let range = index * PORTION..((index + 1) * PORTION).min(settings.samples);
        progress(range.end - range.start);
        draw_portion(&surface, bounce.as_ref(), plan, numbers.points(&choice, range), group_size)
    };
    let portions: Vec<Portion> = (0..settings.samples.div_ceil(PORTION)).into_par_iter().map(portion).collect();
    let not_finite = portions.iter().map(|p| p.not_finite).sum();
    if not_finite > 0 {
        return Err(SampleError::NotFinite { samples: not_finite });
    }
    Ok(join(scene, settings, plan, &choice, portions))
}

/// Draws the samples of one task, in groups of neighbors.
fn draw_portion(
    surface: &LitSurface,
    bounce: Option<&Bounce>,
    plan: &Plan,
    mut points: impl Iterator<Item = (usize, SamplePoint)>,
    group_size: usize,
) -> Portion {
    let mut portion = Portion { groups: vec![Default::default(); plan.surfaces.materials.len()], ..Portion::default() };
    let mut shadow_rays = 0;
    let mut neighbors = Vec::with_capacity(group_size);
    loop {
        neighbors.clear();
        neighbors.extend(points.by_ref().take(group_size));
        if neighbors.is_empty() {
            return Portion { shadow_rays, ..portion };
        }
        draw(surface, bounce, &neighbors, &mut shadow_rays, |half, outcome| portion.count(plan, half, outcome));
    }
}

impl Portion {
    fn count(&mut self, plan: &Plan, half: usize, outcome: SampleOutcome) {
        match outcome {
            SampleOutcome::FacingAway => self.facing_away += 1,
            SampleOutcome::Shadowed => self.shadowed += 1,
            SampleOutcome::NoBounce => self.no_bounce += 1,
            SampleOutcome::Underflow => self.underflow += 1,
            SampleOutcome::NotFinite => self.not_finite += 1,
            SampleOutcome::Lit { sample, material } => {
                self.flux += sample.flux.as_dvec3();
                if let Ok(slot) = plan.surfaces.materials.binary_search(&material) {
                    self.groups[slot][half].push(Record::new(&sample));
                }
            }
        }
    }
}

/// Orders the samples of each material and half, and adds up the facts of all portions.
fn join(
    scene: &Scene,
    settings: &Settings,
    plan: &Plan,
    choice: &TriangleChoice,
    mut portions: Vec<Portion>,
) -> Sampled {
    let mut content = Content::default();
    let mut materials = Vec::new();
    let areas = scene.area_of_materials();
    for (slot, index) in plan.surfaces.materials.iter().enumerate() {
        let halves = [0, 1].map(|half| {
            let mut records = Vec::with_capacity(portions.iter().map(|p| p.groups[slot][half].len()).sum());
            // Each portion is freed as it is joined, so that the samples are not held twice.
            portions.iter_mut().for_each(|p| records.extend(std::mem::take(&mut p.groups[slot][half])));
            add_group(&mut content, &records)
        });
        materials.push(SampledMaterial {
            name: scene.materials[*index as usize].name.clone(),
            index: *index,
            halves,
            area_m2: areas[usize::from(*index)],
        });
    }
    let total = |f: fn(&Portion) -> u64| portions.iter().map(f).sum::<u64>();
    let flux: DVec3 = portions.iter().map(|p| p.flux).sum();
    let meta = Meta {
        content: plan.content,
        geometry: plan.geometry,
        lights: scene.light_digest(),
        options: settings.options.clone(),
        samples_drawn: settings.samples,
        samples_dropped: BTreeMap::from([
            ("facing_away".into(), total(|p| p.facing_away)),
            ("shadowed".into(), total(|p| p.shadowed)),
            ("underflow".into(), total(|p| p.underflow)),
            ("no_bounce".into(), total(|p| p.no_bounce)),
        ]),
        shadow_rays: total(|p| p.shadow_rays),
        mesh_faults: plan.defects.counts().map(|(name, count)| (name.to_owned(), count)).into(),
        surface_area_m2: choice.area(),
        mean_flux_w: (flux / settings.samples as f64).to_array(),
        diagonal_m: scene.mesh.diagonal(),
        origin_m: scene.origin.to_array(),
        materials,
    };
    Sampled { content, meta }
}

/// Appends the samples of one material and half, with the tree over them.
fn add_group(content: &mut Content, records: &[Record]) -> Group {
    let (mut tiles, mut nodes) = hierarchy::build(records);
    let group = Group {
        samples: records.len() as u64,
        first_tile: content.tiles.len() as u64,
        first_node: content.nodes.len() as u64,
    };
    content.samples += group.samples;
    content.tiles.append(&mut tiles);
    content.nodes.append(&mut nodes);
    group
}
