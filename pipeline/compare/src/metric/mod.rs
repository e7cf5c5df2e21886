//! The metrics of a channel, of all channels of a layer together, and of the picture that they show.
//!
//! A metric is a file of this folder and a row in one of the tables below, and in [`GATES`] if it can be limited. The
//! report, the table for people, the limits files, the options of the program and the HTML page take the rest from
//! there.

mod bias;
mod channel;
mod convolve;
mod displayed;
mod elementary;
pub mod flip;
mod gate_kind;
mod mse;
mod outliers;
mod picture;
mod picture_metrics;
mod psnr;
mod rel_mse;
mod select;
mod ssim;
mod tile;
mod totals;
mod worst;

pub use channel::{ChannelMetric, Metrics};
use displayed::DisplayedMetric;
use formats::image::Image;
pub use gate_kind::{GateKind, GateValue};
pub(crate) use outliers::bitwise_differences;
pub use picture::{Pair, Picture};
pub use picture_metrics::PictureMetrics;
pub use rel_mse::EPSILON;
pub use worst::Worst;

/// Makes the table of metrics and the function that computes their terms in one pass from one list.
macro_rules! channel_metrics {
    ($($metric:expr),* $(,)?) => {
        /// The metrics of a channel that are functions of means, in the order of the report.
        pub static CHANNEL_METRICS: [ChannelMetric; [$($metric.key),*].len()] = [$($metric),*];

        /// The terms of [`CHANNEL_METRICS`], in the same order.
        #[inline(always)]
        fn terms(reference: f64, test: f64) -> [f64; CHANNEL_METRICS.len()] {
            [$(($metric.term)(reference, test)),*]
        }
    };
}

channel_metrics![bias::METRIC, mse::MAE, mse::RMSE, rel_mse::METRIC];

/// The metrics of the picture as a screen displays it, in the order of the report.
static DISPLAYED_METRICS: [DisplayedMetric; 2] = [psnr::METRIC, ssim::METRIC];

/// Every kind of gate, in the order of the options.
pub static GATES: [GateKind; 7] =
    [bias::GATE, rel_mse::GATE, mse::GATE, outliers::ABS, outliers::OUTLIERS, flip::GATE, outliers::EXACT];

/// Measures all samples together, and each pair of planes by itself. The image is `width` pixels wide, `window` is its
/// top left pixel.
pub fn measure_each(samples: &[Pair<'_>], width: usize, window: [i32; 2]) -> (Metrics, Vec<Metrics>) {
    channel::measure_each(&CHANNEL_METRICS, terms, samples, width, window)
}

/// Measures the picture. FLIP takes some ten times as long as the rest, and is left out unless it is asked for.
pub(crate) fn measure_picture(reference: &Image, test: &Image, with_flip: bool) -> PictureMetrics {
    picture_metrics::measure(&DISPLAYED_METRICS, reference, test, with_flip)
}
