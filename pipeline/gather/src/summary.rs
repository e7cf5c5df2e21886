//! The messages of the program about a rendered image.

use crate::report::Facts;
use cli::{Failure, count};
use gather::{Settings, counts::Counts, film};

/// If more than this share of the paths meet translucent surfaces from within, the camera is inside a medium or looks
/// into an open mesh; a smaller share are rays that slip between triangles.
const STRAY: f64 = 0.01;

/// Prints the error of the image and warns of unusual views; fails if a value of the image is not finite.
pub fn show(facts: &Facts) -> Result<(), Failure> {
    check_finite(facts)?;
    let (common, counts) = (&facts.request.common, &facts.rendered.counts);
    // If no two paths differ, the error is unknown: there may be light that none of them met.
    let error = film::relative_error(&facts.rendered.pixels).filter(|error| *error > 0.0);
    let error = error.map_or("unknown".into(), sums::confidence::percent);
    let (gathers, evaluations, covers) = (count(counts.gathers), count(counts.evaluations), facts.covers());
    if facts.settings.reference {
        let [walks, collisions] = [counts.walks, counts.collisions].map(count);
        common.say(format_args!("{walks} walks, {collisions} collisions; relative error {error} ({covers})"));
    } else {
        common.say(format_args!(
            "{gathers} gathers, {evaluations} BSSRDF evaluations; relative error {error} ({covers})"
        ));
    }
    let share = |n: u64| 100.0 * n as f64 / counts.paths as f64;
    if counts.cut_by_depth > 0 {
        let (share, depth) = (share(counts.cut_by_depth), facts.settings.max_depth);
        common.say(format_args!("of 100 paths {share:.3} branches were cut off at --max-depth {depth}"));
    }
    if counts.escaped_inside > 0 {
        let share = share(counts.escaped_inside);
        common.warn(format_args!("{share:.3} % of the paths left a medium through a hole in its mesh"));
    }
    if counts.reflections_left_out > 0 {
        common.warn(
            "--reference: the mesh has too many triangles near each other to follow light that it reflects inside before \
             it is scattered; thin parts and sharp edges are a little dark",
        );
    }
    if counts.walks_trapped > 0 {
        let share = 100.0 * counts.walks_trapped as f64 / counts.walks as f64;
        common
            .warn(format_args!("{share:.3} % of the walks were reflected inside without end: the medium is too clear"));
    }
    if let Some(warning) = odd_view(counts, &facts.settings) {
        common.warn(facts.job.line(&warning));
    }
    Ok(())
}

/// Refuses an image with values that are not finite, and names some of their pixels.
fn check_finite(facts: &Facts) -> Result<(), Failure> {
    let rendered = facts.rendered;
    if rendered.non_finite_count == 0 {
        return Ok(());
    }
    let pixels: Vec<String> = rendered.non_finite.iter().map(|p| format!("{:?}", facts.pixel(*p))).collect();
    let (count, pixels) = (count(rendered.non_finite_count), pixels.join(" "));
    let message = format!("{count} pixels are not finite, no image was written; the first are {pixels}");
    Err(facts.job.failure(Failure::numerical(message)))
}

/// The warning of an image that shows nothing translucent, or shows it from within.
fn odd_view(counts: &Counts, settings: &Settings) -> Option<String> {
    let what = settings.crop.map_or_else(
        || "the camera".to_owned(),
        |c| format!("--crop {},{},{},{} of the camera", c.x, c.y, c.width, c.height),
    );
    let met = counts.from_outside + counts.from_inside;
    if met == 0 {
        return Some(format!(
            "{what} sees no translucent surface: does it look towards one, and is its position in the scene's units \
             (--list-cameras, --metres-per-unit)?"
        ));
    }
    let share = counts.from_inside as f64 / met as f64;
    (share > STRAY).then(|| {
        format!(
            "{what} sees translucent surfaces from within ({:.0} % of its paths to them): it stands inside a medium, where \
             no scattered light is seen, or looks into an open mesh; move it out",
            100.0 * share
        )
    })
}
