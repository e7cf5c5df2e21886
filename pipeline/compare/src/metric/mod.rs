//! What is measured: of one channel, of all channels of a layer together, and of the picture that they show.

use rayon::prelude::*;
use serde::Serialize;

mod bias;
mod convolve;
mod display;
mod elementary;
pub mod flip;
mod mse;
mod outliers;
mod picture;
mod psnr;
mod rel_mse;
mod select;
mod ssim;
mod tile;
mod totals;

use outliers::Found;
pub use outliers::Worst;
pub(crate) use outliers::{bitwise_differences, pixels_beyond};
pub(crate) use picture::measure as measure_picture;
pub use picture::{Picture, PictureMetrics};
pub use rel_mse::EPSILON;
use totals::Totals;

/// Samples of both images that belong together; every plane of the same length.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Reference and test, per channel.
    pub planes: Vec<(&'a [f32], &'a [f32])>,
}

/// The keys of the JSON report.
#[derive(Clone, Debug, Serialize)]
pub struct Metrics {
    /// Mean of the reference, in units of the channel, as all below without another unit.
    pub mean_reference: f64,
    /// Mean of the test image.
    pub mean_test: f64,
    /// Relative difference of the means, positive where the test image is brighter.
    pub bias: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Root of the mean squared error.
    pub rmse: f64,
    /// Mean of squared error over squared reference plus [`EPSILON`].
    pub relmse: f64,
    /// Absolute error that 99 of 100 samples do not exceed, rounded to float32.
    pub p99: f64,
    /// The largest absolute error.
    pub max: Worst,
    /// Samples of the reference that are NaN or infinite.
    pub nonfinite_reference: u64,
    /// Samples of the test image that are NaN or infinite.
    pub nonfinite_test: u64,
}

/// All metrics of these samples; `width` is that of the image, pixels, and `window` its top left pixel.
pub fn measure(samples: &Samples<'_>, width: usize, window: [i32; 2]) -> Metrics {
    measure_each(samples, width, window).0
}

/// As [`measure`], and the metrics of each plane by itself.
pub fn measure_each(samples: &Samples<'_>, width: usize, window: [i32; 2]) -> (Metrics, Vec<Metrics>) {
    let measured = |(reference, test)| (Totals::of(reference, test), outliers::histogram((reference, test)));
    let planes: Vec<_> = samples.planes.par_iter().copied().map(measured).collect();
    let metrics = |totals: &Totals, p99| metrics(totals, p99, Found::place(totals.worst, width, window));
    let each = samples.planes.iter().zip(&planes).map(|(plane, (totals, upper))| {
        metrics(totals, outliers::percentile_99(&Samples { planes: vec![*plane] }, upper))
    });
    let each: Vec<Metrics> = each.collect();
    let totals = planes.iter().fold(Totals::default(), |sum, (totals, _)| sum.and(totals));
    let upper = planes.into_iter().map(|(_, upper)| upper).reduce(|sum, upper| select::and(sum, &upper));
    let p99 = match each.as_slice() {
        [only] => only.p99,
        _ => outliers::percentile_99(samples, &upper.unwrap_or_default()),
    };
    (metrics(&totals, p99), each)
}

fn metrics(totals: &Totals, p99: f64, max: Worst) -> Metrics {
    let [mean_reference, mean_test] = [totals.mean(totals.reference), totals.mean(totals.test)];
    Metrics {
        mean_reference,
        mean_test,
        bias: bias::relative_difference(mean_reference, mean_test),
        mae: totals.mean(totals.absolute),
        rmse: totals.mean(totals.squared).sqrt(),
        relmse: totals.mean(totals.relative),
        p99,
        max,
        nonfinite_reference: totals.nonfinite_reference,
        nonfinite_test: totals.nonfinite_test,
    }
}
