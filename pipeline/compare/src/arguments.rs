//! The arguments of `compare`, and the settings that follow from them.

use std::{num::NonZeroU16, path::PathBuf};

use clap::{Args, Parser};
use compare::heatmap::DEFAULT_MAX;
use compare::metric::GATES;
use compare::{Choice, LimitsError, Settings, read_limits};

use crate::gate_options::GateOptions;

/// Compare two OpenEXR images.
///
/// Prints the metrics of each layer, then one line with the verdict. Exit codes: 0 the images passed, 1 they differ by
/// more than a gate allows or hold values that are not finite, 2 they could not be judged, 3 a difference for
/// --diff-exr is beyond float32.
#[derive(Debug, Parser)]
#[command(version)]
pub(crate) struct Arguments {
    /// Reference image, or a folder of replicates (--replicates)
    #[arg(value_parser = cli::file_name())]
    pub(crate) reference: PathBuf,
    /// Image to judge, or a folder of replicates
    #[arg(value_parser = cli::file_name())]
    pub(crate) test: PathBuf,
    #[command(flatten)]
    pub(crate) gates: GateOptions,
    /// JSON file of gates, each with its reason, which hold in addition to those of the command line (docs/compare.md)
    #[arg(long, value_name = "FILE", value_parser = cli::file_name())]
    pub(crate) limits: Option<PathBuf>,
    /// Layer that --heatmap draws and the gates of the command line judge, or `all` [default: beauty (the channels
    /// without a layer that are the picture), for gates also its alpha]
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// Let NaN and infinity pass; gates on their channel still fail
    #[arg(long)]
    pub(crate) allow_nonfinite: bool,
    /// Measure LDR-FLIP and HDR-FLIP, the visible difference, which takes longer than all else
    #[arg(long)]
    pub(crate) flip: bool,
    /// Compare images of different clouds or scenes
    #[arg(long)]
    pub(crate) ignore_meta: bool,
    /// Write all metrics and gates as JSON
    #[arg(short = 'o', long, visible_alias = "output", value_name = "FILE", value_parser = cli::file_name())]
    pub(crate) json: Option<PathBuf>,
    /// Write test - reference of every channel, signed, as OpenEXR
    #[arg(long, value_name = "FILE.exr", value_parser = cli::file_name())]
    pub(crate) diff_exr: Option<PathBuf>,
    /// Write the absolute error of the layer as a picture with its scale
    #[arg(long, value_name = "FILE.png", value_parser = cli::file_name())]
    pub(crate) heatmap: Option<PathBuf>,
    /// Write a page with both images, their difference and all numbers, which needs no other file.
    /// `compare --html-index FILE REPORT.html...` lists such pages, the worst first
    #[arg(long, value_name = "FILE", value_parser = cli::file_name())]
    pub(crate) html: Option<PathBuf>,
    /// Error at the end of the heatmap's scale, in units of the channel
    #[arg(long, value_name = "T", default_value_t = DEFAULT_MAX, value_parser = end_of_scale, requires = "heatmap")]
    pub(crate) heatmap_max: f64,
    /// Replace the reference by the test image, whatever the verdict, and append what changed to REFERENCE.log
    #[arg(long, requires = "reason")]
    pub(crate) accept: bool,
    /// Reason for the acceptance
    #[arg(long, value_name = "TEXT", requires = "accept", value_parser = reason)]
    pub(crate) reason: Option<String>,
    #[command(flatten)]
    pub(crate) noise: NoiseArguments,
    #[command(flatten)]
    pub(crate) common: cli::Common,
}

/// The arguments that ask for folders instead of two images.
#[derive(Args, Debug)]
pub(crate) struct NoiseArguments {
    /// Test folders of images, each from a cloud with a seed of its own (REFERENCE may hold what --summarise wrote), by
    /// t-tests of a few means, because all pixels of an image share the error of its cloud (docs/check.md)
    #[arg(long, conflicts_with_all = options_of_two_images())]
    pub(crate) replicates: bool,
    /// Number of folders that this run judges; the probability of a false alarm in any of them is 1e-3
    #[arg(long, value_name = "N", default_value = "1", requires = "replicates")]
    pub(crate) family: NonZeroU16,
    /// Write a summary of the folder REFERENCE, which --replicates can read instead, and its mean image into the folder
    /// TEST, which must hold no images
    #[arg(long, conflicts_with_all = options_of_two_images(), conflicts_with_all = ["replicates", "json"])]
    pub(crate) summarise: bool,
}

/// The options that are about two images.
fn options_of_two_images() -> impl Iterator<Item = &'static str> {
    let others = ["limits", "layer", "allow_nonfinite", "flip", "ignore_meta", "diff_exr", "heatmap", "html", "accept"];
    GATES.iter().map(|kind| kind.name).chain(others)
}

impl Arguments {
    /// The settings of the comparison. The limits file is read.
    pub(crate) fn settings(&self) -> Result<Settings, LimitsError> {
        Ok(Settings {
            gates: self.gates.0.clone(),
            limits: self.limits.as_deref().map(read_limits).transpose()?.unwrap_or_default(),
            choice: Choice::new(self.layer.as_deref()),
            allow_nonfinite: self.allow_nonfinite,
            flip: self.flip,
            ignore_meta: self.ignore_meta,
        })
    }

    /// The path of the log of `--accept`.
    pub(crate) fn log(&self) -> PathBuf {
        let mut name = self.reference.clone().into_os_string();
        name.push(".log");
        name.into()
    }
}

fn end_of_scale(text: &str) -> Result<f64, String> {
    let max = text.parse::<f64>().ok().filter(|max| max.is_finite() && *max > 0.0);
    max.ok_or_else(|| "it must be a finite number above 0".to_owned())
}

fn reason(text: &str) -> Result<String, String> {
    if text.trim().is_empty() { Err("it is empty; give a reason".to_owned()) } else { Ok(text.to_owned()) }
}
