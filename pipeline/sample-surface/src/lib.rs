//! Phase one: a scene's lit surface as a point cloud.
//!
//! Knows no medium and no camera: one cloud serves all of them.

mod choice;
mod sample;

pub use choice::{Choice, TriangleChoice};
pub use sample::{Drawn, draw};

use formats::cloud::{Meta, Options, SampledMaterial, Samples, version};
use rayon::prelude::*;
use scene::{
    NormalKind, Rays, Scene,
    random::{Purpose, Stream},
};
use std::collections::BTreeMap;

/// Samples that one task draws.
const CHUNK: u64 = 1 << 14;

/// What to sample.
#[derive(Clone, Debug)]
pub struct Settings {
    /// `K`: samples to draw over all translucent surfaces.
    pub samples: u64,
    pub choice: Choice,
    pub normals: NormalKind,
    /// Names of the materials to sample; empty for the file's own marks.
    pub translucent: Vec<String>,
    /// As it is written into the cloud; the seed is used here.
    pub options: Options,
}

/// Why a scene cannot be sampled.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    #[error("--translucent: no surface has a material called `{name}`; there are {known}")]
    UnknownMaterial { name: String, known: String },
    #[error("the scene has no light: give it one, or light it with --environment R,G,B")]
    NoLight,
    #[error("no surface to sample: all of them emit; name one with --translucent")]
    NoSurface,
    #[error("{count} samples have a flux that is no finite number: are light intensities or sizes absurd?")]
    NotFinite { count: u64 },
}

/// A scene with the surfaces to sample, and the identity of the cloud that will come of it.
pub struct Plan {
    /// Indices of the sampled materials, ascending.
    pub materials: Vec<u16>,
    /// The file marked none of them: every surface that does not emit was taken.
    pub unmarked: bool,
    pub geometry: [u8; 32],
    /// Identity of everything the samples depend on.
    pub content: [u8; 32],
}

impl Plan {
    /// Decides which surfaces are translucent.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Plan, SampleError> {
        if scene.lights.is_empty() {
            return Err(SampleError::NoLight);
        }
        let (materials, unmarked) = translucent_materials(scene, &settings.translucent)?;
        let geometry = scene.geometry_digest();
        let mut hasher = blake3::Hasher::new();
        hasher.update(&version().to_le_bytes());
        hasher.update(&geometry);
        hasher.update(&scene.light_digest);
        hasher.update(&settings.samples.to_le_bytes());
        let options = serde_json::json!({ "options": &settings.options, "materials": &materials });
        hasher.update(options.to_string().as_bytes());
        Ok(Plan { materials, unmarked, geometry, content: *hasher.finalize().as_bytes() })
    }
}

/// The named materials, or those the file marks as volumes, or all that do not emit.
fn translucent_materials(scene: &Scene, names: &[String]) -> Result<(Vec<u16>, bool), SampleError> {
    let mut used = vec![false; scene.materials.len()];
    scene.mesh.triangles.iter().for_each(|t| used[t.material as usize] = true);
    let select = |accept: &dyn Fn(&scene::Material) -> bool| -> Vec<u16> {
        (0..used.len()).filter(|k| used[*k] && accept(&scene.materials[*k])).map(|k| k as u16).collect()
    };
    let names_in_use = || -> String {
        let all = select(&|_| true);
        all.iter().map(|k| format!("`{}`", scene.materials[*k as usize].name)).collect::<Vec<_>>().join(", ")
    };
    for name in names {
        if select(&|m| m.name == *name).is_empty() {
            return Err(SampleError::UnknownMaterial { name: name.clone(), known: names_in_use() });
        }
    }
    if !names.is_empty() {
        return Ok((select(&|m| names.contains(&m.name)), false));
    }
    let marked = select(&|m| m.volume);
    if !marked.is_empty() {
        return Ok((marked, false));
    }
    let all = select(&|m| !m.emits());
    if all.is_empty() { Err(SampleError::NoSurface) } else { Ok((all, true)) }
}

/// A cloud in memory.
pub struct Sampled {
    pub samples: Samples,
    pub meta: Meta,
}

