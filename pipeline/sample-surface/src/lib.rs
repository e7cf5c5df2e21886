//! Phase one: a scene's lit surface as a point cloud.
//!
//! Knows no medium and no camera: one cloud serves all of them.

mod adaptive_count;
mod bounce;
mod choice;
pub mod hierarchy;
mod hilbert;
mod pattern;
mod points;
mod ribbon;
mod sample;
mod surface;
mod trials;

pub use adaptive_count::{Enough, Round, sample_enough};
pub use bounce::Bounce;
pub use choice::{Choice, Chosen, TriangleChoice};
pub use pattern::{Numbers, Pattern, SamplePoint};
pub use points::Goal;
pub use sample::{SampleOutcome, draw};
pub use surface::LitSurface;
pub use trials::{TRIALS, Trials};

use cli::{Thing, Unclear, count, count_up, the_one};
use formats::cloud::{Content, Group, Meta, Options, Record, SampledMaterial, version};
use rayon::prelude::*;
use scene::{MeshDefects, NormalKind, Rays, Scene, light::LightTree, random};
use std::collections::{BTreeMap, BTreeSet};

/// Samples that one task draws.
const CHUNK: u64 = 1 << 14;

/// Samples that share a list of lights.
const TOGETHER: usize = 512;

/// What to sample.
#[derive(Clone, Debug)]
pub struct Settings {
    /// `K`: samples to draw over all translucent surfaces.
    pub samples: u64,
    pub choice: Choice,
    pub pattern: Pattern,
    pub normals: NormalKind,
    /// Names of the materials to sample; empty for the file's own marks.
    pub translucent: Vec<String>,
    /// Materials with the share of the samples that is drawn on their surfaces; the others share the rest by `choice`.
    pub shares: Vec<(String, f64)>,
    /// As it is written into the cloud; seed and shard are used here.
    pub options: Options,
}

impl Settings {
    /// Of the random numbers: that of the shard.
    pub fn seed(&self) -> u64 {
        let Options { seed, shard, .. } = &self.options;
        random::shard_seed(*seed, shard.index, shard.count)
    }
}

