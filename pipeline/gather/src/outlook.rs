//! What the camera's place lets it see: said if it can hardly be meant.

use gather::{Settings, counts::Counts};

/// Share of the paths to translucent surfaces that may meet them from within: rays between triangles.
const STRAY: f64 = 0.01;

/// The warning of an image that shows nothing translucent, or shows it from within.
pub fn warning(counts: &Counts, settings: &Settings) -> Option<String> {
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
