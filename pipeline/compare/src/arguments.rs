//! What `compare` is asked on the command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Parser;
use compare::heatmap::DEFAULT_MAX;
use compare::{Choice, Gate, LimitsError, Settings, read_limits};

use crate::noise_mode::NoiseArguments;

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
    /// Largest relative difference of the means, of every channel (0.01 is one per cent)
    #[arg(long, value_name = "R", value_parser = limit)]
    pub(crate) max_bias: Option<f64>,
    /// Largest mean of (test - reference)^2 / (reference^2 + 0.01), of every channel
    #[arg(long, value_name = "R", value_parser = limit)]
    pub(crate) max_relmse: Option<f64>,
    /// Largest root of the mean squared error, of every channel, in units of the channel
    #[arg(long, value_name = "R", value_parser = limit)]
    pub(crate) max_rmse: Option<f64>,
    /// Largest absolute error of any sample, in units of the channel
    #[arg(long, value_name = "R", value_parser = limit)]
    pub(crate) max_abs: Option<f64>,
    /// At most N pixels may differ by more than T, in units of the channel
    #[arg(long, value_name = "N@T", value_parser = outliers)]
    pub(crate) max_outliers: Option<Gate>,
    /// Largest mean of HDR-FLIP of R, G and B, 0 to 1; never the only limit
    #[arg(long, value_name = "R", value_parser = limit)]
    pub(crate) max_flip: Option<f64>,
    /// Every bit must be equal; looks at all layers unless --layer says otherwise
    #[arg(long)]
    pub(crate) exact: bool,
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

impl Arguments {
    /// What is asked of the comparison; reads the limits file.
    pub(crate) fn settings(&self) -> Result<Settings, LimitsError> {
        let gates = [
            self.max_bias.map(Gate::Bias),
            self.max_relmse.map(Gate::RelMse),
            self.max_rmse.map(Gate::Rmse),
            self.max_abs.map(Gate::Abs),
            self.max_outliers,
            self.max_flip.map(Gate::Flip),
            self.exact.then_some(Gate::Exact),
        ];
        Ok(Settings {
            gates: gates.into_iter().flatten().collect(),
            limits: self.limits.as_deref().map(read_limits).transpose()?.unwrap_or_default(),
            choice: Choice::new(self.layer.as_deref()),
            allow_nonfinite: self.allow_nonfinite,
            flip: self.flip,
            ignore_meta: self.ignore_meta,
        })
    }

    /// Threads for the reading and writing of images.
    pub(crate) fn threads(&self) -> NonZeroUsize {
        self.common.thread_count()
    }

    /// Where `--accept` tells what it did.
    pub(crate) fn log(&self) -> PathBuf {
        let mut name = self.reference.clone().into_os_string();
        name.push(".log");
        name.into()
    }
}

fn end_of_scale(text: &str) -> Result<f64, String> {
    limit(text).ok().filter(|max| *max > 0.0).ok_or_else(|| "not a finite number above 0".to_owned())
}

fn reason(text: &str) -> Result<String, String> {
    if text.trim().is_empty() { Err("it is empty; say why".to_owned()) } else { Ok(text.to_owned()) }
}

fn limit(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(limit) if limit.is_finite() && limit >= 0.0 => Ok(limit),
        _ => Err("not a finite number of at least 0".to_owned()),
    }
}

fn outliers(text: &str) -> Result<Gate, String> {
    let parse = || {
        let (count, threshold) = text.split_once('@')?;
        Some(Gate::Outliers { count: count.parse().ok()?, threshold: limit(threshold).ok()? })
    };
    parse()
        .ok_or_else(|| "not N@T with a whole number of pixels N and an error T of at least 0, as in 3@0.5".to_owned())
}
