//! Whether an image meets its target error after a round of paths.

use cli::count_up;
use formats::cloud::{Cloud, Pattern, shards};
use gather::{Input, Passes, Settings, errors::Errors, estimator::Estimator};
use sums::confidence::Estimate;

/// The state after a pass.
pub struct Round<'a> {
    pub target: f64,
    pub input: &'a Input<'a>,
    /// Paths per pixel after this pass and before it.
    pub paths: u32,
    pub done: u32,
    /// The error before this pass, and the degrees of freedom of its estimate.
    pub before: Estimate,
    pub passes: &'a Passes<'a>,
}

/// The decision after a pass.
pub enum Verdict {
    /// The target is met.
    Met,
    /// More paths are needed.
    More,
    /// More paths would not help, for this reason.
    OutOfReach(String),
}

impl Round<'_> {
    pub fn judge(&self, errors: Option<&Errors>, settings: &Settings) -> Verdict {
        let estimate = errors.and_then(Errors::estimate);
        let (Some(errors), Some(estimate)) = (errors, estimate) else {
            let paths = self.paths;
            return if paths < UNKNOWN_PATHS {
                Verdict::More
            } else {
                Verdict::OutOfReach(format!(
                    "no two of {paths} paths per pixel differ, so their error is unknown: either it is 0, or the objects are \
                     too small for these paths to meet; --spp without --target-error renders more"
                ))
            };
        };
        if settings.reference {
            // No cloud limits the error.
            return if estimate.safe() <= self.target { Verdict::Met } else { Verdict::More };
        }
        let lit_error = errors.scattered * self.lit_count_error();
        if estimate.safe().max(lit_error) <= self.target {
            return Verdict::Met;
        }
        if lit_error > CLOUD_LIMITS * self.target {
            let (lit, percent) = (self.lit(), 100.0 * lit_error);
            let why =
                format!("the cloud alone may have an error of {percent:.2} %, as only {lit} of its samples are lit");
            return Verdict::OutOfReach(format!("{why}: {}", self.advice(lit_error)));
        }
        self.judge_cloud(errors, &estimate, settings)
    }

    /// Whether the cloud's own error exceeds its share of the target.
    fn judge_cloud(&self, errors: &Errors, estimate: &Estimate, settings: &Settings) -> Verdict {
        let clouds = self.input.clouds.len();
        // Until the paths of a pixel have used all shards, part of the difference between its halves comes from the
        // choice of shards, and vanishes with more paths.
        if clouds > 1 && (self.done as usize) < 2 * clouds {
            return Verdict::More;
        }
        // In an image of few pixels the two errors may differ by chance; the cloud's must exceed three standard
        // deviations.
        let [paths, total] = [errors.paths, errors.total].map(|error| error * error);
        let significant = total > variance_quantile(errors.paths_freedom) * paths;
        let irreducible = if self.done == 0 {
            0.0
        } else {
            let [before, now] = [self.done, self.paths].map(|paths| self.passes.expected_variance(paths));
            let grown = before / now;
            let freedom = estimate.freedom.min(self.before.freedom);
            irreducible_error(errors.total, self.before.error, grown, freedom, settings.estimator)
        };
        let error = if significant { errors.cloud.max(irreducible) } else { irreducible };
        if error > CLOUD_LIMITS * self.target {
            let percent = 100.0 * error;
            return Verdict::OutOfReach(format!(
                "the cloud alone has an error of {percent:.2} %: {}",
                self.advice(error)
            ));
        }
        // Where the error of the paths is small, the cloud's error is known from its two halves alone.
        let cloud = Estimate { error: errors.cloud, freedom: errors.cloud_freedom };
        if errors.paths < 0.5 * cloud.error && cloud.safe() > self.target {
            let (percent, within) = (100.0 * cloud.error, 100.0 * cloud.within());
            return Verdict::OutOfReach(format!(
                "the cloud alone has an error of about {percent:.2} %, but in so few pixels the difference of its halves is \
                 hardly more than one value: the error is below {within:.2} % with 95 % confidence; {}",
                self.advice(cloud.safe())
            ));
        }
        Verdict::More
    }

    /// The paths per pixel of the next round: as many as should do, and at most twice as many. The shards of several
    /// clouds are picked evenly where rounds double.
    pub fn next(&self, errors: Option<&Errors>) -> u32 {
        let excess = errors.and_then(Errors::estimate).map_or(f64::INFINITY, |error| error.safe() / self.target);
        let double = self.paths.saturating_mul(2);
        if self.input.clouds.len() > 1 {
            return double;
        }
        // The variance of a pixel falls at least as fast as the number of its paths grows.
        let allowed = self.passes.expected_variance(self.paths) / (excess * excess);
        // Shares are rounded to pairs of paths, one for each half of the cloud.
        let step = if self.passes.shares() { 1 } else { 2 };
        let (mut few, mut enough) = (self.paths / step, double / step);
        while few + 1 < enough {
            let middle = few.midpoint(enough);
            let is_enough = self.passes.expected_variance(step * middle) <= allowed;
            *(if is_enough { &mut enough } else { &mut few }) = middle;
        }
        step * enough
    }

    /// The number of lit samples.
    fn lit(&self) -> u64 {
        (0..shards::materials(self.input.clouds).len()).map(|slot| shards::count(self.input.clouds, slot)).sum()
    }

    /// The relative error of the light as estimated from the number of lit samples alone. They are as well spread as
    /// all samples, so the error falls faster for stratified ones. It matters where few are lit, and the halves of the
    /// cloud may agree by chance. It is 0 for a cloud without lit samples.
    fn lit_count_error(&self) -> f64 {
        let stratified = |cloud: &Cloud| cloud.meta().options.pattern == Pattern::Stratified;
        let lit = self.lit().max(1) as f64;
        let independent = lit.powf(-0.5);
        match self.lit() {
            0 => 0.0,
            _ if self.input.clouds.iter().all(stratified) => independent.min(2.0 * lit.powf(-0.75)),
            _ => independent,
        }
    }

    /// Advice on a cloud of this error.
    fn advice(&self, error: f64) -> String {
        // The error of well-spread samples falls at least as fast as their number to the power −3/4.
        let drawn = shards::drawn(self.input.clouds) as f64;
        let needed = drawn * (error / (CLOUD_LIMITS * self.target)).powf(4.0 / 3.0);
        if self.input.clouds.len() == 1 {
            format!("sample it again with --samples {}", count_up(needed))
        } else {
            format!("add shards until there are about {} samples in all", count_up(needed))
        }
    }
}

