//! How many paths: as many as asked for, or as an error takes.

use cli::{Common, Progress, count, count_up};
use formats::cloud::{Cloud, Pattern};
use gather::{Input, Rendered, Settings, estimator::Estimator, film::Errors, render, shards, start};
use sums::confidence::Estimate;

pub fn render_all(input: &Input, settings: &Settings, common: &Common) -> Rendered {
    let progress = Progress::start(common, "gathering", settings.part().pixels() as u64, "pixels");
    let rendered = render(input, settings, |n| progress.add(n));
    progress.finish();
    rendered
}

/// Doubles the paths until the error is the target, or the cloud's own error is most of it, or there are enough.
pub fn render_to(target: f64, input: &Input, settings: &Settings, common: &Common) -> Rendered {
    let most = settings.paths_per_pixel;
    let mut paths = FIRST_PATHS.min(most);
    let mut session = start(input, &Settings { paths_per_pixel: paths, ..settings.clone() });
    let pixels = settings.part().pixels() as u64;
    let (mut done, mut before) = (0, f64::INFINITY);
    loop {
        let progress = Progress::start(common, "gathering", pixels, &steps(done + 1, paths));
        session.pass(paths - done, &|n| progress.add(n));
        progress.finish();
        let errors = session.errors();
        let round = Round { target, input, paths, done, before };
        match round.judge(errors.as_ref(), settings) {
            Verdict::Met => break,
            Verdict::Never(why) => {
                common.warn(why);
                break;
            }
            Verdict::More => {}
        }
        if paths >= most {
            common.warn(format_args!(
                "--target-error is not met with {} paths a pixel; --spp allows more",
                count(u64::from(most))
            ));
            break;
        }
        before = errors.map_or(f64::INFINITY, |errors| errors.total);
        done = paths;
        paths = (2 * paths).min(most);
    }
    session.finish()
}

/// What a pass adds to: paths of these numbers.
fn steps(first: u32, last: u32) -> String {
    format!("pixels, paths {} to {}", count(u64::from(first)), count(u64::from(last)))
}

/// What is known after a pass.
struct Round<'a> {
    target: f64,
    input: &'a Input<'a>,
    /// Of each pixel, with this pass and without.
    paths: u32,
    done: u32,
    /// The error without it.
    before: f64,
}

/// What comes next.
enum Verdict {
    Met,
    More,
    /// More paths do not help, and why.
    Never(String),
}

