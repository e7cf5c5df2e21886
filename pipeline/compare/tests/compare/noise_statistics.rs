//! Tests of replicates on synthetic images with known bias and variance.
//!
//! Seen to catch: Šidák's correction left out, or not over all folders; the error of the reference left out; a pooled
//! variance 25 times too small, which is that of pixels; the visible bias without the quantile of the power, or of
//! another level; variances tested on the wrong side.

use std::path::{Path, PathBuf};

use compare::replicates::{FALSE_ALARM_RATE, Judged, Kind, NoiseReport, Replicates, Summary, corrected_level, judge};

use crate::synthetic::{Fault, SOUND, replicate};

const FOLDER: &str = "synthetic";

fn group(first: u64, count: u64, fault: Fault) -> Replicates {
    let image = |seed| Ok((replicate(seed, fault), PathBuf::from(format!("{seed}.exr"))));
    Replicates::of(Path::new(FOLDER), (first..first + count).map(image)).unwrap()
}

fn reference(first: u64, count: u64) -> Summary {
    Summary::of(&group(first, count, SOUND), Path::new(FOLDER)).unwrap()
}

/// Tests eight replicates with a fault against sixteen without, all of new clouds.
fn run(number: u64, fault: Fault) -> NoiseReport {
    let first = 1000 * number;
    judge(&reference(first, 16), &group(first + 500, 8, fault), 1).unwrap()
}

/// A statistic in all runs in which it was not left out. One in fifty normally distributed statistics looks skewed.
fn of_all<'a>(reports: &'a [NoiseReport], name: &str) -> Vec<&'a Judged> {
    let found: Vec<&Judged> = reports.iter().flat_map(|r| r.statistics.iter().filter(|j| j.name == name)).collect();
    assert!(found.len() * 10 > reports.len() * 9, "{name}: left out too often");
    found
}

/// The tolerance for a binomial count: four standard deviations, which 6e-5 of all counts exceed. Seeds are fixed.
fn slack(runs: usize, chance: f64) -> f64 {
    4.0 * (runs as f64 * chance * (1.0 - chance)).sqrt()
}

fn uniform(name: &str, p: &[f64]) {
    for chance in [0.05, 0.5] {
        let below = p.iter().filter(|p| **p < chance).count() as f64;
        let expected = p.len() as f64 * chance;
        assert!((below - expected).abs() < slack(p.len(), chance), "{name}: {below} of {} below {chance}", p.len());
    }
}

#[test]
fn false_alarms_are_as_rare_as_promised() {
    const RUNS: u64 = 1000;
    let reports: Vec<NoiseReport> = (0..RUNS).map(|number| run(number, SOUND)).collect();
    // The p-value of each statistic is uniform, though all pixels share an error.
    for name in ["subsurface R", "subsurface R/G", "subsurface tile 0,1 R+G+B", "noise G"] {
        let p: Vec<f64> = of_all(&reports, name).iter().map(|judged| judged.p).collect();
        uniform(name, &p);
    }
    let scatter = of_all(&reports, "subsurface G");
    uniform("variance", &scatter.iter().map(|judged| judged.scatter.unwrap().p).collect::<Vec<f64>>());
    // The rate of all tests together is one in twenty; correlations of statistics make it smaller, never larger.
    let alarms = reports.iter().filter(|r| r.min_p().0 < 1.0 - 0.95f64.powf(1.0 / r.tests as f64)).count() as f64;
    assert!(alarms > 0.0 && alarms < RUNS as f64 * 0.05 + slack(RUNS as usize, 0.05), "{alarms} of {RUNS}");
    let failed = reports.iter().filter(|report| !report.pass).count();
    assert!(failed <= 5, "{failed} of {RUNS} fail where {FALSE_ALARM_RATE} of them should");
}

