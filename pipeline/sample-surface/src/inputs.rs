//! The inputs of a cloud: the files that are read, and the data derived from them.

use crate::{
    arguments::SAMPLES_LIMIT,
    settings::Request,
    surfaces::{failure, surfaces},
};
use bssrdf::Medium;
use cli::{Failure, Files, Need, count, is_file, read_medium};
use sample_surface::{Goal, Plan, Settings};
use scene::Scene;
use std::path::Path;

/// Memory of a sample while it is drawn, ordered and written: record, entry, tile, nodes and their moments, bytes.
const BYTES_PER_SAMPLE: u64 = 112;

/// Size of a sample in the file, with its part of the tree, bytes.
const BYTES_PER_STORED_SAMPLE: u64 = 40;

/// Memory that a byte of a scene's file becomes, with the tree of its triangles: 36 bytes a triangle become 500.
const BYTES_PER_FILE_BYTE: u64 = 16;

/// A scene, and how to sample it.
pub struct Inputs {
    pub scene: Scene,
    pub settings: Settings,
    pub plan: Plan,
    /// The medium and the error that decide the number of samples.
    target: Option<(Medium, f64)>,
}

impl Inputs {
    /// Reads the inputs of a cloud. Refuses impossible requests before any sample is drawn.
    pub fn read(request: &Request) -> Result<Inputs, Failure> {
        let common = &request.common;
        let mut files = declare(request)?;
        check_memory(request)?;
        let medium = |(name, error): &(String, f64)| Ok::<_, Failure>((read_medium(name)?, *error));
        let target = request.target.as_ref().map(medium).transpose()?;
        let mut scene = request.scene.import(common)?;
        scene.files.iter().try_for_each(|path| files.reads("a file that SCENE names", path))?;
        request.scene.say_light(&scene, common);
        let settings = request.settings(&scene);
        let surfaces = surfaces(request, &scene)?;
        let plan = Plan::new(&scene, &settings, surfaces).map_err(|e| failure(request, &e))?;
        request.scene.check_mesh(&mut scene, |material| plan.samples(material), plan.defects, common)?;
        let plan = match &target {
            Some((medium, error)) => plan.for_target(medium, *error),
            None => plan,
        };
        Ok(Inputs { scene, settings, plan, target })
    }

    /// The error to reach by the number of samples, if there is one.
    pub fn goal(&self) -> Option<Goal<'_>> {
        let room = cli::available_memory_bytes().map_or(u64::MAX, |bytes| bytes / BYTES_PER_SAMPLE);
        let (medium, error) = self.target.as_ref()?;
        Some(Goal { medium, error: *error, max_samples: room.min(SAMPLES_LIMIT - 1) })
    }
}

/// Declares all files that the arguments name. Those that the scene's file names are known once it is read.
fn declare(request: &Request) -> Result<Files, Failure> {
    let mut files = Files::default();
    request.scene.declare(&mut files)?;
    if let Some((medium, _)) = request.target.as_ref().filter(|(name, _)| is_file(name)) {
        files.reads("--for-medium", Path::new(medium))?;
    }
    files.writes("--output", &request.output)?;
    request.ply.iter().try_for_each(|path| files.writes("--ply", path))?;
    request.stats.iter().try_for_each(|path| files.writes("--stats", path))?;
    Ok(files)
}

/// Refuses, before any work is done, samples and scene files that would not fit into memory.
fn check_memory(request: &Request) -> Result<(), Failure> {
    let samples = request.samples;
    let file = std::fs::metadata(&request.scene.path).map_or(0, |meta| meta.len());
    let need = Need {
        held: samples.saturating_mul(BYTES_PER_SAMPLE).saturating_add(file.saturating_mul(BYTES_PER_FILE_BYTE)),
        mapped: samples.saturating_mul(BYTES_PER_STORED_SAMPLE),
    };
    cli::require_memory(&format!("--samples: a cloud of {} samples", count(samples)), need, "draw fewer")
}
