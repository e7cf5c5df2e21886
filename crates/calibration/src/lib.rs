//! What a BSSRDF model gets wrong on the true shape of an object, measured by random walks and mended by a smooth factor
//! on its surface (docs/method.md section 16).
//!
//! A BSSRDF describes light below a plane. On another shape the light that leaves differs by a factor that changes
//! slowly over the surface and does not depend on the camera. [`calibrate`] follows random walks from the samples of a
//! cloud through the mesh ([`walks`]), counts what leaves each patch of the surface, and fits the factor; [`Factors`]
//! gives it at any point.
//!
//! A factor of one half on the surface of a ball of one patch, as a file would hold it:
//!
//! ```
//! use calibration::{Factors, Site};
//! use formats::calibration::{CalibratedMaterial, CalibratedPatch, CalibratedSurface, ChannelErrors, MediumFacts};
//! use scene::DVec3;
//!
//! let medium = MediumFacts {
//!     name: "milk".into(),
//!     source: String::new(),
//!     sigma_a: [2.0; 3],
//!     sigma_s: [1000.0; 3],
//!     g: [0.0; 3],
//!     eta: 1.3,
//! };
//! let half = [0.5f32.ln(); 3];
//! let patch = CalibratedPatch { center: [0.0; 6], radius: 0.02, log_factor: half, gradient: [[0.0; 3]; 3] };
//! let surface = CalibratedSurface { normal_scale: 0.03, splits: Vec::new(), patches: vec![patch] };
//! let (lobe, errors) = ([[1.0, 0.0]; 3], [ChannelErrors::default(); 3]);
//! let ball = CalibratedMaterial { name: "ball".into(), index: 0, medium, roughness: None, lobe, errors, surface };
//! let at = Site { position: DVec3::Z * 0.01, normal: DVec3::Z };
//! assert!((Factors::new(&ball).at(&at, DVec3::Z) - DVec3::splat(0.5)).length() < 1e-6);
//! ```

mod compared;
mod entries;
mod errors;
mod factors;
mod fit;
mod misfit;
mod patches;
mod sparse;
mod surface;
mod tally;
mod views;

pub use factors::Factors;
pub use patches::{Patches, Site};

use bssrdf::{Medium, Model, Partition, RoughEntry};
use compared::Compared;
use entries::Entries;
use errors::Light;
use fit::Smoothness;
use formats::{
    calibration::{CalibratedMaterial, Calibration, ChannelErrors, MediumFacts, version},
    cloud::{Cloud, shards},
};
use near_field::{NearField, Surroundings};
use scene::{NormalKind, Rays, Scene};
use std::sync::Arc;
use sums::{Summation, estimator::Scatterer};
use surface::{Lit, Surface};
use tally::Walking;
use views::Views;
use walks::{Roughness, Solid};

/// What is calibrated, and how.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// One cloud of this scene, or several that are gathered as one.
    pub clouds: &'a [Cloud],
    /// The medium of each material that the clouds sampled, in their order.
    pub media: &'a [Medium],
    pub model: Model,
    pub normals: NormalKind,
    /// Random walks of each channel, over all materials.
    pub walks: u64,
    pub seed: u64,
}

/// The part of the work that one material gets.
#[derive(Clone, Copy)]
struct Portion {
    depth: u32,
    walks: u64,
}

/// Why a material cannot be calibrated.
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    #[error(
        "`{material}`: {share:.3} % of the random walks left through holes of its surface; a medium needs a closed \
         surface whose triangles are wound outwards"
    )]
    Open { material: String, share: f64 },
    #[error("`{material}`: no light enters it, so that there is nothing to calibrate")]
    Dark { material: String },
}

/// Random walks of each channel, over all materials, unless the user says otherwise.
pub const WALKS: u64 = 300_000;

/// Levels of splits of a surface alone: 1024 patches. Several materials share patches and walks by their areas.
const DEPTH: u32 = 10;