/// The part of the error that more paths do not reduce, given that the error was `before` and is `now` with `grown` times
/// the paths. The variance of paths falls as their number (that of well-spread paths falls faster); the error that the
/// cut adds stays, because the cut's target is per pixel, whatever the number of paths. If nothing stays, the variance of
/// `before` is `grown` times that of `now`, and their difference has a standard deviation of twice that over the root of
/// the degrees of freedom. Up to three standard deviations are attributed to chance.
fn irreducible_error(now: f64, before: f64, grown: f64, freedom: f64, estimator: Estimator) -> f64 {
    let added = estimator.accuracy().unwrap_or(0.0);
    let chance = 3.0 * 2.0 * grown / freedom.sqrt();
    let stays = ((grown - chance) * now * now - before * before) / (grown - 1.0);
    (stays - added * added).max(0.0).sqrt()
}

/// The multiple of the true variance that an estimate with so many degrees of freedom exceeds in 1 of 1000 cases
/// (Wilson and Hilferty 1931).
fn variance_quantile(freedom: f64) -> f64 {
    let a = 2.0 / (9.0 * freedom);
    (1.0 - a + 3.09 * a.sqrt()).powi(3)
}

/// The cloud's own error may be at most this share of the target: its square and that of what the cut may add, 0.75 of
/// the target, are the target's.
const CLOUD_LIMITS: f64 = 0.66;

/// Paths of each pixel after which rendering ends if no two paths of the image differ.
const UNKNOWN_PATHS: u32 = 64;

#[cfg(test)]
mod tests {
    use super::*;

    /// A variance of 8/n + 1 for n paths, of which the cut adds a quarter.
    ///
    /// Seen to catch: what stays not divided by the growth, chance not in proportion to it.
    #[test]
    fn what_stays_is_known_from_any_growth() {
        let error = |paths: f64| (8.0 / paths + 1.0f64).sqrt();
        for (few, many) in [(4.0, 6.0), (4.0, 8.0), (10.0, 16.0)] {
            let stays = |freedom, cut: f64| {
                let estimator = Estimator::Cut { accuracy: cut };
                irreducible_error(error(many), error(few), many / few, freedom, estimator)
            };
            assert!((stays(1e18, 0.0) - 1.0).abs() < 1e-6, "{few} {many}");
            assert!((stays(1e18, 0.5) - 0.75f64.sqrt()).abs() < 1e-6, "{few} {many}");
            let now = 8.0 / many + 1.0;
            let chance = 6.0 * many / few / 100.0 * now / (many / few - 1.0);
            assert!((stays(1e4, 0.0).powi(2) - (1.0 - chance).max(0.0)).abs() < 1e-6, "{few} {many}");
        }
    }
}
