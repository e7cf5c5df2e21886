//! The arguments of `compare`, and the settings that follow from them.

use std::num::{NonZeroU16, NonZeroUsize};
use std::path::PathBuf;

use clap::{Args, Parser};
use compare::heatmap::DEFAULT_MAX;
use compare::{Choice, LimitsError, Settings, read_limits};

use crate::gate_options::{self, GateOptions};

/// Compare two OpenEXR images.
///
/// Prints metrics per layer, then one line with the verdict. Exit code: 0 passed, 1 the images differ beyond a
/// gate or hold values that are not finite, 2 could not judge, 3 a difference for --diff-exr is beyond float32.
#[derive(Debug, Parser)]
#[command(version)]
pub(crate) struct Arguments {
    /// Image that is right, or a folder of them (--replicates)
    #[arg(value_parser = cli::file_name())]
    pub(crate) reference: PathBuf,
    /// Image to judge, or a folder of them
    #[arg(value_parser = cli::file_name())]
    pub(crate) test: PathBuf,
    #[command(flatten)]
    pub(crate) gates: GateOptions,
    /// JSON file of gates, each with its reason, that hold besides those of the command line (docs/compare.md)
    #[arg(long, value_name = "FILE", value_parser = cli::file_name())]
    pub(crate) limits: Option<PathBuf>,
    /// Layer that gates of the command line and --heatmap look at, or `all` [default: beauty (the channels without a layer
    /// that are the picture), for gates also its alpha]
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// Let NaN and infinity pass; gates on their channel still fail
    #[arg(long)]
    pub(crate) allow_nonfinite: bool,
    /// Measure FLIP, LDR and HDR: the difference as it is seen. Takes longer than all else
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
    /// Write the layer's absolute error as a picture with its scale
    #[arg(long, value_name = "FILE.png", value_parser = cli::file_name())]
    pub(crate) heatmap: Option<PathBuf>,
    /// Write a page with both images, their difference and all numbers; it needs nothing else. `compare --html-index
    /// FILE REPORT.html...` lists such pages, the worst first
    #[arg(long, value_name = "FILE", value_parser = cli::file_name())]
    pub(crate) html: Option<PathBuf>,
    /// Error at the end of the heatmap's scale, in units of the channel
    #[arg(long, value_name = "T", default_value_t = DEFAULT_MAX, value_parser = end_of_scale, requires = "heatmap")]
    pub(crate) heatmap_max: f64,
    /// Make the test image the reference, whatever the verdict, and append what changed to REFERENCE.log
    #[arg(long, requires = "reason")]
    pub(crate) accept: bool,
    /// Why the test image is accepted
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
    /// Both are folders of images, each from a cloud with a seed of its own (or what --summarise wrote): t-tests of
    /// few large means, which know that all pixels share the error of their cloud (docs/check.md)
    #[arg(long, conflicts_with_all = options_of_two_images())]
    pub(crate) replicates: bool,
    /// How many folders this run judges: their chance of a false alarm is 1e-3 together
    #[arg(long, value_name = "N", default_value = "1", requires = "replicates")]
    pub(crate) family: NonZeroU16,
    /// Write what --replicates needs of the folder REFERENCE, and its mean image, into the folder TEST, which holds no
    /// images
    #[arg(long, conflicts_with_all = options_of_two_images(), conflicts_with_all = ["replicates", "json"])]
    pub(crate) summarise: bool,
}

/// The options that are about two images.
fn options_of_two_images() -> impl Iterator<Item = &'static str> {
    let others = ["limits", "layer", "allow_nonfinite", "flip", "ignore_meta", "diff_exr", "heatmap", "html", "accept"];
    gate_options::names().chain(others)
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

    /// The number of threads for the reading and writing of images.
    pub(crate) fn threads(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.common.thread_count()).unwrap_or(NonZeroUsize::MIN)
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
