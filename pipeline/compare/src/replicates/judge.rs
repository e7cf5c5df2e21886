//! The statistical tests.
//!
//! Student's two-sample t-test uses the pooled variance: if nothing has changed, both sides have the same variance, and
//! the many replicates of the reference estimate it well. Welch's test would rest on the few replicates of the test
//! side, and at the corrected level its Student tail would need three times the deviation. A larger variance is found
//! by tests of its own: a one-sided t-test of the noise that the images claim, and Fisher's one-sided test of the ratio
//! of the variances.

use super::error::ReplicateError;
use super::folder::Replicates;
use super::report::{Judged, NoiseReport, SCHEMA, Scatter};
use super::statistic::{Kind, Statistic};
use super::summary::{SUMMARY, Summarised, Summary, moments};
use crate::distribution::{fisher_quantile, fisher_upper, student_quantile, student_two_sided, student_upper};

/// The probability that an unchanged program fails, over all folders of a run together.
pub const FALSE_ALARM_RATE: f64 = 1e-3;
/// The probability that a bias of the size called visible is found.
const POWER: f64 = 0.9;

/// The significance level of each of `tests` tests in each of `family` folders for which all together have the false
/// alarm rate (Šidák 1967).
pub fn corrected_level(tests: usize, family: usize) -> f64 {
    -((-FALSE_ALARM_RATE).ln_1p() / (tests * family) as f64).exp_m1()
}

/// Tests the replicates against the reference; `family` folders are judged in this run.
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
    let left_out = reference.statistics.iter().filter_map(|s| Some([s.name.clone(), s.left_out.clone()?]));
    Ok(NoiseReport {
        schema: SCHEMA,
        reference_replicates: reference.count(),
        test_replicates: test.all.len(),
        false_alarm_rate: FALSE_ALARM_RATE,
        family,
        tests,
        level,
        not_finite,
        pass: not_finite == 0 && !judged.is_empty() && judged.iter().all(|judged| judged.ok),
        statistics: judged,
        left_out: left_out.collect(),
    })
}

/// Whether the variance of a statistic is tested too.
fn tests_scatter(statistic: &Summarised) -> bool {
    statistic.kind == Kind::Scatter && statistic.variance > 0.0
}

/// The values of a statistic over the test replicates.
fn values(reference: &Summary, wanted: &Summarised, test: &Replicates) -> Result<Vec<f64>, ReplicateError> {
    let value = |statistics: &[Statistic]| {
        let value = statistics.iter().find(|statistic| statistic.name == wanted.name)?.value;
        Some(if wanted.logarithm { value.ln() } else { value })
    };
    let values: Option<Vec<f64>> = test.all.iter().map(|replicate| value(&replicate.statistics)).collect();
    let what = || format!("the statistic `{}` is unknown to this version; summarise the images again", wanted.name);
    values.ok_or_else(|| ReplicateError::invalid(&reference.folder.join(SUMMARY), what()))
}

/// Tests one statistic of `n` test replicates against that of `m` reference replicates.
fn one(reference: &Summarised, values: &[f64], (n, m): (f64, f64), level: f64) -> Judged {
    let (mean, variance) = moments(values);
    let freedom = n + m - 2.0;
    let pooled = ((n - 1.0) * variance + (m - 1.0) * reference.variance) / freedom;
    let error = (pooled * (1.0 / n + 1.0 / m)).sqrt();
    let (t, p) = significance(reference, mean - reference.mean, error, freedom);
    let sided = if reference.kind == Kind::Noise { level } else { 0.5 * level };
    let limit = student_quantile(sided, freedom);
    // The statistic of a true difference has the noncentral t distribution, whose spread includes that of the estimated
    // error.
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
        // Both comparisons are written so that NaN fails.
        ok: p >= level && scatter.is_none_or(|scatter| scatter.p >= level),
    }
}

/// The statistic t and its p-value. A statistic that never varies must be equal up to the rounding of float32.
fn significance(reference: &Summarised, difference: f64, error: f64, freedom: f64) -> (f64, f64) {
    let scale = if reference.logarithm { 1.0 } else { reference.mean.abs() };
    let rounding = f64::from(f32::EPSILON) * scale;
    if error <= rounding {
        return if difference.abs() <= rounding { (0.0, 1.0) } else { (f64::INFINITY.copysign(difference), 0.0) };
    }
    let t = difference / error;
    // Guards NaN: comparisons with it are false, so that its tail would look like one half.
    if t.is_nan() {
        return (t, t);
    }
    (t, if reference.kind == Kind::Noise { student_upper(t, freedom) } else { student_two_sided(t, freedom) })
}

/// A value without the logarithm that the statistic may have.
fn linear(statistic: &Summarised, value: f64) -> f64 {
    if statistic.logarithm { value.exp() } else { value }
}

/// A difference relative to the mean of the reference.
fn relative(statistic: &Summarised, difference: f64) -> f64 {
    match statistic.logarithm {
        true => difference.exp_m1(),
        // Guards 0/0: a mean of zero has not changed.
        false if difference == 0.0 => 0.0,
        false => difference / statistic.mean.abs(),
    }
}
