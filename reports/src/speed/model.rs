//! A model of time and error for any cloud and any number of paths, fitted to a few measurements.

/// `y = factor x^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    pub factor: f64,
    pub exponent: f64,
}

impl PowerLaw {
    /// Least squares of the logarithms; a constant from one point, none from no points. Points that are not positive
    /// are left out, since an error that is nothing but noise may be zero.
    pub fn fit(points: &[(f64, f64)]) -> Option<PowerLaw> {
        let logs: Vec<(f64, f64)> =
            points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
        if logs.is_empty() {
            return None;
        }
        let count = logs.len() as f64;
        let (mean_x, mean_y) =
            (logs.iter().map(|p| p.0).sum::<f64>() / count, logs.iter().map(|p| p.1).sum::<f64>() / count);
        let square: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
        let product: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
        // One abscissa: there is no slope to see.
        let exponent = if square > 0.0 { product / square } else { 0.0 };
        Some(PowerLaw { factor: (mean_y - exponent * mean_x).exp(), exponent })
    }

    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

/// `y = constant + slope x`, neither of them negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    pub constant: f64,
    pub slope: f64,
}

impl Line {
    /// Least squares of the relative errors, as values span decades; none from no points.
    pub fn fit(points: &[(f64, f64)]) -> Option<Line> {
        let sum = |f: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            points.iter().filter(|(_, y)| *y > 0.0).map(|(x, y)| f(*x, *y, 1.0 / (y * y))).sum()
        };
        let (w, wx, wy) = (sum(&|_, _, w| w), sum(&|x, _, w| w * x), sum(&|_, y, w| w * y));
        let (wxx, wxy) = (sum(&|x, _, w| w * x * x), sum(&|x, y, w| w * x * y));
        if w == 0.0 {
            return None;
        }
        let determinant = w * wxx - wx * wx;
        // One abscissa: there is no slope to see.
        if determinant <= 1e-12 * w * wxx {
            return Some(Line { constant: wy / w, slope: 0.0 });
        }
        let (constant, slope) = ((wxx * wy - wx * wxy) / determinant, (w * wxy - wx * wy) / determinant);
        Some(match (constant >= 0.0, slope >= 0.0) {
            (true, true) => Line { constant, slope },
            (false, _) => Line { constant: 0.0, slope: wxy / wxx },
            (true, false) => Line { constant: wy / w, slope: 0.0 },
        })
    }

    pub fn at(&self, x: f64) -> f64 {
        self.constant + self.slope * x
    }
}

/// Seconds of a path that depend on the samples `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathCost {
    /// Every sample is visited.
    Every(Line),
    /// A tree is traversed.
    Tree(PowerLaw),
}

impl PathCost {
    fn at(&self, samples: f64) -> f64 {
        match self {
            PathCost::Every(line) => line.at(samples),
            PathCost::Tree(law) => law.at(samples),
        }
    }
}

/// The behavior of one configuration on one scene with one medium, at one image size.
#[derive(Clone, Copy, Debug)]
pub struct Behavior {
    pub pixels: f64,
    /// Relative RMSE of the cloud as a function of `K`.
    pub cloud: PowerLaw,
    /// Squared relative RMSE of one path a pixel as a function of `1/K`.
    pub paths: Line,
    /// Exponent by which that falls with the number of paths: 1 for independent ones, more for stratified ones.
    pub falls: f64,
    /// Seconds of `sample-surface` as a function of `K`.
    pub sampling: Line,
    /// Seconds of `gather` without its paths as a function of `K`.
    pub overhead: Line,
    /// Seconds of a path of one pixel, on all threads together.
    pub per_path: PathCost,
}

/// A number of samples and paths, with its time and error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spending {
    pub samples: f64,
    /// Paths a pixel.
    pub spp: f64,
    /// Seconds of both programs.
    pub seconds: f64,
    /// Relative RMSE of the image.
    pub error: f64,
}

/// The largest number of paths a pixel that `gather` accepts.
const MAX_PATHS: f64 = 1_048_576.0;

impl Behavior {
    /// Seconds and error of a cloud of `samples` under `spp` paths a pixel.
    pub fn spending(&self, samples: f64, spp: f64) -> Spending {
        let once = self.sampling.at(samples) + self.overhead.at(samples);
        let seconds = once + self.pixels * spp * self.per_path.at(samples);
        let error = (self.cloud.at(samples).powi(2) + self.paths.at(1.0 / samples) / spp.powf(self.falls)).sqrt();
        Spending { samples, spp, seconds, error }
    }