/// Why a scene cannot be sampled.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    #[error("--translucent: no surface has a material called `{name}`; there are {known}")]
    UnknownMaterial { name: String, known: String },
    #[error("{option}: `{name}` may be more than one material: give one of {choices}")]
    SeveralMaterials { option: &'static str, name: String, choices: String },
    #[error("--share: no sampled surface has a material called `{name}`; there are {known}")]
    UnknownShare { name: String, known: String },
    #[error("--share: `{name}` has two; give one")]
    TwoShares { name: String },
    #[error("--share: {sum} in all; {wanted}")]
    ShareSum { sum: f64, wanted: &'static str },
    #[error("the scene has no light: give it one, or light it with --environment")]
    NoLight,
    #[error("{0}, or pass --translucent NAME")]
    Lost(#[from] scene::LostVolumes),
    #[error("no surface to sample: all of them emit; name one with --translucent")]
    NoSurface,
    #[error("{} samples have an error of {error:.2e}; the target needs about {}, there is room for {}", count(*samples), count_up(*next as f64), count(*most))]
    TooMany { samples: u64, error: f64, next: u64, most: u64 },
    #[error("{} samples have a flux that is no finite number: are light intensities or sizes absurd?", cli::count(*count))]
    NotFinite { count: u64 },
}

/// A scene with the surfaces to sample, and the identity of the cloud that will come of it.
pub struct Plan {
    /// Indices of the sampled materials, ascending.
    pub materials: Vec<u16>,
    /// Materials with a share of their own.
    pub shares: Vec<(u16, f64)>,
    /// The file marked none of them: every surface that does not emit was taken.
    pub unmarked: bool,
    pub geometry: [u8; 32],
    /// Of the sampled surfaces.
    pub defects: MeshDefects,
    /// Identity of everything the samples depend on.
    pub content: [u8; 32],
}

impl Plan {
    /// Decides which surfaces are translucent.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Plan, SampleError> {
        if scene.lights().next().is_none() {
            return Err(SampleError::NoLight);
        }
        let (materials, unmarked) = translucent_materials(scene, &settings.translucent)?;
        let shares = share_of_materials(scene, &materials, &settings.shares)?;
        let geometry = scene.geometry_digest();
        let mut hasher = blake3::Hasher::new();
        hasher.update(&version().to_le_bytes());
        hasher.update(&geometry);
        hasher.update(&scene.light_digest());
        hasher.update(&settings.samples.to_le_bytes());
        let options = serde_json::json!({ "options": &settings.options, "materials": &materials });
        hasher.update(options.to_string().as_bytes());
        let defects = scene.defects(|material| materials.binary_search(&material).is_ok());
        Ok(Plan { materials, shares, unmarked, geometry, defects, content: *hasher.finalize().as_bytes() })
    }
}

impl Plan {
    /// Whether a material's surfaces are sampled.
    pub fn samples(&self, material: u16) -> bool {
        self.materials.binary_search(&material).is_ok()
    }

    /// The triangles to choose from.
    pub fn choice(&self, scene: &Scene, settings: &Settings) -> TriangleChoice {
        TriangleChoice::with_shares(&scene.mesh, settings.choice, |m| self.samples(m), &self.shares)
    }

    /// Makes the cloud's identity depend on what its number of samples is chosen by.
    pub fn depends_on(&mut self, goal: &Goal) {
        // By the scatter of trials: a cloud of the time when the first small difference of halves did is not kept.
        let what = format!("trials {:?} {:?} {}", goal.medium.channels, goal.medium.eta, goal.error);
        self.content = *blake3::Hasher::new().update(&self.content).update(what.as_bytes()).finalize().as_bytes();
    }
}

/// The named materials, or those the file marks as volumes, or all that do not emit.
fn translucent_materials(scene: &Scene, names: &[String]) -> Result<(Vec<u16>, bool), SampleError> {
    let mut used = vec![false; scene.materials.len()];
    scene.mesh.triangles.iter().for_each(|t| used[t.material as usize] = true);
    let select = |accept: &dyn Fn(&scene::Material) -> bool| -> Vec<u16> {
        (0..used.len()).filter(|k| used[*k] && accept(&scene.materials[*k])).map(|k| k as u16).collect()
    };
    if !names.is_empty() {
        let things = things(scene, &select(&|_| true));
        let unknown = |name, known| SampleError::UnknownMaterial { name, known };
        let named = names.iter().map(|name| material(name, &things, "--translucent", unknown));
        let named: BTreeSet<u16> = named.collect::<Result<_, _>>()?;
        return Ok((named.into_iter().collect(), false));
    }
    match scene.translucent()? {
        (none, _) if none.is_empty() => Err(SampleError::NoSurface),
        some => Ok(some),
    }
}

/// Materials as a word may mean them.
fn things<'a>(scene: &'a Scene, materials: &[u16]) -> Vec<Thing<'a>> {
    let mut areas = vec![0.0; scene.materials.len()];
    let triangles = scene.mesh.triangles.iter().enumerate();
    triangles.for_each(|(k, t)| areas[usize::from(t.material)] += scene.mesh.area(k));
    let thing = |index: usize| {
        let place = format!(", {:.4e} m2", areas[index]);
        Thing { index, names: vec![&scene.materials[index].name], place }
    };
    materials.iter().map(|m| thing(usize::from(*m))).collect()
}

/// The material that a word of an option means, if it can mean no other.
fn material(
    word: &str,
    things: &[Thing],
    option: &'static str,
    unknown: impl Fn(String, String) -> SampleError,
) -> Result<u16, SampleError> {
    let index = the_one(word, things, false).map_err(|unclear| match unclear {
        Unclear::Unknown { known } => unknown(word.to_owned(), known),
        Unclear::Several { choices } => SampleError::SeveralMaterials { option, name: word.to_owned(), choices },
    })?;
    Ok(index as u16)
}

/// The named shares by material; every sampled material must be left something.
fn share_of_materials(
    scene: &Scene,
    materials: &[u16],
    named: &[(String, f64)],
) -> Result<Vec<(u16, f64)>, SampleError> {
    let things = things(scene, materials);
    let mut shares: Vec<(u16, f64)> = Vec::new();
    for (name, share) in named {
        let unknown = |name, known| SampleError::UnknownShare { name, known };
        let material = material(name, &things, "--share", unknown)?;
        if shares.iter().any(|(m, _)| *m == material) {
            return Err(SampleError::TwoShares { name: name.clone() });
        }
        shares.push((material, *share));
    }
    let sum: f64 = shares.iter().map(|(_, share)| share).sum();
    let wanted = if shares.len() < materials.len() {
        (sum >= 1.0).then_some("less than 1 is needed, for the other materials")
    } else {
        (!shares.is_empty() && (sum - 1.0).abs() > 1e-9).then_some("1 is needed where every material has one")
    };
    wanted.map_or(Ok(shares), |wanted| Err(SampleError::ShareSum { sum, wanted }))
}