impl Round<'_> {
    fn judge(&self, errors: Option<&Errors>, settings: &Settings) -> Verdict {
        let estimate = errors.and_then(Errors::estimate);
        let (Some(errors), Some(estimate)) = (errors, estimate) else {
            let paths = self.paths;
            return if paths < UNKNOWN_PATHS {
                Verdict::More
            } else {
                Verdict::Never(format!(
                    "no two of {paths} paths a pixel differ, so that the error is unknown: there is none, or what they should \
                     meet is too small; --spp without --target-error takes more"
                ))
            };
        };
        let few = errors.scattered * self.error_of_few();
        if estimate.safe().max(few) <= self.target {
            return Verdict::Met;
        }
        if few > CLOUD_LIMITS * self.target {
            let (lit, percent) = (self.lit(), 100.0 * few);
            let why =
                format!("the cloud alone may have an error of {percent:.2} %, as {lit} of its samples carry light");
            return Verdict::Never(format!("{why}: {}", self.way_out(few)));
        }
        self.judge_cloud(errors, &estimate, settings)
    }

    /// Whether the cloud's error is most of the target.
    fn judge_cloud(&self, errors: &Errors, estimate: &Estimate, settings: &Settings) -> Verdict {
        let clouds = self.input.clouds.len();
        // What differs because paths have not had their turns at all clouds does not last.
        if clouds > 1 && (self.done as usize) < 2 * clouds {
            return Verdict::More;
        }
        // What differs may do so by chance, in an image of few pixels most of all: three standard deviations of it.
        let [paths, total] = [errors.paths, errors.total].map(|error| error * error);
        let shows = total > exceeded_rarely(errors.paths_freedom) * paths;
        let lasts = lasting(errors.total, self.before, estimate.freedom, settings.estimator);
        let error = if shows { errors.cloud.max(lasts) } else { lasts };
        if error > CLOUD_LIMITS * self.target {
            let percent = 100.0 * error;
            return Verdict::Never(format!("the cloud alone has an error of {percent:.2} %: {}", self.way_out(error)));
        }
        // Where paths hardly matter any more, the cloud's two halves are all that tells of its error.
        let cloud = Estimate { error: errors.cloud, freedom: errors.cloud_freedom };
        if errors.paths < 0.5 * cloud.error && cloud.safe() > self.target {
            let (percent, within) = (100.0 * cloud.error, 100.0 * cloud.within());
            return Verdict::Never(format!(
                "the cloud alone has an error of about {percent:.2} %, but its halves differ by one value in so few pixels: it \
                 is below {within:.2} % with 95 % confidence; {}",
                self.way_out(cloud.safe())
            ));
        }
        Verdict::More
    }

    /// Samples that carry light.
    fn lit(&self) -> u64 {
        (0..shards::materials(self.input.clouds).len()).map(|slot| shards::count(self.input.clouds, slot)).sum()
    }

    /// The relative error of the light of a cloud in which so few samples are lit: that of their number, if it is, as the
    /// samples are, well spread or independent. The halves of the cloud may agree by luck. None is expected of a dark cloud.
    fn error_of_few(&self) -> f64 {
        let stratified = |cloud: &Cloud| cloud.meta().options.pattern == Pattern::Stratified;
        let lit = self.lit().max(1) as f64;
        let independent = lit.powf(-0.5);
        match self.lit() {
            0 => 0.0,
            _ if self.input.clouds.iter().all(stratified) => independent.min(2.0 * lit.powf(-0.75)),
            _ => independent,
        }
    }

    /// What to do about a cloud of this error.
    fn way_out(&self, error: f64) -> String {
        // The error of well-spread samples falls at least as their number to the power 3/4.
        let drawn = shards::drawn(self.input.clouds) as f64;
        let needed = drawn * (error / (CLOUD_LIMITS * self.target)).powf(4.0 / 3.0);
        if self.input.clouds.len() == 1 {
            format!("sample it again with --samples {}", count_up(needed))
        } else {
            format!("about {} samples in all would do; add shards", count_up(needed))
        }
    }
}

/// What remains of an error that was `before` with half the paths and is `now`, if the variance of paths falls as their
/// number: that of well-spread ones falls faster. What the cut may add does not fall, because it is asked of the pixel.
/// Without anything that remains, `before` is twice `now` in variance, and the difference has a standard deviation of four
/// times the root of one over the degrees of freedom: three of them are taken for chance.
fn lasting(now: f64, before: f64, freedom: f64, estimator: Estimator) -> f64 {
    let added = if let Estimator::Cut { accuracy } = estimator { accuracy } else { 0.0 };
    let chance = 3.0 * 4.0 / freedom.sqrt();
    ((2.0 - chance) * now * now - before * before - added * added).max(0.0).sqrt()
}

/// What a variance of so many degrees of freedom is above as a multiple of the true one in 1 of 1000 cases (Wilson and
/// Hilferty 1931).
fn exceeded_rarely(freedom: f64) -> f64 {
    let a = 2.0 / (9.0 * freedom);
    (1.0 - a + 3.09 * a.sqrt()).powi(3)
}

/// Paths of the first pass of `--target-error`: two for each half of the cloud.
const FIRST_PATHS: u32 = 4;

/// The cloud limits if it alone takes this share of the wanted error, half its square.
const CLOUD_LIMITS: f64 = 0.7;

/// Paths of each pixel after which an image in which no two differ is left as it is.
const UNKNOWN_PATHS: u32 = 64;