/// Walks of a channel for each patch, at least: with fewer walks there are fewer patches, and less work.
const WALKS_OF_PATCH: f64 = 64.0;

/// The fewest levels of splits of a material, and the smallest share of the walks.
const MIN_DEPTH: u32 = 6;
const MIN_SHARE: f64 = 1.0 / 16.0;

/// Points of each patch at which the model is evaluated.
const POINTS: usize = 64;

impl Task<'_> {
    /// Units of work of [`calibrate`]: walks and points.
    pub fn work(&self) -> u64 {
        self.portions().iter().map(|p| 3 * p.walks + (POINTS << p.depth) as u64).sum()
    }

    /// The portion of each sampled material, by its share of the area.
    fn portions(&self) -> Vec<Portion> {
        let areas: Vec<f64> = shards::materials(self.clouds).iter().map(|m| m.area_m2).collect();
        let total: f64 = areas.iter().sum();
        let portion = |area: &f64| {
            let share = if total > 0.0 { area / total } else { 1.0 };
            let walks = (self.walks as f64 * share.max(MIN_SHARE)).ceil();
            let levels = (f64::from(DEPTH) + share.log2().round()).min((walks / WALKS_OF_PATCH).log2());
            Portion { depth: levels.max(f64::from(MIN_DEPTH)) as u32, walks: walks as u64 }
        };
        areas.iter().map(portion).collect()
    }

    /// The model's light of the sampled material `slot`.
    fn lit<'b>(&'b self, slot: usize, rough: Option<&RoughEntry>, surroundings: &'b Surroundings<'b>) -> Lit<'b> {
        let (sampled, medium) = (&shards::materials(self.clouds)[slot], &self.media[slot]);
        let near = NearField::of_clouds(self.model, medium, self.clouds, slot).map(|near| near.behind(rough));
        let partition = near.as_ref().map_or(Partition::NONE, NearField::partition);
        let scatterer = Arc::new(Scatterer::new(self.model, medium, sampled.area_m2.sqrt()).far(partition));
        let summation = Summation::of_clouds(scatterer, self.clouds, slot).behind(rough);
        Lit { summation, near: near.map(|near| (near, surroundings)) }
    }

    /// Digest of everything that the calibration depends on. The cloud's identity covers the scene, but what samples do not
    /// depend on.
    fn identity(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&version().to_le_bytes());
        hasher.update(&shards::identity(self.clouds));
        hasher.update(self.model.name().as_bytes());
        hasher.update(&[u8::from(self.normals == NormalKind::Shading)]);
        hasher.update(&self.walks.to_le_bytes());
        hasher.update(&self.seed.to_le_bytes());
        for medium in self.media {
            let numbers = medium.channels.iter().flat_map(|c| [c.sigma_a, c.sigma_s, c.asymmetry]);
            numbers.chain([medium.eta]).for_each(|x| _ = hasher.update(&x.to_le_bytes()));
        }
        for material in shards::materials(self.clouds) {
            hasher.update(&self.scene.roughness_digest(material.index).unwrap_or_default());
        }
        *hasher.finalize().as_bytes()
    }
}

/// Measures and fits the factors of all materials; `progress` is called with units of work that were done.
pub fn calibrate(task: &Task, progress: impl Fn(u64) + Sync) -> Result<Calibration, CalibrateError> {
    let is_translucent = |m: u16| shards::materials(task.clouds).iter().any(|s| s.index == m);
    let surroundings = Surroundings::new(task.scene, task.rays, task.normals, is_translucent);
    let materials = (task.portions().into_iter().enumerate())
        .map(|(slot, portion)| calibrate_material(task, &surroundings, slot, portion, &progress))
        .collect::<Result<_, _>>()?;
    Ok(Calibration {
        content: task.identity(),
        cloud: shards::identity(task.clouds),
        model: task.model.name().into(),
        walks: task.walks,
        seed: task.seed,
        materials,
    })
}

