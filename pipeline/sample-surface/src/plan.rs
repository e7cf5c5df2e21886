//! The surfaces and settings of a cloud, and the identity of the cloud that results.

use crate::choice::TriangleChoice;
use bssrdf::Medium;
use cli::{count, count_up};
use formats::cloud::{Options, version};
use scene::{MeshDefects, NormalKind, Scene, random};

/// Why a scene cannot be sampled.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    #[error("the scene has no light")]
    NoLight,
    #[error(transparent)]
    Lost(#[from] scene::LostVolumes),
    #[error("no surface to sample: all of them emit")]
    NoSurface,
    #[error("shares of {sum} in all; {wanted}")]
    ShareSum { sum: f64, wanted: &'static str },
    #[error("{} samples have an error of {error:.2e}; the target needs about {}, there is room for {}", count(*samples), count_up(*next as f64), count(*max_samples))]
    TooMany { samples: u64, error: f64, next: u64, max_samples: u64 },
    #[error("{} samples have a flux that is no finite number: are light intensities or sizes absurd?", count(*samples))]
    NotFinite { samples: u64 },
}

/// The settings of sampling.
#[derive(Clone, Debug)]
pub struct Settings {
    /// `K`: samples to draw over all sampled surfaces.
    pub samples: u64,
    /// The options that the cloud records.
    pub options: Options,
}

impl Settings {
    /// Seed of the random numbers of the shard.
    pub fn seed(&self) -> u64 {
        let Options { seed, shard, .. } = &self.options;
        random::shard_seed(*seed, shard.index, shard.count)
    }

    /// Normals with which cosines are taken.
    pub fn normals(&self) -> NormalKind {
        cli::normal_kind(self.options.normals)
    }
}

/// The surfaces to sample, by their materials.
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    /// Indices of the sampled materials, ascending.
    pub materials: Vec<u16>,
    /// Materials of these with the share of the samples that each takes; the others share the rest by the rule of
    /// choice.
    pub shares: Vec<(u16, f64)>,
}

impl Surfaces {
    /// The translucent surfaces of the scene's file, and whether it marks none, so that all that do not emit are taken.
    pub fn translucent(scene: &Scene) -> Result<(Surfaces, bool), SampleError> {
        let (materials, unmarked) = scene.translucent()?;
        if materials.is_empty() {
            return Err(SampleError::NoSurface);
        }
        Ok((Surfaces { materials, shares: Vec::new() }, unmarked))
    }

    /// Refuses shares that leave nothing for a sampled material, or some samples for none.
    fn check(&self) -> Result<(), SampleError> {
        let sum: f64 = self.shares.iter().map(|(_, share)| share).sum();
        let wanted = if self.shares.len() < self.materials.len() {
            (sum >= 1.0).then_some("less than 1 is needed, for the other materials")
        } else {
            (!self.shares.is_empty() && (sum - 1.0).abs() > 1e-9).then_some("1 is needed where every material has one")
        };
        wanted.map_or(Ok(()), |wanted| Err(SampleError::ShareSum { sum, wanted }))
    }
}

/// The surfaces to sample, and the identity of the cloud that results.
pub struct Plan {
    pub surfaces: Surfaces,
    pub geometry: [u8; 32],
    /// Defects of the sampled surfaces.
    pub defects: MeshDefects,
    /// Identity of everything that the samples depend on.
    pub content: [u8; 32],
}

impl Plan {
    /// Plans to sample these surfaces.
    pub fn new(scene: &Scene, settings: &Settings, surfaces: Surfaces) -> Result<Plan, SampleError> {
        if scene.lights().next().is_none() {
            return Err(SampleError::NoLight);
        }
        surfaces.check()?;
        let geometry = scene.geometry_digest();
        let mut hasher = blake3::Hasher::new();
        hasher.update(&version().to_le_bytes());
        hasher.update(&geometry);
        hasher.update(&scene.light_digest());
        hasher.update(&settings.samples.to_le_bytes());
        let options = serde_json::json!({ "options": &settings.options, "materials": &surfaces.materials });
        hasher.update(options.to_string().as_bytes());
        let defects = scene.defects(|material| surfaces.materials.binary_search(&material).is_ok());
        Ok(Plan { surfaces, geometry, defects, content: *hasher.finalize().as_bytes() })
    }

    /// The same plan, with an identity that also depends on the medium and the relative error in it that decide the
    /// number of samples.
    pub fn for_target(self, medium: &Medium, error: f64) -> Plan {
        // `trials` tells these clouds from older ones, whose number of samples was decided otherwise.
        let what = format!("trials {:?} {:?} {error}", medium.channels, medium.eta);
        let content = *blake3::Hasher::new().update(&self.content).update(what.as_bytes()).finalize().as_bytes();
        Plan { content, ..self }
    }

    /// Whether a material's surfaces are sampled.
    pub fn samples(&self, material: u16) -> bool {
        self.surfaces.materials.binary_search(&material).is_ok()
    }

    /// The triangles to choose from.
    pub fn choice(&self, scene: &Scene, settings: &Settings) -> TriangleChoice {
        let rule = settings.options.choice;
        TriangleChoice::new(&scene.mesh, rule, |material| self.samples(material), &self.surfaces.shares)
    }
}
