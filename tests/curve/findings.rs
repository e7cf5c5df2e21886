//! What the measurements say: targets, plots and tables, before they are put into a document.

use crate::plot::Plot;

/// One target, and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    pub what: String,
    pub wanted: String,
    pub found: String,
    /// None if it could not be measured.
    pub met: Option<bool>,
    /// Measured, or how the figure was extrapolated.
    pub basis: String,
}

impl Target {
    /// A figure that should be this large or larger.
    pub fn at_least(what: impl Into<String>, wanted: f64, found: Option<f64>, basis: impl Into<String>) -> Target {
        Target::new(what.into(), format!("≥ {wanted}"), found, found.map(|x| x >= wanted), basis.into())
    }

    /// A figure that should be this small or smaller.
    pub fn at_most(what: impl Into<String>, wanted: f64, found: Option<f64>, basis: impl Into<String>) -> Target {
        Target::new(what.into(), format!("≤ {wanted}"), found, found.map(|x| x <= wanted), basis.into())
    }

    fn new(what: String, wanted: String, found: Option<f64>, met: Option<bool>, basis: String) -> Target {
        Target { what, wanted, found: found.map_or("–".into(), three), met, basis }
    }
}

/// A heading with text or tables.
#[derive(Clone, Debug, Default)]
pub struct Section {
    pub title: String,
    pub text: String,
}

/// All that one part or all of them found.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    pub targets: Vec<Target>,
    /// Name of the file without `speed-` and `.svg`, and the plot.
    pub plots: Vec<(String, Plot)>,
    pub sections: Vec<Section>,
}

impl Findings {
    pub fn add(&mut self, other: Findings) {
        self.targets.extend(other.targets);
        self.plots.extend(other.plots);
        self.sections.extend(other.sections);
    }

    pub fn section(&mut self, title: impl Into<String>, text: String) {
        self.sections.push(Section { title: title.into(), text });
    }
}

/// A table in Markdown.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(header.to_vec());
    text += &line(vec!["---"; header.len()]);
    rows.iter().for_each(|row| text += &line(row.iter().map(String::as_str).collect()));
    text
}

/// Three significant digits.
pub fn three(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    match x.abs().log10().floor() as i32 {
        6.. | ..-4 => format!("{x:.2e}"),
        digits => {
            let unit = 10f64.powi(digits - 2);
            format!("{:.*}", (2 - digits).max(0) as usize, (x / unit).round() * unit)
        }
    }
}

/// A share as per cent, two significant digits and more.
pub fn percent(x: f64) -> String {
    format!("{} %", three(100.0 * x))
}

/// Seconds in the unit that suits them.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{} ms", three(1e3 * s)),
        s if s < 600.0 => format!("{} s", three(s)),
        s if s < 4.0 * 3600.0 => format!("{} min", three(s / 60.0)),
        s if s < 4.0 * 86400.0 => format!("{} h", three(s / 3600.0)),
        s if s < 1000.0 * 86400.0 => format!("{} days", three(s / 86400.0)),
        s => format!("{} years", three(s / 31_557_600.0)),
    }
}

/// A count as `300k`, `1.5M`.
pub fn count(n: u64) -> String {
    match n {
        0..1000 => n.to_string(),
        1000..1_000_000 => format!("{}k", n as f64 / 1e3),
        _ => format!("{}M", n as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.012345, 1.0, 999.6, 312.4, 12345.0].map(three), ["0.0123", "1.00", "1000", "312", "12300"]);
        assert_eq!([3e-5, 0.0, 1.5e9].map(three), ["3.00e-5", "0", "1.50e9"]);
        assert_eq!([0.05, 7.0, 7200.0, 5e5].map(time), ["50.0 ms", "7.00 s", "120 min", "5.79 days"]);
        assert_eq!([500, 30_000, 1_600_000].map(count), ["500", "30k", "1.6M"]);
    }

    #[test]
    fn targets_are_judged_by_their_direction() {
        assert_eq!(Target::at_least("a", 300.0, Some(310.0), "").met, Some(true));
        assert_eq!(Target::at_most("a", 1.05, Some(1.06), "").met, Some(false));
        assert_eq!(Target::at_most("a", 1.05, None, "").met, None);
        assert_eq!(Target::at_most("a", 1.05, Some(f64::NAN), "").met, Some(false));
    }
}