fn calibrate_material(
    task: &Task,
    surroundings: &Surroundings,
    slot: usize,
    portion: Portion,
    progress: &(impl Fn(u64) + Sync),
) -> Result<CalibratedMaterial, CalibrateError> {
    let (mesh, Portion { depth, walks }) = (&task.scene.mesh, portion);
    let (sampled, medium) = (&shards::materials(task.clouds)[slot], &task.media[slot]);
    let dark = || CalibrateError::Dark { material: sampled.name.clone() };
    let surface = Surface::new(mesh, sampled.index, task.normals, POINTS << depth, task.seed);
    let sites = surface.sites();
    let (patches, cell_of) = Patches::new(&sites, surface.area, depth);
    let areas = surface.cell_areas(mesh, &patches, sampled.index, task.seed);
    let is_translucent = |m: u16| shards::materials(task.clouds).iter().any(|s| s.index == m);
    let solid = Solid::new(mesh, task.rays, sampled.index, is_translucent).ok_or_else(dark)?;
    let rough = Roughness::new(&task.scene.materials[sampled.index as usize], medium.eta);
    let interface = rough.as_ref().map(Roughness::interface);
    let of_model = interface.as_ref().map(|interface| task.model.rough_entry(medium, interface));
    let of_walks = interface.as_ref().map(RoughEntry::new);
    let entries = Entries::new(task.clouds, slot, (medium.eta, of_walks.as_ref()));
    let walking = Walking {
        scene: task.scene,
        solid: &solid,
        entries: &entries,
        patches: &patches,
        eta: medium.eta,
        rough: rough.as_ref(),
        seed: task.seed,
        slot,
    };
    let open = |share: f64| CalibrateError::Open { material: sampled.name.clone(), share: 100.0 * share };
    if let Some(share) = walking.is_open(medium, walks) {
        return Err(open(share));
    }
    let sums = surface.light(&task.lit(slot, of_model.as_ref(), surroundings), &solid, task.seed, progress);
    let light = Light::new(&sums, &cell_of, &areas, medium.eta, entries.white());
    let smoothness = Smoothness::new(&patches, &sites, &cell_of);
    let views = Views::new(&surface.points, &sums, (&cell_of, patches.cells()), task.rays);
    let compared = Compared { views, medium, patches: &patches, smoothness, light, walking, walks };
    let mut log_factors = vec![[0.0f32; 3]; patches.count()];
    let mut gradients = vec![[[0.0f32; 3]; 3]; patches.count()];
    let mut lobe = match &interface {
        None => task.model.exit_lobe(medium),
        Some(interface) => task.model.rough_exit_lobe(medium, interface),
    };
    let mut errors = [ChannelErrors::default(); 3];
    for channel in 0..3 {
        let Some(found) = compared.channel(channel, progress).map_err(open)? else {
            continue;
        };
        (lobe[channel], errors[channel]) = (found.lobe, found.errors);
        for (gradient, slope) in gradients.iter_mut().zip(&found.slopes) {
            gradient[channel] = slope.as_vec3().to_array();
        }
        for (factor, fitted) in log_factors.iter_mut().zip(&found.log_factors) {
            factor[channel] = *fitted as f32;
        }
    }
    let surface = patches.facts(&log_factors, &gradients);
    Ok(CalibratedMaterial {
        name: sampled.name.clone(),
        index: sampled.index,
        medium: facts(medium),
        roughness: task.scene.roughness_digest(sampled.index),
        lobe,
        errors,
        surface,
    })
}

fn facts(medium: &Medium) -> MediumFacts {
    MediumFacts {
        name: medium.name.clone(),
        source: medium.source.clone(),
        sigma_a: medium.map(|c| c.sigma_a),
        sigma_s: medium.map(|c| c.sigma_s),
        g: medium.map(|c| c.asymmetry),
        eta: medium.eta,
    }
}
