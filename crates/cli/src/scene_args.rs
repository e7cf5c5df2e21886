//! Arguments about the scene, which `sample-surface`, `calibrate` and `gather` have in common.

use crate::{
    environment::{EnvironmentSource, parse_environment},
    values::{one_of, parse_finite, parse_non_negative, parse_positive},
};
use clap::Args;
use formats::cloud::{LightUnit, Normals};

/// Arguments about the scene, as the user typed them.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// Radiance of the environment, W/(m² sr): an equirectangular picture, its middle towards +X and its top towards
    /// +Y, or a constant
    #[arg(long, value_name = "FILE.exr|FILE.hdr|R,G,B", value_parser = parse_environment)]
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
    /// Take the numbers of the file's lights as W, or as lm and divide them by 683 lm/W
    #[arg(long, value_name = "UNIT", default_value = "radiometric",
        value_parser = one_of(LightUnit::ALL, LightUnit::name))]
    pub light_unit: LightUnit,
    /// The same for the file's emitting materials [default: that of --light-unit]
    #[arg(long, value_name = "UNIT", value_parser = one_of(LightUnit::ALL, LightUnit::name))]
    pub emission_unit: Option<LightUnit>,
    /// Refuse a mesh whose translucent surfaces are open, flipped, inside out or duplicated, instead of a warning
    #[arg(long)]
    pub strict: bool,
}
