//! What `compare` is asked on the command line.

use std::path::PathBuf;

use clap::Parser;
use compare::{Choice, Gate, Settings};

/// Compare two OpenEXR images.
///
/// Prints metrics per layer, then one line with the verdict. Exit code: 0 passed, 1 the images differ beyond a
/// gate or hold values that are not finite, 2 could not judge.
#[derive(Debug, Parser)]
#[command(version)]
pub(crate) struct Arguments {
    /// Image that is right
    pub(crate) reference: PathBuf,
    /// Image to judge
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
    /// Every bit must be equal; looks at all layers unless --layer says otherwise
    #[arg(long)]
    pub(crate) exact: bool,
    /// Layer that the gates look at (beauty is R, G and B), or `all` [default: beauty]
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// Let NaN and infinity pass; gates on their channel still fail
    #[arg(long)]
    pub(crate) allow_nonfinite: bool,
    /// Compare images of different clouds or scenes
    #[arg(long)]
    pub(crate) ignore_meta: bool,
    /// Write all metrics and gates as JSON
    #[arg(short = 'o', long, visible_alias = "output", value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) common: cli::Common,
}

impl Arguments {
    /// What is asked of the comparison.
    pub(crate) fn settings(&self) -> Settings {
        let gates = [
            self.max_bias.map(Gate::Bias),
            self.max_relmse.map(Gate::RelMse),
            self.max_rmse.map(Gate::Rmse),
            self.max_abs.map(Gate::Abs),
            self.max_outliers,
            self.exact.then_some(Gate::Exact),
        ];
        Settings {
            gates: gates.into_iter().flatten().collect(),
            choice: match self.layer.as_deref() {
                None => Choice::Default,
                Some("all") => Choice::All,
                Some(name) => Choice::Named(name.to_owned()),
            },
            allow_nonfinite: self.allow_nonfinite,
            ignore_meta: self.ignore_meta,
        }
    }
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
