//! How a scene is read. Sampling and gathering must agree on it.

use crate::{Common, Failure, Files, SceneArgs, environment::EnvironmentSource};
use formats::cloud::{Normals, Options};
use scene::{ImportOptions, MeshDefects, NormalKind, Scene, SceneError};
use std::path::PathBuf;

/// The file of a scene, and how to read it.
#[derive(Clone, Debug)]
pub struct SceneSettings {
    pub path: PathBuf,
    pub how: SceneArgs,
}

impl SceneSettings {
    /// The same settings with the units of a cloud, where the arguments leave them open.
    pub fn with_units_of(&self, options: &Options) -> SceneSettings {
        let mut settings = self.clone();
        let emission_unit = self.how.emission_unit.unwrap_or(self.how.light_unit).or(options.emission_unit);
        settings.how.light_unit = self.how.light_unit.or(options.light_unit);
        settings.how.emission_unit = Some(emission_unit);
        settings
    }

    /// Declares the files that the arguments name. Those that the scene's file names are known once it is read.
    pub fn declare(&self, files: &mut Files) -> Result<(), Failure> {
        files.reads("SCENE", &self.path)?;
        match &self.how.environment {
            Some(EnvironmentSource::File(path)) => files.reads("--environment", path),
            _ => Ok(()),
        }
    }

    /// Reads the scene and its environment, and prints the warnings of the import.
    pub fn import(&self, common: &Common) -> Result<Scene, Failure> {
        let options = ImportOptions {
            metres_per_unit: self.how.metres_per_unit,
            light_unit: self.how.light_unit.of_scene(),
            emission_unit: self.how.emission_unit.unwrap_or(self.how.light_unit).of_scene(),
            pose: self.how.pose(),
        };
        let mut scene = Scene::import(&self.path, &options).map_err(with_option)?;
        scene.units.note.iter().for_each(|note| common.say(format_args!("{}: {note}", self.path.display())));
        self.warn(&scene.warnings, common);
        if let Some(source) = &self.how.environment {
            scene.environment = source.read(self.how.environment_scale, self.how.environment_rotation, common)?;
        }
        Ok(scene)
    }

    /// Warns of what the scene's file asks for and the programs do not honor, of colors that the surfaces of
    /// translucent materials ignore, and of defects of those surfaces; with `--strict`, refuses the defects.
    pub fn check_mesh(
        &self,
        scene: &mut Scene,
        translucent: impl Fn(u16) -> bool,
        defects: MeshDefects,
        common: &Common,
    ) -> Result<(), Failure> {
        scene.check_textures(&translucent)?;
        let known = scene.warnings.len();
        scene.warn_of_unhonoured(&translucent);
        scene.warn_of_colors(&translucent);
        self.warn(&scene.warnings[known..], common);
        if defects.is_good() {
            return Ok(());
        }
        let line = format!("{}: the translucent surfaces have {defects}", self.path.display());
        if self.how.strict {
            return Err(Failure::usage(format!("{line}; repair the mesh, or leave out --strict")));
        }
        common.warn(format_args!("{line}; a medium needs a closed surface whose triangles are wound outwards"));
        Ok(())
    }

    fn warn(&self, warnings: &[String], common: &Common) {
        warnings.iter().for_each(|warning| common.warn(format_args!("{}: {warning}", self.path.display())));
    }
}

/// The failure of an import, with the option that helps.
fn with_option(error: SceneError) -> Failure {
    let option = match error {
        SceneError::TooLarge { .. } => "set --metres-per-unit",
        SceneError::Pose { .. } => "set --animation NAME and --time SECONDS",
        _ => return Failure::from(error),
    };
    Failure::usage(format!("{}; {option}", Failure::from(error).message))
}

/// The normals of the same name in the terms of meshes.
pub fn normal_kind(normals: Normals) -> NormalKind {
    match normals {
        Normals::Shading => NormalKind::Shading,
        Normals::Geometric => NormalKind::Geometric,
    }
}
