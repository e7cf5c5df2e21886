//! The legend: the meaning of the colors, below the picture and as text in the file.

use picture::{Picture, font};

use super::color::{self, Counts};

/// The width of the narrowest picture that holds the legend, in pixels.
pub(super) const WIDTH: usize = 448;
/// The height of the legend in pixels: a title, the bar, its numbers, two lines of other colors.
pub(super) const HEIGHT: usize = MARGIN + 4 * LINE + BAR + TICK + GAP + MARGIN;
pub(super) const PAPER: [u8; 3] = [24, 24, 26];

const INK: [u8; 3] = [235, 232, 225];
const MARGIN: usize = 8;
/// The space between the ends of the bar and the border, which holds half of the longest number.
const SIDE: usize = 4 * font::ADVANCE;
const BAR: usize = 16;
const TICK: usize = 6;
/// The space below the numbers.
const GAP: usize = 6;
const LINE: usize = font::LINE + 4;
/// The number of evenly spaced numbers below the bar.
const TICKS: usize = 5;

/// Draws the legend into the rows from `top` on.
pub(super) fn draw(picture: &mut Picture, top: usize, layer: &str, counts: Counts, max: f64) {
    let Counts { above, not_finite } = counts;
    let top = top + MARGIN;
    write(picture, &format!("absolute error of {layer}"), MARGIN, top);
    draw_bar(picture, top + LINE, max);
    let top = top + LINE + BAR + TICK + LINE + GAP;
    draw_swatch(picture, top, color::ABOVE, &format!("above {}: {above} pixels", short(max)));
    draw_swatch(picture, top + LINE, color::NOT_FINITE, &format!("not finite: {not_finite} pixels"));
}

fn draw_bar(picture: &mut Picture, top: usize, max: f64) {
    let width = WIDTH - 2 * SIDE;
    let scale = color::scale();
    for x in 0..width {
        let color = scale[x * (color::STEPS - 1) / (width - 1)];
        picture.fill(SIDE + x..SIDE + x + 1, top..top + BAR, color);
    }
    for tick in 0..TICKS {
        let x = SIDE + (width - 1) * tick / (TICKS - 1);
        picture.fill(x..x + 1, top + BAR..top + BAR + TICK, INK);
        let number = short(max * tick as f64 / (TICKS - 1) as f64);
        let left = x.saturating_sub(number.len() * font::ADVANCE / 2);
        write(picture, &number, left, top + BAR + TICK + 2);
    }
}

fn draw_swatch(picture: &mut Picture, top: usize, color: [u8; 3], text: &str) {
    picture.fill(MARGIN..MARGIN + 14, top..top + 14, color);
    write(picture, text, MARGIN + 22, top);
}

fn write(picture: &mut Picture, text: &str, left: usize, top: usize) {
    font::dots(text, picture.width - left).for_each(|(x, y)| picture.dot(left + x, top + y, INK));
}

/// The scale as text, for programs and for people who cannot see it.
pub(super) fn description(layer: &str, max: f64, zoom: usize) -> String {
    // Plain text in PNG is Latin-1.
    let layer: String = layer.chars().map(|letter| if letter.is_ascii_graphic() { letter } else { '?' }).collect();
    format!(
        "absolute error of {layer}, largest of its channels; linear scale from 0 to {max}, lightness grows with it; \
         white: above; green: not finite; {zoom} x {zoom} pixels each"
    )
}

/// A number with at most three digits, and with an exponent where that is shorter.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if value == 0.0 || (1e-3..1e5).contains(&value) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, 0.1, 0.1 * 3.0 / 4.0, 1.0 / 3.0, 12_345.0, 1e-9, 1.0 / 3e4];
        assert_eq!(numbers.map(short), ["0", "0.1", "0.075", "0.333", "12300", "1e-9", "3.33e-5"]);
    }

    /// Seen to catch: ticks a quarter too far to the right, the bar upside down.
    #[test]
    fn the_bar_runs_from_no_error_to_the_end_of_the_scale() {
        let mut picture = Picture::new(WIDTH, HEIGHT, PAPER);
        draw_bar(&mut picture, 0, 1.0);
        let at = |x: usize, y: usize| picture.pixels[y * WIDTH + x];
        let scale = color::scale();
        let end = WIDTH - SIDE - 1;
        assert_eq!([at(SIDE, 3), at(end, 3)], [scale[0], scale[255]]);
        assert_eq!([at(SIDE, BAR + 2), at(end, BAR + 2), at(end + 1, BAR + 2)], [INK, INK, PAPER]);
    }
}
