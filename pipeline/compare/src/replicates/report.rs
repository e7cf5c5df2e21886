//! The report of the tests, as a table for people and as JSON for programs.

use std::fmt::Write;

use cli::printable;
use serde::Serialize;

use super::statistic::Kind;

/// The version of the keys, which changes only when a key of the JSON report changes its meaning or is removed.
pub(super) const SCHEMA: u32 = 1;
/// The verdict names so many failures; the table has all.
const NAMED: usize = 3;

/// The test of one statistic. Differences are relative to the reference.
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// The layer, the part of it, and the channel.
    pub name: String,
    /// The quantity that the statistic measures.
    pub kind: Kind,
    /// The mean of the reference; it is the geometric mean if logarithms are compared.
    pub reference: f64,
    /// The mean of the test images.
    pub test: f64,
    /// The relative difference, positive if the test images have more.
    pub difference: f64,
    /// Student's t.
    pub t: f64,
    /// The degrees of freedom of t.
    pub freedom: f64,
    /// The probability of such a t, or one farther out, if nothing has changed.
    pub p: f64,
    /// The smallest bias that is found nine times in ten.
    pub visible: f64,
    /// The ratio of the variances, if it is tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scatter: Option<Scatter>,
    /// Whether the statistic passed.
    pub ok: bool,
}

/// The test of the ratio of the variances.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Scatter {
    /// The variance of the test images over that of the reference.
    pub ratio: f64,
    /// The probability of such a ratio, or a larger one, if nothing has changed.
    pub p: f64,
    /// The smallest growth that is found nine times in ten.
    pub visible: f64,
}

/// Everything that was tested. Numbers that are not finite are `null` in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseReport {
    /// The version of the keys.
    pub schema: u32,
    /// The number of replicates of the reference.
    pub reference_replicates: usize,
    /// The number of replicates that were judged.
    pub test_replicates: usize,
    /// The probability of a false alarm over all folders of the run.
    pub false_alarm_rate: f64,
    /// The number of folders of the run.
    pub family: usize,
    /// The number of tests in this folder.
    pub tests: usize,
    /// The significance level of each test after Šidák's correction.
    pub level: f64,
    /// The number of samples that are NaN or infinite.
    pub not_finite: usize,
    /// The test of each statistic.
    pub statistics: Vec<Judged>,
    /// The names of the statistics that were not tested, each with the reason.
    pub left_out: Vec<[String; 2]>,
    /// Whether everything passed.
    pub pass: bool,
}

impl NoiseReport {
    /// The smallest p-value of all tests, and the name of its statistic. NaN counts as 0.
    pub fn min_p(&self) -> (f64, &str) {
        let p = |judged: &Judged| {
            let scatter = judged.scatter.map_or(1.0, |scatter| scatter.p);
            if judged.p.is_nan() || scatter.is_nan() { 0.0 } else { judged.p.min(scatter) }
        };
        let all = self.statistics.iter().map(|judged| (p(judged), judged.name.as_str()));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, "nothing"))
    }

    /// The table, with a line for each statistic.
    pub fn table(&self) -> String {
        let mut table = format!(
            "{} replicates against {} of the reference; {} tests, level {:.2e} each: {:.0e} over {} such folders\n",
            self.test_replicates, self.reference_replicates, self.tests, self.level, self.false_alarm_rate, self.family
        );
        let width = self.statistics.iter().map(|judged| printable(&judged.name).len()).max().unwrap_or(0);
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "{:<width$}{:>12}{:>12}{:>12}{:>8}{:>5}{:>10}{:>10}",
            "statistic", "reference", "test", "difference", "t", "df", "p", "visible"
        );
        for judged in &self.statistics {
            line(&mut table, judged, width);
        }
        for [name, reason] in &self.left_out {
            let _ = writeln!(table, "{:<width$}  not tested: {}", printable(name), printable(reason));
        }
        let _ = writeln!(table, "not finite: {} samples of the test images", self.not_finite);
        table + "visible is the smallest bias that is found nine times in ten; of `noise`, only growth is tested\n"
    }

    /// One line: `PASS name` with the smallest p-value and the visible biases, or `FAIL name` with the statistics that
    /// differ.
    pub fn verdict(&self, name: &str) -> String {
        let (p, whose) = self.min_p();
        let (name, whose) = (printable(name), printable(whose));
        if self.pass {
            let sees = self.statistics.iter().filter(|judged| judged.kind == Kind::Scatter);
            let sees: Vec<String> = sees.map(|j| format!("{} {:.2}%", printable(&j.name), 100.0 * j.visible)).collect();
            let (tests, level) = (self.tests, self.level);
            return format!(
                "PASS {name} p={p:.1e} ({whose}) tests={tests} level={level:.1e} sees: {}\n",
                sees.join(", ")
            );
        }
        let mut failed: Vec<&Judged> = self.statistics.iter().filter(|judged| !judged.ok).collect();
        failed.sort_by(|a, b| a.p.total_cmp(&b.p));
        let mut words: Vec<String> = failed.iter().take(NAMED).map(|judged| self.failure(judged)).collect();
        if self.not_finite > 0 {
            words.insert(0, format!("{} samples are not finite", self.not_finite));
        }
        if failed.len() > NAMED {
            words.push(format!("{} more", failed.len() - NAMED));
        }
        format!("FAIL {name} {}\n", words.join("; "))
    }

    fn failure(&self, judged: &Judged) -> String {
        let Judged { name, difference, t, freedom, p, .. } = judged;
        let name = printable(name);
        match judged.scatter {
            Some(scatter) if *p >= self.level => {
                format!("{name} variance x {:.2} (p {:.1e} < {:.1e})", scatter.ratio, scatter.p, self.level)
            }
            _ => format!("{name} {:+.3}% (t {t:.2}, df {freedom}, p {p:.1e} < {:.1e})", 100.0 * difference, self.level),
        }
    }
}

fn line(table: &mut String, judged: &Judged, width: usize) {
    let Judged { name, reference, test, difference, t, freedom, p, visible, scatter, ok, .. } = judged;
    let name = printable(name);
    let _ = write!(
        table,
        "{name:<width$}{reference:>12.4e}{test:>12.4e}{:>+11.3}%{t:>8.2}{freedom:>5}{p:>10.1e}{:>9.3}%",
        100.0 * difference,
        100.0 * visible
    );
    if let Some(scatter) = scatter {
        let _ =
            write!(table, "  variance x {:.2}, p {:.1e}, visible x {:.1}", scatter.ratio, scatter.p, scatter.visible);
    }
    let _ = writeln!(table, "{}", if *ok { "" } else { "  FAIL" });
}