/// What one task drew.
struct Portion {
    /// One list for each sampled material.
    samples: Vec<Samples>,
    facing_away: u64,
    shadowed: u64,
    underflow: u64,
    not_finite: u64,
    shadow_rays: u64,
    flux: scene::DVec3,
}

/// Draws the samples, in parallel; `progress` is told how many were drawn. The same for any number of threads.
pub fn sample(
    scene: &Scene,
    rays: &Rays,
    settings: &Settings,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Result<Sampled, SampleError> {
    let choice = TriangleChoice::new(&scene.mesh, settings.choice, |m| plan.materials.contains(&m));
    let stream = Stream::new(settings.options.seed, Purpose::Surface);
    let portion = |chunk: u64| {
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(settings.samples);
        progress(range.end - range.start);
        draw_portion(scene, rays, &choice, settings.normals, plan, range.map(|k| stream.item(k)))
    };
    let portions: Vec<Portion> = (0..settings.samples.div_ceil(CHUNK)).into_par_iter().map(portion).collect();
    let not_finite = portions.iter().map(|p| p.not_finite).sum();
    if not_finite > 0 {
        return Err(SampleError::NotFinite { count: not_finite });
    }
    Ok(join(scene, settings, plan, &choice, portions))
}

fn draw_portion(
    scene: &Scene,
    rays: &Rays,
    choice: &TriangleChoice,
    normals: NormalKind,
    plan: &Plan,
    items: impl Iterator<Item = scene::random::Item>,
) -> Portion {
    let samples = vec![Samples::default(); plan.materials.len()];
    let (facing_away, shadowed, underflow, not_finite, shadow_rays) = (0, 0, 0, 0, 0);
    let flux = scene::DVec3::ZERO;
    let mut p = Portion { samples, facing_away, shadowed, underflow, not_finite, shadow_rays, flux };
    for item in items {
        match draw(scene, rays, choice, normals, item, &mut p.shadow_rays) {
            Drawn::FacingAway => p.facing_away += 1,
            Drawn::Shadowed => p.shadowed += 1,
            Drawn::Underflow => p.underflow += 1,
            Drawn::NotFinite => p.not_finite += 1,
            Drawn::Lit { sample, material } => {
                p.flux += sample.flux.as_dvec3();
                if let Ok(slot) = plan.materials.binary_search(&material) {
                    p.samples[slot].push(&sample);
                }
            }
        }
    }
    p
}

/// Orders the samples by material and adds up what is known of them.
fn join(
    scene: &Scene,
    settings: &Settings,
    plan: &Plan,
    choice: &TriangleChoice,
    mut portions: Vec<Portion>,
) -> Sampled {
    let mut samples = Samples::default();
    let mut materials = Vec::new();
    for (slot, index) in plan.materials.iter().enumerate() {
        let first = samples.len() as u64;
        portions.iter_mut().for_each(|p| samples.append(&mut p.samples[slot]));
        let triangles = scene.mesh.triangles.iter().enumerate().filter(|(_, t)| t.material == *index);
        materials.push(SampledMaterial {
            name: scene.materials[*index as usize].name.clone(),
            index: *index,
            first,
            count: samples.len() as u64 - first,
            area_m2: triangles.map(|(k, _)| scene.mesh.area(k)).sum(),
        });
    }
    let total = |f: fn(&Portion) -> u64| portions.iter().map(f).sum::<u64>();
    let flux: scene::DVec3 = portions.iter().map(|p| p.flux).sum();
    let meta = Meta {
        content: plan.content,
        geometry: plan.geometry,
        lights: scene.light_digest,
        options: settings.options.clone(),
        samples_drawn: settings.samples,
        samples_dropped: BTreeMap::from([
            ("facing_away".into(), total(|p| p.facing_away)),
            ("shadowed".into(), total(|p| p.shadowed)),
            ("underflow".into(), total(|p| p.underflow)),
        ]),
        shadow_rays: total(|p| p.shadow_rays),
        surface_area_m2: choice.area(),
        mean_flux_w: (flux / settings.samples as f64).to_array(),
        diagonal_m: scene.mesh.diagonal(),
        origin_m: scene.origin.to_array(),
        materials,
    };
    Sampled { samples, meta }
}
