//! The clouds of a run, checked: they belong together and to the scene, and are undamaged.

use crate::{Common, Failure, SceneSettings, stored_unit};
use formats::cloud::{Cloud, SampledMaterial, shards};
use scene::{MeshDefects, Scene};
use std::{fmt::Display, num::NonZeroUsize, path::PathBuf};

/// The open clouds of a request, at least one, which are gathered as one.
pub struct CloudFiles {
    paths: Vec<PathBuf>,
    /// In an order that does not depend on that of the arguments.
    pub clouds: Vec<Cloud>,
}

impl CloudFiles {
    /// Opens clouds, at least one; refuses those that do not belong together.
    pub fn open(paths: &[PathBuf]) -> Result<CloudFiles, Failure> {
        let open = |path: &PathBuf| Ok((path.clone(), Cloud::open(path)?));
        let files: Vec<(PathBuf, Cloud)> = paths.iter().map(open).collect::<Result<_, formats::Error>>()?;
        let (paths, clouds) = shards::join(files)?;
        Ok(CloudFiles { paths, clouds })
    }

    /// Defects of the sampled surfaces, as phase one found them.
    pub fn defects(&self) -> MeshDefects {
        MeshDefects::from_counts(|name| self.clouds[0].meta().mesh_faults.get(name).copied())
    }

    /// Checks every byte of each file. This is done before the work, because it takes a hundredth of the time of the
    /// smallest image, and damage found later would have cost a whole image.
    pub fn verify(&self, threads: NonZeroUsize) -> Result<(), formats::Error> {
        self.clouds.iter().zip(&self.paths).try_for_each(|(cloud, path)| cloud.verify_with(threads, path))
    }

    /// Refuses files that were changed since they were opened.
    pub fn check_unchanged(&self) -> Result<(), formats::Error> {
        self.clouds.iter().zip(&self.paths).try_for_each(|(cloud, path)| cloud.check_unchanged(path))
    }

    /// Refuses clouds that were sampled from another scene or with other units or normals; the message says what
    /// differs.
    pub fn check_fit(&self, scene: &Scene, settings: &SceneSettings, common: &Common) -> Result<(), Failure> {
        let options = &self.clouds[0].meta().options;
        if let Some(differs) = self.difference(scene, settings) {
            let (cloud, scene) = (self.paths[0].display(), settings.path.display());
            let message = format!("{cloud}: this cloud is not of {scene}: {differs}; sample the scene again");
            return Err(Failure::usage(message));
        }
        if settings.how.normals != options.normals {
            common.warn(format_args!("--normals is {}, the cloud's {}", settings.how.normals, options.normals));
        }
        Ok(())
    }

    /// The first difference between the scene and the first cloud, which represents all clouds.
    fn difference(&self, scene: &Scene, settings: &SceneSettings) -> Option<String> {
        let meta = self.clouds[0].meta();
        let options = &meta.options;
        let option = |name: &str, here: &dyn Display, there: &dyn Display| {
            let (here, there) = (here.to_string(), there.to_string());
            (here != there).then(|| format!("{name} is {here}, the cloud's {there}"))
        };
        let renamed =
            |m: &SampledMaterial| scene.materials.get(usize::from(m.index)).is_none_or(|own| own.name != m.name);
        option("--metres-per-unit", &settings.how.metres_per_unit, &options.metres_per_unit)
            .or_else(|| option("--light-unit", &stored_unit(scene.units.light), &options.light_unit))
            .or_else(|| option("--emission-unit", &stored_unit(scene.units.emission), &options.emission_unit))
            .or_else(|| pose_difference(&scene.pose, &options.pose))
            .or_else(|| (scene.geometry_digest() != meta.geometry).then(|| "its mesh or materials differ".into()))
            .or_else(|| meta.materials.iter().any(renamed).then(|| "its materials differ".into()))
            .or_else(|| (scene.light_digest() != meta.lights).then(|| "its lights differ".into()))
            .or_else(|| option("--environment", &scene.environment.identity(), &options.environment))
    }
}

/// The difference of two poses, with the options that set them.
fn pose_difference(here: &str, there: &str) -> Option<String> {
    let name = |pose: &str| if pose.is_empty() { "at rest".to_owned() } else { format!("posed, {pose}") };
    (here != there)
        .then(|| format!("the scene is {}, that of the cloud is {} (--animation, --time)", name(here), name(there)))
}
