//! The command line: what the user typed.

use bssrdf::Model;
use clap::Parser;
use cli::{Common, SceneArgs, file_name, one_of, parse_count, parse_relative_error};
use std::path::PathBuf;

/// Measures by random walks what a BSSRDF gets wrong on the shape of a scene, for all cameras, and how to mend it.
///
/// Lengths are metres, radiance W/(m² sr); media are in the unit that their file states.
#[derive(Parser)]
#[command(version, override_usage = "calibrate [OPTIONS] CLOUD... SCENE --output FILE.calibration")]
pub struct Arguments {
    /// Clouds of sample-surface: one, or shards and seeds of one scene, as for gather; and last the scene
    #[arg(value_name = "CLOUD... SCENE", required = true, value_parser = file_name())]
    pub files: Vec<PathBuf>,
    /// Calibration to write, for `gather --calibration`
    #[arg(short, long, value_name = "FILE.calibration", value_parser = file_name())]
    pub output: PathBuf,
    /// Medium, by built-in name or from a file, of one material, by name or index:N, or of all materials (repeatable)
    /// [default: the media that SCENE gives its materials]
    #[arg(long, value_name = "[MATERIAL=]NAME|FILE.json")]
    pub medium: Vec<String>,
    /// BSSRDF model that is calibrated
    #[arg(long, value_name = "MODEL", default_value = Model::ALL[0].name(),
        value_parser = one_of(&Model::ALL, Model::name))]
    pub bssrdf: Model,
    /// Random walks of each color channel, over all materials: 300k, 1M [default: 300k]
    #[arg(long, value_name = "N", value_parser = parse_walks, conflicts_with = "target_error")]
    pub walks: Option<u64>,
    /// Follow more and more walks until the light that leaves is estimated to be off by this relative error, as root mean
    /// square over the surface, or until more walks no longer help
    #[arg(long, value_name = "X", value_parser = parse_relative_error)]
    pub target_error: Option<f64>,
    #[command(flatten)]
    pub scene_args: SceneArgs,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    pub stats: Option<PathBuf>,
    #[command(flatten)]
    pub common: Common,
}

/// Most walks of a material and channel.
const MAX_WALKS: u64 = 1 << 36;

fn parse_walks(text: &str) -> Result<u64, String> {
    match parse_count(text)? {
        count @ 2..=MAX_WALKS => Ok(count),
        _ => Err(format!("expected 2 to {MAX_WALKS} walks")),
    }
}