    /// The shortest time that reaches an error, over clouds of a thousand to 10^13 samples.
    pub fn cheapest(&self, error: f64) -> Option<Spending> {
        let all = (0..=400).map(|step| 10f64.powf(3.0 + f64::from(step) / 40.0));
        let one = |samples: f64| {
            let left = error * error - self.cloud.at(samples).powi(2);
            let spp = (self.paths.at(1.0 / samples) / left).powf(1.0 / self.falls).max(1.0);
            (left > 0.0 && spp <= MAX_PATHS).then(|| self.spending(samples, spp))
        };
        all.filter_map(one).min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }

    /// The smallest error within a time and up to a number of samples.
    pub fn best_within(&self, seconds: f64, max_samples: f64) -> Option<Spending> {
        let errors = (0..=300).map(|step| 10f64.powf(-3.0 + f64::from(step) / 100.0));
        errors.filter_map(|e| self.cheapest(e)).find(|s| s.seconds <= seconds && s.samples <= max_samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equality to within a millionth.
    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-6 * b.abs()
    }

    fn behavior() -> Behavior {
        Behavior {
            pixels: 1000.0,
            cloud: PowerLaw { factor: 10.0, exponent: -0.5 },
            paths: Line { constant: 0.04, slope: 100.0 },
            falls: 1.0,
            sampling: Line { constant: 0.0, slope: 1e-7 },
            overhead: Line { constant: 0.5, slope: 0.0 },
            per_path: PathCost::Every(Line { constant: 0.0, slope: 1e-9 }),
        }
    }

    #[test]
    fn power_laws_are_found_again() {
        let points = [1e4, 1e5, 3e6].map(|k: f64| (k, 7.0 * k.powf(-0.8)));
        let law = PowerLaw::fit(&points).unwrap();
        assert!(near(law.factor, 7.0) && near(law.exponent, -0.8), "{law:?}");
        assert_eq!(PowerLaw::fit(&[(3.0, 5.0)]).map(|l| l.exponent), Some(0.0));
        assert_eq!(PowerLaw::fit(&[(3.0, 0.0)]), None);
    }

    #[test]
    fn lines_are_found_again_and_are_never_negative() {
        let line = Line::fit(&[(1.0, 5.0), (10.0, 23.0), (1000.0, 2003.0)]).unwrap();
        assert!(near(line.constant, 3.0) && near(line.slope, 2.0), "{line:?}");
        let through_origin = Line::fit(&[(1.0, 1.0), (10.0, 100.0)]).unwrap();
        assert_eq!(through_origin.constant, 0.0);
        let flat = Line::fit(&[(1.0, 3.0), (10.0, 2.0)]).unwrap();
        assert!(flat.slope == 0.0 && flat.constant > 2.0 && flat.constant < 3.0);
        assert_eq!(Line::fit(&[]), None);
    }

    #[test]
    fn time_and_error_of_one_point() {
        let s = behavior().spending(1e6, 4.0);
        assert!(near(s.seconds, 0.1 + 0.5 + 1000.0 * 4.0 * 1e-3));
        assert!(near(s.error.powi(2), 1e-4 + 0.0401 / 4.0));
        let s = Behavior { falls: 1.5, ..behavior() }.spending(1e6, 4.0);
        assert!(near(s.error.powi(2), 1e-4 + 0.0401 / 8.0));
    }

    /// Where the time is `K n`, paths times K, and the squared error `c²/K + v/n = e²`, the time is shortest at `c²/K
    /// = e²/2`, where it is `4 c² v / e⁴`.
    #[test]
    fn the_optimum_shares_the_error_evenly() {
        let mut b = behavior();
        (b.paths, b.sampling, b.overhead) = (Line { constant: 0.04, slope: 0.0 }, Line::default(), Line::default());
        for error in [0.02, 0.01] {
            let best = b.cheapest(error).unwrap();
            let exact = 1000.0 * 1e-9 * 4.0 * 100.0 * 0.04 / error.powi(4);
            assert!((best.seconds / exact - 1.0).abs() < 0.01, "{best:?} {exact}");
            assert!((best.samples * error * error / 200.0 - 1.0).abs() < 0.06);
            assert!(near(best.error, error));
        }
        let ratio = b.cheapest(0.01).unwrap().seconds / b.cheapest(0.02).unwrap().seconds;
        assert!((ratio / 16.0 - 1.0).abs() < 0.01, "{ratio}");
    }

    #[test]
    fn out_of_reach_is_none() {
        let mut b = behavior();
        b.cloud = PowerLaw { factor: 0.1, exponent: 0.0 };
        assert_eq!(b.cheapest(0.05), None);
        b.cloud = PowerLaw { factor: 10.0, exponent: -0.5 };
        let best = b.best_within(10.0, 1e7).unwrap();
        assert!(best.seconds <= 10.0 && best.seconds > 9.0, "{best:?}");
    }
}
