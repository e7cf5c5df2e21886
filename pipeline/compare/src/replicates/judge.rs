//! The tests themselves.
//!
//! Student's two-sample t-test with pooled variance: if nothing has changed, both sides scatter alike, and the many
//! replicates of the reference say how much. Welch's test would rest on the few of the test side, whose Student tail
//! asks for three times the deviation at the corrected level. If the scatter has grown, that is found by itself: by
//! the noise that the images claim (one-sided t-test), and by the ratio of the variances (Fisher, one-sided).

use serde::Serialize;

use super::report::NoiseReport;
use super::summary::{Summarised, moments};
use super::{Kind, ReplicateError, Replicates, Summary};
use crate::distribution::{fisher_quantile, fisher_upper, student_quantile, student_two_sided, student_upper};

/// Chance that the same program fails, over all folders of a run together.
pub const FALSE_ALARM_RATE: f64 = 1e-3;
/// Chance that a bias of the size called visible is found.
const POWER: f64 = 0.9;

/// What became of one statistic. Differences are relative to the reference.
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// Layer, part of it, and channel.
    pub name: String,
    /// What it measures.
    pub kind: Kind,
    /// Mean of the reference (the geometric one where logarithms are compared).
    pub reference: f64,
    /// Mean of the test images.
    pub test: f64,
    /// Positive where the test images have more.
    pub difference: f64,
    /// Student's statistic.
    pub t: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// Chance of such a t, or one farther out, if nothing has changed.
    pub p: f64,
    /// The smallest bias that is found nine times in ten.
    pub visible: f64,
    /// Variance of the test images over that of the reference, where it is tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scatter: Option<Scatter>,
    /// Whether it passed.
    pub ok: bool,
}

/// The ratio of the variances.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Scatter {
    /// Test over reference.
    pub ratio: f64,
    /// Chance of such a ratio, or a larger one.
    pub p: f64,
    /// The growth that is found nine times in ten.
    pub visible: f64,
}

/// The level of one of `tests` tests in each of `family` folders, such that all hold together (Šidák).
pub fn corrected_level(tests: usize, family: usize) -> f64 {
    -((-FALSE_ALARM_RATE).ln_1p() / (tests * family) as f64).exp_m1()
}

/// Compares the replicates with the reference; `family` folders are judged in this run.
pub fn judge(reference: &Summary, test: &Replicates, family: usize) -> Result<NoiseReport, ReplicateError> {
    reference.fits(test)?;
    let tested: Vec<&Summarised> = reference.statistics.iter().filter(|s| s.left_out.is_none()).collect();
    let tests = tested.len() + tested.iter().filter(|statistic| tests_scatter(statistic)).count();
    let level = corrected_level(tests, family);
    let counts = (test.all.len() as f64, reference.count() as f64);
    let mut judged = Vec::with_capacity(tested.len());
    for statistic in tested {
        judged.push(one(statistic, &values(reference, statistic, test)?, counts, level));
    }
    let not_finite = test.all.iter().map(|replicate| replicate.not_finite).sum();
    Ok(NoiseReport::new(reference, test.all.len(), family, tests, level, judged, not_finite))
}

fn tests_scatter(statistic: &Summarised) -> bool {
    statistic.kind == Kind::Scatter && statistic.variance > 0.0
}

fn values(reference: &Summary, wanted: &Summarised, test: &Replicates) -> Result<Vec<f64>, ReplicateError> {
    let value = |statistics: &[super::statistic::Statistic]| {
        let value = statistics.iter().find(|statistic| statistic.name == wanted.name)?.value;
        Some(if wanted.logarithm { value.ln() } else { value })
    };
    let values: Option<Vec<f64>> = test.all.iter().map(|replicate| value(&replicate.statistics)).collect();
    values.ok_or_else(|| ReplicateError::Summary {
        path: reference.folder.join(super::SUMMARY),
        what: format!("statistics: `{}` is unknown to this version", wanted.name),
    })
}

/// `counts`: of the test and of the reference.
fn one(reference: &Summarised, values: &[f64], (n, m): (f64, f64), level: f64) -> Judged {
    let (mean, variance) = moments(values);
    let freedom = n + m - 2.0;
    let pooled = ((n - 1.0) * variance + (m - 1.0) * reference.variance) / freedom;
    let error = (pooled * (1.0 / n + 1.0 / m)).sqrt();
    let (t, p) = significance(reference, mean - reference.mean, error, freedom);
    let sided = if reference.kind == Kind::Noise { level } else { 0.5 * level };
    let limit = student_quantile(sided, freedom);
    // The t of a true difference scatters more than Student's: by how well the error is known (noncentral t).
    let spread = (1.0 + 0.5 * limit * limit / freedom).sqrt();
    let visible = (limit + student_quantile(1.0 - POWER, freedom) * spread) * error;
    let scatter = tests_scatter(reference).then(|| {
        let ratio = variance / reference.variance;
        let visible = fisher_quantile(level, n - 1.0, m - 1.0) / fisher_quantile(POWER, n - 1.0, m - 1.0);
        Scatter { ratio, p: fisher_upper(ratio, n - 1.0, m - 1.0), visible }
    });
    Judged {
        name: reference.name.clone(),
        kind: reference.kind,
        reference: linear(reference, reference.mean),
        test: linear(reference, mean),
        difference: relative(reference, mean - reference.mean),
        t,
        freedom,
        p,
        visible: relative(reference, visible),
        scatter,
        // Both written so that what is no number fails.
        ok: p >= level && scatter.is_none_or(|scatter| scatter.p >= level),
    }
}

/// t and its chance. What never varies must be equal, to the rounding of float32 that images have.
fn significance(reference: &Summarised, difference: f64, error: f64, freedom: f64) -> (f64, f64) {
    let scale = if reference.logarithm { 1.0 } else { reference.mean.abs() };
    let rounding = f64::from(f32::EPSILON) * scale;
    if error <= rounding {
        return if difference.abs() <= rounding { (0.0, 1.0) } else { (f64::INFINITY.copysign(difference), 0.0) };
    }
    let t = difference / error;
    // Comparisons with what is no number are false, so the tail of an NaN would look like one half.
    if t.is_nan() {
        return (t, t);
    }
    (t, if reference.kind == Kind::Noise { student_upper(t, freedom) } else { student_two_sided(t, freedom) })
}

fn linear(statistic: &Summarised, value: f64) -> f64 {
    if statistic.logarithm { value.exp() } else { value }
}

fn relative(statistic: &Summarised, difference: f64) -> f64 {
    match statistic.logarithm {
        true => difference.exp_m1(),
        // Guards 0/0: nothing has not changed.
        false if difference == 0.0 => 0.0,
        false => difference / statistic.mean.abs(),
    }
}
