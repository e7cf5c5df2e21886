//! The difference of two images: metrics, and a verdict by gates.
//!
//! [`compare()`] checks that two images have the same structure and meaning, measures every channel, every layer and
//! the picture that they show ([`metric`]), and judges them by the gates of the [`Settings`]. The [`Report`] can be
//! printed as a table or written as JSON; [`difference()`], [`heatmap`] and [`html`] draw it. [`replicates`] compares
//! two sets of images of independent clouds by statistical tests instead.
//!
//! ```
//! use compare::{Gate, Settings, compare};
//! use formats::image::{Channel, Image};
//!
//! let gray = |value: f32| {
//!     let channel = |name: &str| Channel { name: name.to_owned(), samples: vec![value; 12] };
//!     Image { width: 4, height: 3, channels: ["R", "G", "B"].map(channel).into(), ..Image::default() }
//! };
//! let settings = Settings { gates: vec![Gate::new("max-bias", 0.25, None)?], ..Settings::default() };
//! let report = compare(&gray(1.0), &gray(1.5), &settings).expect("the images have the same structure");
//! assert_eq!(report.layers[0].metrics.get("bias"), 0.5);
//! assert!(!report.pass);
//! assert_eq!(report.verdict("test.exr"), "FAIL max-bias 0.5 > 0.25 (beauty R)\n");
//! # Ok::<(), String>(())
//! ```
//!
//! Nothing is padded, cropped, clamped or left out: a NaN sample makes the metrics of its channel NaN, and no gate accepts
//! that. Sums are made in `f64` over pieces of a fixed size that are added in a fixed order, so that a report does not depend
//! on the number of threads. Only the metrics of the picture are computed from displayed values; their files say how.

use formats::image::Image;
use meaning::Meaning;

mod difference;
pub mod distribution;
mod gate;
pub mod heatmap;
pub mod html;
mod judge;
mod layer;
mod limits;
mod meaning;
pub mod metric;
pub mod replicates;
mod report;
mod settings;
mod structure;

pub use difference::{TooFar, difference};
pub use gate::{Gate, Judgement};
pub use layer::{Choice, Layer};
pub use limits::{Limit, LimitsError, read_limits};
pub use meaning::Difference;
pub use report::{ChannelReport, LayerReport, NonFinite, Report};
pub use settings::Settings;
pub use structure::{Input, Mismatch};

/// Measures every channel and layer, and judges by the gates.
pub fn compare(reference: &Image, test: &Image, settings: &Settings) -> Result<Report, Mismatch> {
    let inputs = structure::check(reference, test, settings.ignore_meta)?;
    let layers = layer::layers(reference, test);
    judge::check_choice(&layers, settings)?;
    let picture = metric::measure_picture(reference, test, settings.wants_flip());
    let mut report = report::measure(test, &layers, picture);
    report.inputs = inputs;
    report.nonfinite.allowed = settings.allow_nonfinite;
    report.gates = judge::judge(&layers, &report, settings);
    report.pass = report.gates.iter().all(|gate| gate.ok);
    report.judged = judge::judged_layers(&layers, &settings.choice);
    report.unjudged = judge::unjudged_layers(&layers, &report, settings);
    report.notes = Meaning::of(test).notes(&Meaning::of(reference));
    Ok(report)
}