#[test]
fn the_level_holds_for_all_tests_of_all_folders_together() {
    let level = corrected_level(40, 5);
    assert!((1.0 - (1.0 - level).powi(200) - FALSE_ALARM_RATE).abs() < 1e-12);
    let report = run(1, SOUND);
    assert_eq!(report.level, corrected_level(report.tests, 1));
    let of_three = judge(&reference(1000, 16), &group(1500, 8, SOUND), 3).unwrap();
    assert!((report.level / of_three.level - 3.0).abs() < 2e-3);
}

/// Tests of 16 and 8 replicates have 22 degrees of freedom.
#[test]
fn the_visible_bias_is_seen_nine_times_in_ten() {
    const RUNS: u64 = 300;
    let brighter = |visible: f64| Fault { red: 1.0 + visible, ..SOUND };
    let darker = |visible: f64| Fault { red: 1.0 / (1.0 + visible), ..SOUND };
    let noisier = |visible: f64| Fault { claimed: (1.0 + visible).powi(2), ..SOUND };
    let faults: [(&str, &dyn Fn(f64) -> Fault); 3] =
        [("subsurface R", &brighter), ("subsurface R/G", &darker), ("noise R", &noisier)];
    let sound: Vec<NoiseReport> = (0..100).map(|number| run(number, SOUND)).collect();
    for (name, fault) in faults {
        let visible = of_all(&sound, name).iter().map(|judged| judged.visible).sum::<f64>();
        let visible = visible / of_all(&sound, name).len() as f64;
        let reports: Vec<NoiseReport> = (1000..1000 + RUNS).map(|number| run(number, fault(visible))).collect();
        let judged = of_all(&reports, name);
        assert!(judged.iter().all(|judged| judged.freedom == 22.0));
        let seen = judged.iter().filter(|judged| !judged.ok).count() as f64 / judged.len() as f64;
        println!("{name}: a bias of {visible:.4} is seen in {seen:.3} of the runs");
        // Four standard deviations of the share are 0.07; the rest is for the approximation of the noncentral t.
        assert!((seen - 0.9).abs() < 0.09, "{name}: a bias of {visible} is seen in {seen} of the runs");
    }
}

#[test]
fn noise_that_grew_is_found_and_noise_that_fell_is_not() {
    let reference = reference(1, 64);
    let failing = |fault: Fault, fails: fn(&NoiseReport, &Judged) -> bool| {
        let reports = (1..=20).map(|number| judge(&reference, &group(1000 * number, 8, fault), 1).unwrap());
        reports.filter(|report| report.statistics.iter().any(|judged| fails(report, judged))).count()
    };
    // The visible ratio of variances is about 13; this is 36.
    let scatter = |report: &NoiseReport, judged: &Judged| judged.scatter.is_some_and(|s| s.p < report.level);
    assert!(failing(Fault { scatter: 6.0, ..SOUND }, scatter) >= 18);
    assert_eq!(failing(SOUND, scatter), 0);
    // The noise that images claim is known to a few per cent.
    let claimed = |_: &NoiseReport, judged: &Judged| judged.kind == Kind::Noise && !judged.ok;
    assert!(failing(Fault { claimed: 1.5, ..SOUND }, claimed) >= 18);
    assert_eq!(failing(Fault { claimed: 0.1, scatter: 0.1, ..SOUND }, |_, judged| !judged.ok), 0);
}

/// The error of the cloud is four times that of a mean over its 49 pixels with independent errors, and six standard
/// errors are visible.
#[test]
fn pixels_that_share_an_error_are_no_evidence() {
    let report = run(1, SOUND);
    let own = crate::synthetic::OWN / 7.0 * (1.0f64 / 8.0 + 1.0 / 16.0).sqrt();
    let visible = |name: &str| of_all(std::slice::from_ref(&report), name)[0].visible;
    assert!(visible("subsurface R") > 20.0 * own);
    // Ratios of channels do not have the error of the cloud, which both channels share.
    assert!(visible("subsurface R/G") < 0.5 * visible("subsurface R"));
}
