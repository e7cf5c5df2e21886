//! How the programs read a scene: sampling and gathering must agree on it.

use crate::{
    Common, Failure, Files,
    environment::{EnvironmentSource, parse_environment},
};
use clap::Args;
use formats::cloud::{LightUnit, Normals};
use scene::{DVec3, ImportOptions, MeshDefects, NormalKind, Scene, SceneError};
use std::path::Path;

/// Arguments about the scene.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// Light from all around, W/(m² sr): an equirectangular picture, its middle towards +X and its top towards +Y, or a
    /// constant radiance
    #[arg(long, value_name = "FILE.exr|FILE.hdr|R,G,B", value_parser = parse_environment)]
    pub environment: Option<EnvironmentSource>,
    /// Multiplies the environment's radiance
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_scale)]
    pub environment_scale: f64,
    /// Turns the environment about +Y, counter-clockwise seen from above
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = parse_finite, allow_hyphen_values = true)]
    pub environment_rotation: f64,
    /// Normals that cosines are taken with: interpolated from the vertices, or the triangle's as in the note
    #[arg(long, value_name = "KIND", default_value = "shading", default_value_if("note", "true", "geometric"))]
    pub normals: Normals,
    /// Work as the note does: triangles chosen alike, independent samples, the triangles' normals, and the roulette with
    /// its mean rule. Options given beside it win
    #[arg(long)]
    pub note: bool,
    /// Size of one unit of SCENE, m
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = parse_positive)]
    pub metres_per_unit: f64,
    /// Take the numbers of the file's lights as W, or as lm and divide them by 683 lm/W
    #[arg(long, value_name = "UNIT", default_value = "radiometric")]
    pub light_unit: LightUnit,
    /// The same of its emitting materials [default: that of --light-unit]
    #[arg(long, value_name = "UNIT")]
    pub emission_unit: Option<LightUnit>,
    /// Refuse a mesh whose translucent surfaces are open, flipped, inside out or there twice, instead of a warning
    #[arg(long)]
    pub strict: bool,
}

impl SceneArgs {
    /// Declares the files that these arguments name.
    pub fn declare(&self, files: &mut Files) -> Result<(), Failure> {
        match &self.environment {
            Some(EnvironmentSource::File(path)) => files.reads("--environment", path),
            _ => Ok(()),
        }
    }

    /// Reads the scene and its environment; prints the import's warnings.
    pub fn import(&self, path: &Path, common: &Common) -> Result<Scene, Failure> {
        let options = ImportOptions {
            metres_per_unit: self.metres_per_unit,
            light_unit: scene_unit(self.light_unit),
            emission_unit: scene_unit(self.emission_unit()),
        };
        let mut scene = Scene::import(path, &options).map_err(with_option)?;
        scene.warnings.iter().for_each(|w| common.warn(format_args!("{}: {w}", path.display())));
        let source = self.environment.as_ref().unwrap_or(&EnvironmentSource::Constant(DVec3::ZERO));
        scene.environment = source.read(self.environment_scale, self.environment_rotation, common)?;
        Ok(scene)
    }

    /// Warns of what is not honoured of the scene, of what is not used on the surfaces of the translucent materials, and of
    /// their faults, or refuses those if `--strict`.
    pub fn check_mesh(
        &self,
        scene: &mut Scene,
        translucent: impl Fn(u16) -> bool,
        defects: MeshDefects,
        path: &Path,
        common: &Common,
    ) -> Result<(), Failure> {
        let known = scene.warnings.len();
        scene.warn_of_unhonoured(&translucent);
        scene.warn_of_colors(&translucent);
        scene.warnings[known..].iter().for_each(|w| common.warn(format_args!("{}: {w}", path.display())));
        let line = format!("{}: the translucent surfaces have {defects}", path.display());
        match (defects.is_good(), self.strict) {
            (true, _) => {}
            (false, true) => return Err(Failure::usage(format!("{line}; repair the mesh, or leave out --strict"))),
            (false, false) => common.warn(format_args!("{line}; a medium wants a closed surface wound outwards")),
        }
        Ok(())
    }

    /// What the numbers of emitting materials are.
    pub fn emission_unit(&self) -> LightUnit {
        self.emission_unit.unwrap_or(self.light_unit)
    }

    pub fn normal_kind(&self) -> NormalKind {
        match self.normals {
            Normals::Shading => NormalKind::Shading,
            Normals::Geometric => NormalKind::Geometric,
        }
    }
}

/// The failure of an import, with the option that helps.
fn with_option(error: SceneError) -> Failure {
    let is_too_large = matches!(error, SceneError::TooLarge { .. });
    let failure = Failure::from(error);
    if is_too_large { Failure::usage(format!("{}; set --metres-per-unit", failure.message)) } else { failure }
}

fn scene_unit(unit: LightUnit) -> scene::LightUnit {
    match unit {
        LightUnit::Radiometric => scene::LightUnit::Radiometric,
        LightUnit::Photometric => scene::LightUnit::Photometric,
    }
}

fn parse_finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| "expected a finite number".into())
}

fn parse_scale(text: &str) -> Result<f64, String> {
    parse_finite(text).and_then(|x| if x >= 0.0 { Ok(x) } else { Err("expected a number, zero or more".into()) })
}

fn parse_positive(text: &str) -> Result<f64, String> {
    parse_finite(text).and_then(|x| if x > 0.0 { Ok(x) } else { Err("expected a number above zero".into()) })
}
