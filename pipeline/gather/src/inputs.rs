//! The files that an image is made from: clouds and their scene, and whether they belong together.

use crate::{arguments::Arguments, image_jobs::Shot};
use cli::{Failure, Files, is_file};
use formats::cloud::Cloud;
use gather::shards::{self, JoinError};
use scene::{MeshDefects, Scene};
use std::{
    num::NonZeroUsize,
    path::{Path, PathBuf},
};

/// At least one CLOUD, and SCENE.
pub fn paths(arguments: &Arguments) -> Result<(&[PathBuf], &Path), Failure> {
    match arguments.files.split_last() {
        Some((scene, clouds)) if !clouds.is_empty() => Ok((clouds, scene)),
        _ => Err(Failure::usage("give CLOUD and then SCENE; see --help")),
    }
}

/// Reads SCENE; says so if it was left out after several clouds.
pub fn import(arguments: &Arguments, scene_path: &Path) -> Result<Scene, Failure> {
    arguments.scene_args.import(scene_path, &arguments.common).map_err(|failure| match Cloud::open(scene_path) {
        Ok(_) => Failure::usage(format!("{}: this is a cloud; give SCENE after all clouds", scene_path.display())),
        Err(_) => failure,
    })
}

/// The files that the run reads, as far as the arguments name them.
pub fn declare(arguments: &Arguments) -> Result<Files, Failure> {
    let mut files = Files::default();
    let (clouds, scene) = paths(arguments)?;
    clouds.iter().try_for_each(|path| files.reads("CLOUD", path))?;
    files.reads("SCENE", scene)?;
    arguments.scene_args.declare(&mut files)?;
    arguments.view.iter().try_for_each(|path| files.reads("--view", path))?;
    // The name of a material may hold an equals sign: what follows any of them may be the file.
    let after = |argument: &'_ str| -> Vec<PathBuf> {
        let starts = argument.match_indices('=').map(|(k, _)| k + 1);
        starts.chain([0]).map(|start| &argument[start..]).filter(|name| is_file(name)).map(PathBuf::from).collect()
    };
    for path in arguments.medium.iter().flat_map(|argument| after(argument)) {
        files.reads("--medium", &path)?;
    }
    Ok(files)
}

/// Refuses outputs that cannot be written, that replace an input, or that are the same file, before any work is done.
pub fn declare_outputs(files: &mut Files, arguments: &Arguments, shots: &[Shot], images: &Path) -> Result<(), Failure> {
    let outputs = [
        ("--output", Some(images)),
        ("--preview", arguments.preview.as_deref()),
        ("--stats", arguments.stats.as_deref()),
    ];
    for (option, path) in outputs.into_iter().filter_map(|(option, path)| Some((option, path?))) {
        shots.iter().try_for_each(|shot| files.writes(option, &shot.file(path)))?;
    }
    Ok(())
}

/// One cloud or more, open, and their files.
pub struct CloudFiles {
    paths: Vec<PathBuf>,
    clouds: Vec<Cloud>,
}

impl CloudFiles {
    /// Opens clouds that belong together, at least one.
    pub fn open(paths: &[PathBuf]) -> Result<CloudFiles, Failure> {
        let open = |path: &PathBuf| Ok((path.clone(), Cloud::open(path)?));
        let files: Vec<(PathBuf, Cloud)> = paths.iter().map(open).collect::<Result<_, formats::Error>>()?;
        let (paths, clouds) = shards::join(files).map_err(|e: JoinError| Failure::usage(e.to_string()))?;
        Ok(CloudFiles { paths, clouds })
    }

    /// In an order of their own.
    pub fn clouds(&self) -> &[Cloud] {
        &self.clouds
    }

    /// Of the sampled surfaces, as phase one found them.
    pub fn defects(&self) -> MeshDefects {
        MeshDefects::from_counts(|name| self.clouds[0].meta().mesh_faults.get(name).copied())
    }

    /// Checks all of each file, by so many threads. Before the work: it takes a hundredth of what the smallest picture
    /// does, and damage that is found later was paid for.
    pub fn verify(&self, threads: NonZeroUsize) -> Result<(), formats::Error> {
        self.clouds.iter().zip(&self.paths).try_for_each(|(cloud, path)| cloud.verify_with(threads, path))
    }

    /// Refuses files that were written to since they were opened.
    pub fn check_unchanged(&self) -> Result<(), formats::Error> {
        self.clouds.iter().zip(&self.paths).try_for_each(|(cloud, path)| cloud.check_unchanged(path))
    }

    /// Refuses clouds that were sampled from something else, and says what differs.
    pub fn check_fit(&self, scene: &Scene, scene_path: &Path, arguments: &Arguments) -> Result<(), Failure> {
        // The others are as the first.
        let (meta, cloud_path) = (self.clouds[0].meta(), &self.paths[0]);
        let (here, there) = (arguments.scene_args.metres_per_unit, meta.options.metres_per_unit);
        let unit = arguments.scene_args.light_unit;
        let emission_unit = arguments.scene_args.emission_unit();
        let differs = if here != there {
            format!("--metres-per-unit is {here}, the cloud's {there}")
        } else if unit != meta.options.light_unit {
            format!("--light-unit is {unit}, the cloud's {}", meta.options.light_unit)
        } else if emission_unit != meta.options.emission_unit {
            format!("--emission-unit is {emission_unit}, the cloud's {}", meta.options.emission_unit)
        } else if scene.geometry_digest() != meta.geometry {
            "its mesh or materials differ".into()
        } else if meta
            .materials
            .iter()
            .any(|m| scene.materials.get(m.index as usize).is_none_or(|own| own.name != m.name))
        {
            "its materials differ".into()
        } else if scene.light_digest() != meta.lights {
            "its lights differ".into()
        } else if scene.environment.identity() != meta.options.environment {
            format!("--environment is {}, the cloud's {}", scene.environment.identity(), meta.options.environment)
        } else {
            let normals = arguments.scene_args.normals;
            if normals != meta.options.normals {
                arguments.common.warn(format_args!("--normals is {normals}, the cloud's {}", meta.options.normals));
            }
            return Ok(());
        };
        Err(Failure::usage(format!(
            "{}: this cloud is not of {}: {differs}; sample the scene again",
            cloud_path.display(),
            scene_path.display()
        )))
    }
}
