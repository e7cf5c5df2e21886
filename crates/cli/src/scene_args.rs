//! Arguments about the scene, which `sample-surface`, `calibrate` and `gather` have in common.

use crate::{
    environment::{EnvironmentSource, parse_environment},
    units::UnitChoice,
    values::{one_of, parse_finite, parse_non_negative, parse_positive},
};
use clap::Args;
use formats::cloud::Normals;
use scene::Pose;

/// Arguments about the scene, as the user typed them.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// Radiance of the environment, W/(m² sr): an equirectangular picture, its middle towards +X and its top towards
    /// +Y, or a constant; studio and sky are built in [default: studio for a scene without light, none otherwise]
    #[arg(long, value_name = "studio|sky|FILE.exr|FILE.hdr|R,G,B", value_parser = parse_environment)]
    pub environment: Option<EnvironmentSource>,
    /// Factor on the environment's radiance
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_non_negative)]
    pub environment_scale: f64,
    /// Rotation of the environment about +Y, counter-clockwise seen from above
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = parse_finite, allow_hyphen_values = true)]
    pub environment_rotation: f64,
    /// Normals with which cosines are taken: interpolated from the vertices, or the triangle's as in the note
    #[arg(long, value_name = "KIND", default_value = "shading", default_value_if("note", "true", "geometric"),
        value_parser = one_of(Normals::ALL, Normals::name))]
    pub normals: Normals,
    /// Use the note's settings: uniform choice of triangles, independent samples, geometric normals, and the roulette
    /// with its mean rule. Options given beside it win
    #[arg(long)]
    pub note: bool,
    /// Size of one unit of SCENE, m
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = parse_positive)]
    pub metres_per_unit: f64,
    /// Largest extent of the translucent surfaces along X, Y or Z, m: the whole scene is scaled, positions of lights
    /// included
    #[arg(long, value_name = "M", value_parser = parse_positive, conflicts_with = "metres_per_unit")]
    pub size: Option<f64>,
    /// Take the numbers of the file's lights as W, or as lm and divide them by 683 lm/W, or as the program that wrote
    /// the file means them
    #[arg(long, value_name = "UNIT", default_value = "auto", value_parser = one_of(UnitChoice::ALL, UnitChoice::name))]
    pub light_unit: UnitChoice,
    /// The same for the file's emitting materials [default: that of --light-unit]
    #[arg(long, value_name = "UNIT", value_parser = one_of(UnitChoice::ALL, UnitChoice::name))]
    pub emission_unit: Option<UnitChoice>,
    /// Pose the scene at this time of an animation, s [default: at rest, as the file has it]
    #[arg(long, value_name = "SECONDS", value_parser = parse_non_negative)]
    pub time: Option<f64>,
    /// Pose the scene by this animation, at --time or else at its start [default for --time: the only one]
    #[arg(long, value_name = "NAME")]
    pub animation: Option<String>,
    /// Refuse a mesh whose translucent surfaces are open, flipped, inside out or duplicated, instead of a warning
    #[arg(long)]
    pub strict: bool,
}

impl SceneArgs {
    /// The pose that was asked for.
    pub fn pose(&self) -> Option<Pose> {
        let is_posed = self.time.is_some() || self.animation.is_some();
        is_posed.then(|| Pose { animation: self.animation.clone(), seconds: self.time.unwrap_or(0.0) })
    }

    /// The arguments that differ from the defaults, as they are typed.
    pub fn words(&self) -> Vec<String> {
        let environment = self.environment.as_ref().map(|source| source.to_string());
        let unless = |value: f64, default: f64| (value != default).then(|| value.to_string());
        let options = [
            ("--environment", environment),
            ("--environment-scale", unless(self.environment_scale, 1.0)),
            ("--environment-rotation", unless(self.environment_rotation, 0.0)),
            ("--normals", (self.normals != Normals::Shading).then(|| self.normals.to_string())),
            ("--size", self.size.map(|size| size.to_string())),
            ("--metres-per-unit", unless(self.metres_per_unit, 1.0).filter(|_| self.size.is_none())),
            ("--light-unit", (self.light_unit != UnitChoice::Auto).then(|| self.light_unit.name().to_owned())),
            ("--emission-unit", self.emission_unit.map(|unit| unit.name().to_owned())),
            ("--time", self.time.map(|seconds| seconds.to_string())),
            ("--animation", self.animation.clone()),
        ];
        let given = options.into_iter().filter_map(|(option, value)| Some([option.to_owned(), value?]));
        given.flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        scene: SceneArgs,
    }

    /// What is typed is said, and nothing else; it gives the same arguments again.
    #[test]
    fn arguments_are_said_as_they_are_typed() {
        let typed = ["--environment", "1,2,0.5", "--environment-rotation", "-30", "--normals", "geometric"];
        let more = ["--metres-per-unit", "0.001", "--light-unit", "photometric", "--emission-unit", "radiometric"];
        let parse = |words: &[String]| Program::parse_from([&["program".to_owned()], words].concat()).scene.words();
        let posed = ["--time", "1.25", "--animation", "walk on"];
        let all: Vec<String> = typed.iter().chain(&more).chain(&posed).map(|word| word.to_string()).collect();
        assert_eq!(parse(&all), all);
        let sized = ["--environment", "studio", "--size", "0.1"].map(String::from);
        assert_eq!(parse(&sized), sized);
        assert!(parse(&[]).is_empty());
    }
}
