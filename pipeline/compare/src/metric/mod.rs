//! What is measured, of one channel or of all channels of a layer together.

use serde::Serialize;

mod bias;
mod mse;
mod non_finite;
mod outliers;
mod rel_mse;

pub use outliers::Worst;
pub(crate) use outliers::{bitwise_differences, pixels_beyond};
pub use rel_mse::EPSILON;

/// Samples of both images that belong together; every plane of the same length.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Reference and test, per channel.
    pub planes: Vec<(&'a [f32], &'a [f32])>,
}

impl Samples<'_> {
    /// Reference and test, sample by sample: plane after plane, row after row.
    fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let planes = self.planes.iter();
        planes.flat_map(|(reference, test)| reference.iter().zip(*test)).map(|(r, t)| (f64::from(*r), f64::from(*t)))
    }

    /// Mean over all samples of a quantity of reference and test; zero without samples.
    fn mean(&self, quantity: impl Fn(f64, f64) -> f64) -> f64 {
        let count: usize = self.planes.iter().map(|(reference, _)| reference.len()).sum();
        self.pairs().map(|(r, t)| quantity(r, t)).sum::<f64>() / count.max(1) as f64
    }
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
    /// Absolute error that 99 of 100 samples do not exceed.
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
    let [mean_reference, mean_test] = bias::means(samples);
    let [nonfinite_reference, nonfinite_test] = non_finite::counts(samples);
    Metrics {
        mean_reference,
        mean_test,
        bias: bias::relative_difference(mean_reference, mean_test),
        mae: mse::mean_absolute_error(samples),
        rmse: mse::root_mean_square_error(samples),
        relmse: rel_mse::relative_mean_square_error(samples),
        p99: outliers::percentile_99(samples),
        max: outliers::worst(samples, width, window),
        nonfinite_reference,
        nonfinite_test,
    }
}
