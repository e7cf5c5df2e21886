//! Log-log plots as SVG. The background is transparent and the grays are medium, so that they are legible on light
//! and dark pages.

use std::fmt::Write;

/// One curve with dots; without dots it is thin.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    pub label: String,
    pub line: Vec<(f64, f64)>,
    pub dots: Vec<(f64, f64)>,
}

/// A plot of positive numbers.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    pub title: String,
    pub x: String,
    pub y: String,
    pub curves: Vec<Curve>,
}

const WIDTH: f64 = 790.0;
const HEIGHT: f64 = 440.0;
/// Left, top, right and bottom of the area that the curves fill.
const AREA: [f64; 4] = [70.0, 40.0, 560.0, 385.0];
/// Color of text and axes: its contrast is above 4 both on white and on the dark gray of code hosts.
const INK: &str = "#7b8087";
/// Colors that are distinct for most color-blind eyes, and neither very dark nor very light.
const COLORS: [&str; 8] = ["#8c8c8c", "#d98b00", "#2f9bd6", "#00a077", "#b9a400", "#d5557f", "#8d6bd1", "#d9582b"];

/// A logarithmic axis.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// The range of values, widened to thirds of a decade and to at least a decade.
    fn of(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Axis {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        let (low, high) = if low <= high { ((low * 3.0).floor() / 3.0, (high * 3.0).ceil() / 3.0) } else { (0.0, 1.0) };
        Axis { low, high: high.max(low + 1.0), from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Decades, and 2 and 5 times them if there are few.
    fn ticks(&self) -> Vec<f64> {
        let steps: &[f64] = if self.high - self.low > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = decades.flat_map(|d| steps.iter().map(move |s| s * 10f64.powi(d)));
        all.filter(|t| (self.low - 1e-9..=self.high + 1e-9).contains(&t.log10())).collect()
    }
}

impl Plot {
    fn values(&self, which: fn(&(f64, f64)) -> f64) -> impl Iterator<Item = f64> {
        self.curves.iter().flat_map(move |c| c.line.iter().chain(&c.dots).map(which))
    }

    /// The plot as a file.
    pub fn to_svg(&self) -> String {
        let [left, top, right, bottom] = AREA;
        let x = Axis::of(self.values(|p| p.0), left, right);
        let y = Axis::of(self.values(|p| p.1), bottom, top);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
             font-family=\"sans-serif\" font-size=\"12\" fill=\"{INK}\">\n"
        );
        let middle = 0.5 * (left + right);
        label(&mut svg, [middle, 22.0], "middle", &format!("<tspan font-size=\"15\">{}</tspan>", escape(&self.title)));
        axes(&mut svg, &x, &y);
        label(&mut svg, [middle, HEIGHT - 14.0], "middle", &escape(&self.x));
        let turned = format!("transform=\"rotate(-90 16 {0})\" ", 0.5 * (top + bottom));
        writeln!(
            svg,
            "<text x=\"16\" y=\"{}\" {turned}text-anchor=\"middle\">{}</text>",
            0.5 * (top + bottom),
            escape(&self.y)
        )
        .expect("a string takes all");
        for (index, curve) in self.curves.iter().enumerate() {
            draw(&mut svg, curve, index, [&x, &y]);
        }
        svg + "</svg>\n"
    }
}

fn axes(svg: &mut String, x: &Axis, y: &Axis) {
    let [left, top, right, bottom] = AREA;
    let mut grid = String::new();
    for tick in x.ticks() {
        write!(grid, "M{:.1} {top}V{bottom}", x.at(tick)).expect("a string takes all");
        label(svg, [x.at(tick), bottom + 17.0], "middle", &short(tick));
    }
    for tick in y.ticks() {
        write!(grid, "M{left} {:.1}H{right}", y.at(tick)).expect("a string takes all");
        label(svg, [left - 7.0, y.at(tick) + 4.0], "end", &short(tick));
    }
    let frame = format!("M{left} {top}H{right}V{bottom}H{left}Z");
    writeln!(svg, "<path d=\"{grid}\" stroke=\"{INK}\" stroke-opacity=\"0.25\" fill=\"none\"/>").expect("as above");
    writeln!(svg, "<path d=\"{frame}\" stroke=\"{INK}\" fill=\"none\"/>").expect("as above");
}

/// A curve and its line of the legend.
fn draw(svg: &mut String, curve: &Curve, index: usize, [x, y]: [&Axis; 2]) {
    let color = COLORS[index % COLORS.len()];
    let dash = ["", "7 3", "2 3"][index % 3];
    let position = |p: &(f64, f64)| (x.at(p.0), y.at(p.1));
    let width = if curve.dots.is_empty() { 1 } else { 2 };
    let stroke = format!("stroke=\"{color}\" stroke-width=\"{width}\" stroke-dasharray=\"{dash}\" fill=\"none\"");
    let points: Vec<String> = curve.line.iter().map(position).map(|(a, b)| format!("{a:.1},{b:.1}")).collect();
    let row = AREA[1] + 10.0 + 20.0 * index as f64;
    let from = AREA[2] + 12.0;
    let mut out = |line: String| writeln!(svg, "{line}").expect("a string takes all");
    if !points.is_empty() {
        out(format!("<polyline points=\"{}\" {stroke}/>", points.join(" ")));
        out(format!("<path d=\"M{from} {row}h24\" {stroke}/>"));
    }
    let dot = |(a, b): (f64, f64)| format!("<circle cx=\"{a:.1}\" cy=\"{b:.1}\" r=\"4\" fill=\"{color}\"/>");
    curve.dots.iter().map(position).for_each(|p| out(dot(p)));
    if !curve.dots.is_empty() {
        out(dot((from + 12.0, row)));
    }
    label(svg, [from + 30.0, row + 4.0], "start", &escape(&curve.label));
}

fn label(svg: &mut String, [x, y]: [f64; 2], anchor: &str, text: &str) {
    writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>")
        .expect("a string takes all");
}

/// A tick's number: `0.02`, `500`, `10k`, `1M`, `1e9`.
fn short(value: f64) -> String {
    match value {
        v if v >= 1e9 => format!("1e{:.0}", v.log10().floor()),
        v if v >= 1e6 => format!("{:.0}M", v / 1e6),
        v if v >= 1e4 => format!("{:.0}k", v / 1e3),
        v if v < 1e-4 => format!("{v:.0e}"),
        v => format!("{}", (v * 1e6).round() / 1e6),
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_in_reach_and_short() {
        let axis = Axis::of([0.015, 0.4].into_iter(), 0.0, 100.0);
        assert_eq!(axis.ticks().first().map(|t| short(*t)).as_deref(), Some("0.01"));
        assert!(axis.ticks().len() > 3 && axis.ticks().iter().all(|t| (-1e-6..=100.0 + 1e-6).contains(&axis.at(*t))));
        assert_eq!([1e4, 1e6, 1e9, 500.0, 0.02, 1e-5].map(short), ["10k", "1M", "1e9", "500", "0.02", "1e-5"]);
    }

    #[test]
    fn a_plot_without_points_is_still_one() {
        let plot = Plot { title: "a < b".into(), curves: vec![Curve::default()], ..Plot::default() };
        let svg = plot.to_svg();
        assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