/// A cloud in memory.
pub struct Sampled {
    pub content: Content,
    pub meta: Meta,
}

/// What one task drew.
struct Portion {
    /// Two lists for each sampled material: its even and its odd samples.
    groups: Vec<[Vec<Record>; 2]>,
    facing_away: u64,
    shadowed: u64,
    underflow: u64,
    no_bounce: u64,
    not_finite: u64,
    shadow_rays: u64,
    flux: scene::DVec3,
}

/// Draws the samples and orders them, in parallel; `progress` is told how many were drawn. The same for any number of
/// threads.
pub fn sample(
    scene: &Scene,
    rays: &Rays,
    settings: &Settings,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Result<Sampled, SampleError> {
    let choice = plan.choice(scene, settings);
    let numbers = Numbers::new(settings.pattern, settings.seed(), settings.samples);
    let lights = LightTree::new(scene.lights());
    // Independent samples that follow each other lie anywhere.
    let together = if settings.pattern == Pattern::Stratified || lights.is_flat() { TOGETHER } else { 1 };
    let bounce = Bounce::new(scene, |m| plan.samples(m));
    let surface = LitSurface { mesh: &scene.mesh, rays, lights, normals: settings.normals };
    let portion = |chunk: u64| {
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(settings.samples);
        progress(range.end - range.start);
        draw_portion(&surface, bounce.as_ref(), plan, numbers.points(&choice, range), together)
    };
    let portions: Vec<Portion> = (0..settings.samples.div_ceil(CHUNK)).into_par_iter().map(portion).collect();
    let not_finite = portions.iter().map(|p| p.not_finite).sum();
    if not_finite > 0 {
        return Err(SampleError::NotFinite { count: not_finite });
    }
    Ok(join(scene, settings, plan, &choice, portions))
}

fn draw_portion(
    surface: &LitSurface,
    bounce: Option<&Bounce>,
    plan: &Plan,
    mut points: impl Iterator<Item = (usize, SamplePoint)>,
    together: usize,
) -> Portion {
    let groups = vec![[Vec::new(), Vec::new()]; plan.materials.len()];
    let (facing_away, shadowed, underflow, no_bounce, not_finite) = (0, 0, 0, 0, 0);
    let flux = scene::DVec3::ZERO;
    let mut p = Portion { groups, facing_away, shadowed, underflow, no_bounce, not_finite, shadow_rays: 0, flux };
    let mut shadow_rays = 0;
    let mut neighbours = Vec::with_capacity(together);
    loop {
        neighbours.clear();
        neighbours.extend(points.by_ref().take(together));
        if neighbours.is_empty() {
            return Portion { shadow_rays, ..p };
        }
        draw(surface, bounce, &neighbours, &mut shadow_rays, |half, drawn| p.count(plan, half, drawn));
    }
}

impl Portion {
    fn count(&mut self, plan: &Plan, half: usize, drawn: SampleOutcome) {
        match drawn {
            SampleOutcome::FacingAway => self.facing_away += 1,
            SampleOutcome::Shadowed => self.shadowed += 1,
            SampleOutcome::NoBounce => self.no_bounce += 1,
            SampleOutcome::Underflow => self.underflow += 1,
            SampleOutcome::NotFinite => self.not_finite += 1,
            SampleOutcome::Lit { sample, material } => {
                self.flux += sample.flux.as_dvec3();
                if let Ok(slot) = plan.materials.binary_search(&material) {
                    self.groups[slot][half].push(Record::new(&sample));
                }
            }
        }
    }
}

/// Puts the samples of each material and half in order and adds up what is known of them.
fn join(
    scene: &Scene,
    settings: &Settings,
    plan: &Plan,
    choice: &TriangleChoice,
    mut portions: Vec<Portion>,
) -> Sampled {
    let mut content = Content::default();
    let mut materials = Vec::new();
    let areas = area_of_materials(scene);
    for (slot, index) in plan.materials.iter().enumerate() {
        let halves = [0, 1].map(|half| {
            let mut records = Vec::with_capacity(portions.iter().map(|p| p.groups[slot][half].len()).sum());
            // What is joined is freed.
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
    let flux: scene::DVec3 = portions.iter().map(|p| p.flux).sum();
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

/// m², by the index of the material; in one pass, since there may be as many materials as triangles.
fn area_of_materials(scene: &Scene) -> Vec<f64> {
    let mut areas = vec![0.0; scene.materials.len()];
    for (k, triangle) in scene.mesh.triangles.iter().enumerate() {
        areas[usize::from(triangle.material)] += scene.mesh.area(k);
    }
    areas
}

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
