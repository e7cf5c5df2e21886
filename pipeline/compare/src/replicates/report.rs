//! What was found, as a table for people and as JSON for programs.

use std::fmt::Write;

use cli::printable;
use serde::Serialize;

use super::judge::{FALSE_ALARM_RATE, Judged};
use super::{Kind, Summary};

/// Changes only when a key of the JSON report changes its meaning or goes.
const SCHEMA: u32 = 1;
/// Failures that the verdict names; the table has all.
const NAMED: usize = 3;

/// Everything that was tested. Numbers that are not finite become `null` in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseReport {
    /// Version of the keys.
    pub schema: u32,
    /// Replicates of the reference.
    pub reference_replicates: usize,
    /// Replicates that were judged.
    pub test_replicates: usize,
    /// Chance of a false alarm over all folders of the run.
    pub false_alarm_rate: f64,
    /// Folders of the run.
    pub family: usize,
    /// Tests in this folder.
    pub tests: usize,
    /// Level of each after Šidák's correction.
    pub level: f64,
    /// Samples that are NaN or infinite.
    pub not_finite: usize,
    /// All that was tested.
    pub statistics: Vec<Judged>,
    /// Names of what was not tested, with the reason.
    pub left_out: Vec<[String; 2]>,
    /// Whether everything passed.
    pub pass: bool,
}

impl NoiseReport {
    pub(super) fn new(
        reference: &Summary,
        test_replicates: usize,
        family: usize,
        tests: usize,
        level: f64,
        statistics: Vec<Judged>,
        not_finite: usize,
    ) -> NoiseReport {
        let left_out = reference.statistics.iter().filter_map(|s| Some([s.name.clone(), s.left_out.clone()?]));
        NoiseReport {
            schema: SCHEMA,
            reference_replicates: reference.count(),
            test_replicates,
            false_alarm_rate: FALSE_ALARM_RATE,
            family,
            tests,
            level,
            not_finite,
            pass: not_finite == 0 && !statistics.is_empty() && statistics.iter().all(|judged| judged.ok),
            statistics,
            left_out: left_out.collect(),
        }
    }

    /// The smallest chance among all tests, and whose it is; one that is no number counts as none at all.
    pub fn least(&self) -> (f64, &str) {
        let p = |judged: &Judged| {
            let scatter = judged.scatter.map_or(1.0, |scatter| scatter.p);
            if judged.p.is_nan() || scatter.is_nan() { 0.0 } else { judged.p.min(scatter) }
        };
        let all = self.statistics.iter().map(|judged| (p(judged), judged.name.as_str()));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, "nothing"))
    }

    /// A line per statistic.
    pub fn table(&self) -> String {
        let mut table = format!(
            "{} replicates against {} of the reference; {} tests, level {:.2e} each: {:.0e} over {} such folders\n",
            self.test_replicates, self.reference_replicates, self.tests, self.level, self.false_alarm_rate, self.family
        );
        let width = self.statistics.iter().map(|judged| printable(&judged.name).len()).max().unwrap_or(0);
        // Writing to a string cannot fail, here and below.
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
        table + "visible: the smallest bias that is found nine times in ten; of `noise`, only growth is tested\n"
    }

    /// One line: `PASS name` with the least chance and what could have been seen, or `FAIL name` with what differs.
    pub fn verdict(&self, name: &str) -> String {
        let (p, whose) = self.least();
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
