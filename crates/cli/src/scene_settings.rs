//! How a scene is read. Sampling and gathering must agree on it.

use crate::{
    Common, Failure, Files, SceneArgs,
    environment::{BuiltIn, EnvironmentSource},
};
use formats::cloud::{Normals, Options};
use scene::{ImportOptions, LostVolumes, MeshDefects, NormalKind, Placed, Scene, SceneError};
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
        let options = self.options(self.how.metres_per_unit);
        let mut scene = Scene::import(&self.path, &options).map_err(with_option)?;
        scene.units.note.iter().for_each(|note| common.say(format_args!("{}: {note}", self.path.display())));
        self.warn(&scene.warnings, common);
        let studio = self.studio(&scene).then_some(EnvironmentSource::BuiltIn(BuiltIn::Studio));
        if let Some(source) = self.how.environment.as_ref().or(studio.as_ref()) {
            scene.environment = source.read(self.how.environment_scale, self.rotation(&scene), common)?;
        }
        Ok(scene)
    }

    /// Whether the scene is lit by the built-in studio because neither its file nor the arguments have a lamp.
    fn studio(&self, scene: &Scene) -> bool {
        self.how.environment.is_none() && !scene.has_lamp()
    }

    /// Rotation of the environment, degrees: a studio that nobody asked for has its front where the file's first camera
    /// is.
    fn rotation(&self, scene: &Scene) -> f64 {
        let first = scene.cameras.first().filter(|_| self.studio(scene) && self.how.environment_rotation == 0.0);
        first.map_or(self.how.environment_rotation, |camera| Placed::turned_to(-camera.forward).round())
    }

    /// Says so if it is. The first program that reads a scene says it, and those that follow do not.
    pub fn say_light(&self, scene: &Scene, common: &Common) {
        if self.studio(scene) {
            let rotation = self.rotation(scene);
            let rotated = if rotation == 0.0 { "".into() } else { format!(" --environment-rotation {rotation}") };
            common.say(format_args!(
                "{}: no lamp in the file: it is lit by --environment studio{rotated} (others: sky, a picture, R,G,B; none: \
                 0,0,0)",
                self.path.display()
            ));
        }
    }

    /// The same settings with the size of a unit that gives the translucent surfaces of the scene their `--size`.
    /// `translucent` are those of the arguments or the cloud; where it gives none, those of the file count.
    pub fn sized(
        &self,
        translucent: impl FnOnce(&Scene) -> Result<Vec<u16>, Failure>,
    ) -> Result<SceneSettings, Failure> {
        let Some(size) = self.how.size else { return Ok(self.clone()) };
        let scene = Scene::import(&self.path, &self.options(1.0)).map_err(with_option)?;
        let materials = translucent(&scene)?;
        let (low, high) = scene.bounds_of(|material| materials.contains(&material));
        let extent = (high - low).max_element();
        let metres_per_unit = size / extent;
        if !(extent > 0.0 && metres_per_unit.is_finite() && metres_per_unit > 0.0) {
            let path = self.path.display();
            return Err(Failure::usage(format!("--size: the translucent surfaces of {path} have no extent")));
        }
        Ok(SceneSettings { path: self.path.clone(), how: SceneArgs { metres_per_unit, ..self.how.clone() } })
    }

    /// The same by the surfaces that are translucent by the scene's file.
    pub fn sized_by_file(&self) -> Result<SceneSettings, Failure> {
        let lost = |e: LostVolumes| Failure::usage(format!("{}: {e}", self.path.display()));
        self.sized(|scene| scene.translucent().map(|(materials, _)| materials).map_err(lost))
    }

    fn options(&self, metres_per_unit: f64) -> ImportOptions {
        ImportOptions {
            metres_per_unit,
            light_unit: self.how.light_unit.of_scene(),
            emission_unit: self.how.emission_unit.unwrap_or(self.how.light_unit).of_scene(),
            pose: self.how.pose(),
        }
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
        SceneError::TooLarge { .. } => "set --metres-per-unit or --size",
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
