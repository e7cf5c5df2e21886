//! Two images in, metrics and a verdict out.
//!
//! Nothing is padded, cropped, clamped or left out: a sample that is not a number makes the metrics of its
//! channel not a number, and no gate accepts that. Sums run over the samples in one order, in `f64`, so a
//! report never depends on the number of threads.

use formats::image::Image;

mod gate;
mod layer;
pub mod metric;
mod report;
mod structure;

pub use gate::{Gate, Judgement};
pub use layer::Layer;
pub use report::{ChannelReport, LayerReport, NonFinite, Report};
pub use structure::Mismatch;

/// What is asked of the comparison.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Limits to hold.
    pub gates: Vec<Gate>,
    /// Which layers the gates look at.
    pub choice: Choice,
    /// Values that are not finite do not fail by themselves; they still fail every gate on their channel.
    pub allow_nonfinite: bool,
    /// Images of different clouds or scenes may be compared.
    pub ignore_meta: bool,
}

/// Which layers the gates look at.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// The beauty layer; for the bitwise gate, which is about the file, all layers.
    #[default]
    Default,
    /// All layers.
    All,
    /// One layer.
    Named(String),
}

/// Measures every channel and layer, and judges by the gates.
pub fn compare(reference: &Image, test: &Image, settings: &Settings) -> Result<Report, Mismatch> {
    structure::check(reference, test, settings.ignore_meta)?;
    let layers = layer::layers(reference, test);
    gate::check_choice(&layers, settings)?;
    let mut report = report::measure(test, &layers);
    report.nonfinite.allowed = settings.allow_nonfinite;
    report.gates = gate::judge(&layers, &report, settings);
    report.pass = report.gates.iter().all(|gate| gate.ok);
    report.judged = gate::judged_layers(&layers, &settings.choice);
    Ok(report)
}
