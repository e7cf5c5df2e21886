//! Two images in, metrics and a verdict out.
//!
//! Nothing is padded, cropped, clamped or left out: a sample that is not a number makes the metrics of its
//! channel not a number, and no gate accepts that. Sums are in `f64`, of pieces of a fixed size that are added in
//! one order, so a report never depends on the number of threads. Metrics of the beauty layer as a picture alone are
//! of displayed values; their files say how.

use formats::image::Image;
use meaning::Meaning;

mod difference;
pub mod distribution;
mod gate;
pub mod heatmap;
pub mod html;
mod layer;
mod limits;
mod meaning;
pub mod metric;
pub mod replicates;
mod report;
mod structure;

pub use difference::{TooFar, difference};
pub use gate::{Gate, Judgement};
pub use layer::Layer;
pub use limits::{Limit, LimitsError, read_limits};
pub use report::{ChannelReport, LayerReport, NonFinite, Report};
pub use structure::{Input, Mismatch};

/// What is asked of the comparison.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Limits to hold, on the chosen layers.
    pub gates: Vec<Gate>,
    /// Limits to hold besides, each on layers of its own.
    pub limits: Vec<Limit>,
    /// Which layers the gates look at.
    pub choice: Choice,
    /// Values that are not finite do not fail by themselves; they still fail every gate on their channel.
    pub allow_nonfinite: bool,
    /// FLIP is measured, which takes longer than all else; a gate on it asks for it too.
    pub flip: bool,
    /// Images of different clouds or scenes may be compared.
    pub ignore_meta: bool,
}

impl Settings {
    /// FLIP never judges by itself: its mean misses single bright pixels and a small bias of the whole picture.
    pub fn judges_by_flip_alone(&self) -> bool {
        gate::flip_alone(self)
    }
}

/// Which layers the gates look at.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// The beauty layer and its alpha; for the bitwise gate, which is about the file, all layers.
    #[default]
    Default,
    /// All layers.
    All,
    /// One layer.
    Named(String),
}

impl Choice {
    /// A layer by its name, or `all`. `beauty` by its name is a layer like any other.
    pub fn new(name: Option<&str>) -> Choice {
        match name {
            None => Choice::Default,
            Some("all") => Choice::All,
            Some(name) => Choice::Named(name.to_owned()),
        }
    }
}

/// Measures every channel and layer, and judges by the gates.
pub fn compare(reference: &Image, test: &Image, settings: &Settings) -> Result<Report, Mismatch> {
    let inputs = structure::check(reference, test, settings.ignore_meta)?;
    let layers = layer::layers(reference, test);
    gate::check_choice(&layers, settings)?;
    let mut report = report::measure(test, &layers);
    report.inputs = inputs;
    report.picture = metric::measure_picture(reference, test, settings.flip || gate::any_flip(settings));
    report.nonfinite.allowed = settings.allow_nonfinite;
    report.gates = gate::judge(&layers, &report, settings);
    report.pass = report.gates.iter().all(|gate| gate.ok);
    report.judged = gate::judged_layers(&layers, &settings.choice);
    report.unjudged = gate::unjudged_layers(&layers, &report, settings);
    report.notes = Meaning::of(test).notes(&Meaning::of(reference));
    Ok(report)
}
