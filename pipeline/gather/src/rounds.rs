//! How many paths: as many as asked for, or as an error takes.

use cli::{Common, Progress, count, count_up};
use gather::{Input, Rendered, Settings, clouds, estimator::Estimator, render, start};

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
        if errors.total <= target {
            break;
        }
        // What differs because paths have not had their turns at all clouds does not last.
        let judged = input.clouds.len() == 1 || done as usize >= 2 * input.clouds.len();
        let lasts = || errors.cloud.max(lasting(errors.total, before, settings.estimator));
        let cloud_error = if judged { lasts() } else { 0.0 };
        before = errors.total;
        if cloud_error > CLOUD_LIMITS * target {
            // The error of well-spread samples falls at least as their number to the power 3/4.
            let drawn = clouds::drawn(input.clouds) as f64;
            let needed = drawn * (cloud_error / (CLOUD_LIMITS * target)).powf(4.0 / 3.0);
            let percent = 100.0 * cloud_error;
            let way_out = if input.clouds.len() == 1 {
                format!("sample it again with --samples {}", count_up(needed))
            } else {
                format!("about {} samples in all would do; add shards", count_up(needed))
            };
            common.warn(format_args!("the cloud alone has an error of {percent:.2} %: {way_out}"));
            break;
        }
        if paths >= most {
            common.warn(format_args!(
                "--target-error is not met with {} paths a pixel; --spp allows more",
                count(u64::from(most))
            ));
            break;
        }
        done = paths;
        paths = (2 * paths).min(most);
    }
    session.finish()
}

/// What a pass adds to: paths of these numbers.
fn steps(first: u32, last: u32) -> String {
    format!("pixels, paths {} to {}", count(u64::from(first)), count(u64::from(last)))
}

/// What remains of an error that was `before` with half the paths and is `now`, if the variance of paths falls as their
/// number: that of well-spread ones falls faster. What the cut may add does not fall, because it is asked of the pixel.
fn lasting(now: f64, before: f64, estimator: Estimator) -> f64 {
    let added = if let Estimator::Cut { accuracy } = estimator { accuracy } else { 0.0 };
    (2.0 * now * now - before * before - added * added).max(0.0).sqrt()
}

/// Paths of the first pass of `--target-error`: two for each half of the cloud.
const FIRST_PATHS: u32 = 4;

/// The cloud limits if it alone takes this share of the wanted error, half its square.
const CLOUD_LIMITS: f64 = 0.7;
