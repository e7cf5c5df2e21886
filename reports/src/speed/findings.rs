//! Results of the measurements: targets, plots and tables, before they are put into a document.

use crate::{markdown::three, speed::plot::Plot};

/// One target and its result.
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
    /// A figure that should be at least this large.
    pub fn at_least(what: impl Into<String>, wanted: f64, found: Option<f64>, basis: impl Into<String>) -> Target {
        Target::new(what.into(), format!("≥ {wanted}"), found, found.map(|x| x >= wanted), basis.into())
    }

    /// A figure that should be at most this large.
    pub fn at_most(what: impl Into<String>, wanted: f64, found: Option<f64>, basis: impl Into<String>) -> Target {
        Target::new(what.into(), format!("≤ {wanted}"), found, found.map(|x| x <= wanted), basis.into())
    }

    fn new(what: String, wanted: String, found: Option<f64>, met: Option<bool>, basis: String) -> Target {
        Target { what, wanted, found: found.map_or("–".into(), three), met, basis }
    }
}

/// A heading with text or tables, and perhaps a plot above them.
#[derive(Clone, Debug, Default)]
pub struct Section {
    pub title: String,
    /// Name of the file without `speed-` and `.svg`, and the plot.
    pub plot: Option<(String, Plot)>,
    pub text: String,
}

/// Results of one part of the measurements, or of all.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    pub targets: Vec<Target>,
    pub sections: Vec<Section>,
}

impl Findings {
    pub fn add(&mut self, other: Findings) {
        self.targets.extend(other.targets);
        self.sections.extend(other.sections);
    }

    pub fn section(&mut self, title: impl Into<String>, text: String) {
        self.sections.push(Section { title: title.into(), plot: None, text });
    }

    /// A section whose plot is `speed-NAME.svg`.
    pub fn plotted(&mut self, title: impl Into<String>, name: impl Into<String>, plot: Plot, text: String) {
        self.sections.push(Section { title: title.into(), plot: Some((name.into(), plot)), text });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_judged_by_their_direction() {
        assert_eq!(Target::at_least("a", 300.0, Some(310.0), "").met, Some(true));
        assert_eq!(Target::at_most("a", 1.05, Some(1.06), "").met, Some(false));
        assert_eq!(Target::at_most("a", 1.05, None, "").met, None);
        assert_eq!(Target::at_most("a", 1.05, Some(f64::NAN), "").met, Some(false));
    }
}
