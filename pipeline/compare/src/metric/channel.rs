//! The metrics of one channel, or of all channels of a layer together.

use rayon::prelude::*;
use serde::{Serialize, Serializer};

use super::picture::Pair;
use super::select;
use super::totals::{Terms, Totals};
use super::worst::{self, Found, Worst};

/// A metric that is a function of a mean over the samples.
#[derive(Debug)]
pub struct ChannelMetric {
    /// Its key in the JSON report.
    pub key: &'static str,
    /// The heading of its column in the table.
    pub heading: &'static str,
    /// Whether the table shows a plus sign.
    pub signed: bool,
    /// The term that is averaged over the samples: a function of reference and test image.
    pub(super) term: fn(f64, f64) -> f64,
    /// The metric as a function of the means.
    pub(super) value: fn(&Means) -> f64,
}

/// Means over the samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means {
    /// The mean of the reference.
    pub reference: f64,
    /// The mean of the test image.
    pub test: f64,
    /// The mean of the metric's own term.
    pub term: f64,
}

/// The measured values. They are in units of the channel unless a metric says otherwise. The names are the keys of the
/// JSON report.
#[derive(Clone, Debug, Serialize)]
pub struct Metrics {
    /// The mean of the reference.
    pub mean_reference: f64,
    /// The mean of the test image.
    pub mean_test: f64,
    /// The metrics that are functions of means, with their keys, in the order of their table.
    #[serde(flatten, serialize_with = "as_map")]
    pub values: Vec<(&'static str, f64)>,
    /// The 99th percentile of the absolute error, rounded to float32.
    pub p99: f64,
    /// The largest absolute error.
    pub max: Worst,
    /// The number of samples of the reference that are NaN or infinite.
    pub nonfinite_reference: u64,
    /// The number of samples of the test image that are NaN or infinite.
    pub nonfinite_test: u64,
}

impl Metrics {
    /// A metric of the table by its key in the report, or the largest error, `max`. The value of an unknown key is NaN,
    /// which no gate accepts.
    pub fn get(&self, key: &str) -> f64 {
        match key {
            "max" => self.max.error,
            key => self.values.iter().find(|(known, _)| *known == key).map_or(f64::NAN, |(_, value)| *value),
        }
    }
}

/// Writes pairs of key and value as a map.
pub(super) fn as_map<V: Serialize, S: Serializer>(
    values: &[(&'static str, V)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(values.iter().map(|(key, value)| (key, value)))
}

/// Measures all samples together, and each plane by itself. The image is `width` pixels wide, `window` is its top left
/// pixel. `terms` computes the terms of `metrics`, in the same order.
pub(super) fn measure_each<const N: usize>(
    metrics: &[ChannelMetric; N],
    terms: impl Terms<N>,
    samples: &[Pair<'_>],
    width: usize,
    window: [i32; 2],
) -> (Metrics, Vec<Metrics>) {
    let measured = |(reference, test)| (Totals::of(reference, test, terms), worst::histogram((reference, test)));
    let planes: Vec<_> = samples.par_iter().copied().map(measured).collect();
    let finish = |totals: &Totals<N>, p99| finish(metrics, totals, p99, Found::in_window(totals.worst, width, window));
    let one = |(plane, (totals, upper)): (&Pair<'_>, &_)| finish(totals, worst::percentile_99(&[*plane], upper));
    let each: Vec<Metrics> = samples.iter().zip(&planes).map(one).collect();
    let totals = planes.iter().fold(Totals::default(), |sum, (totals, _)| sum.and(totals));
    let upper = planes.into_iter().map(|(_, upper)| upper).reduce(|sum, upper| select::and(sum, &upper));
    let p99 = match each.as_slice() {
        [only] => only.p99,
        _ => worst::percentile_99(samples, &upper.unwrap_or_default()),
    };
    (finish(&totals, p99), each)
}

fn finish<const N: usize>(metrics: &[ChannelMetric; N], totals: &Totals<N>, p99: f64, max: Worst) -> Metrics {
    let [mean_reference, mean_test] = [totals.mean(totals.reference), totals.mean(totals.test)];
    let value = |(metric, sum): (&ChannelMetric, &f64)| {
        let means = Means { reference: mean_reference, test: mean_test, term: totals.mean(*sum) };
        (metric.key, (metric.value)(&means))
    };
    Metrics {
        mean_reference,
        mean_test,
        values: metrics.iter().zip(&totals.terms).map(value).collect(),
        p99,
        max,
        nonfinite_reference: totals.nonfinite_reference,
        nonfinite_test: totals.nonfinite_test,
    }
}
