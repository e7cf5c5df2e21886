//! `speed.md`: targets, plots, tables, and how it was measured.

use crate::{
    markdown::{table, time},
    speed::{
        effort::Effort,
        findings::{Findings, Target},
        harness::Harness,
        plot::Plot,
    },
};

/// The text of `speed.md`.
pub fn document(harness: &Harness, findings: &Findings, remarks: &[String]) -> String {
    let command = harness.effort.of("curve --tiny", "make curve", "make curve-full");
    let mut text = format!(
        "# Time against error\n\nMade by `{command}`; do not edit. Raw data: [speed.csv](speed.csv). Relative RMSE is \
         of whole images and includes the error of the cloud; time is of whole processes, sampling included.\n\n"
    );
    if harness.effort == Effort::Tiny {
        text += "**This was a trial of the program itself: its figures mean nothing.**\n\n";
    }
    text += &format!("## Targets\n\n{}\n{WHY}\n", targets(&findings.targets));
    for section in &findings.sections {
        let image = |(name, plot): &(String, Plot)| format!("![{}](speed-{name}.svg)\n\n", plot.title);
        let image = section.plot.as_ref().map_or(String::new(), image);
        text += &format!("## {}\n\n{image}{}\n", section.title, section.text);
    }
    text + &method(harness, remarks)
}

fn targets(all: &[Target]) -> String {
    let verdict = |t: &Target| t.met.map_or("not measured", |met| if met { "met" } else { "**not met**" }).to_owned();
    let how = |t: &Target| if t.met.is_none() && t.basis == "measured" { "–".into() } else { t.basis.clone() };
    let row = |t: &Target| vec![t.what.clone(), t.wanted.clone(), t.found.clone(), verdict(t), how(t)];
    table(&["target", "wanted", "found", "", "how"], &all.iter().map(row).collect::<Vec<_>>())
}

fn method(harness: &Harness, remarks: &[String]) -> String {
    let rows: Vec<_> = harness
        .configurations
        .iter()
        .map(|c| {
            let gather = c.gather_flags(&crate::speed::configuration::MARBLE).join(" ");
            vec![c.name.to_owned(), format!("`{}`", c.sample_flags().join(" ")), format!("`{gather}`")]
        })
        .collect();
    let remarks: String = remarks.iter().chain(&harness.remarks).map(|r| format!("* {r}\n")).collect();
    format!(
        "## How it was measured\n\n{}, {} threads unless stated; {} runs in {}.\n\n{}\n\
         The note's roulette takes `mean` as in the note, and `mixture` for ketchup and skin1, where `mean` has no \
         finite variance.\n\n{METHOD}\n{remarks}",
        processor(),
        harness.threads,
        harness.records.len(),
        time(harness.elapsed()),
        table(&["configuration", "sample-surface", "gather"], &rows),
    )
}

/// Explanations of the figures above.
const WHY: &str = "\
Lines of the plots of races are a model's, fitted to few paths a pixel; dots are runs. With ten paths and \
more the cut's own share (`--accuracy`) remains, so runs err more than the model says: the tables of runs are the \
measure. With the cut comes the near field, points drawn around the exitant point where samples lie too far apart. A \
hundred million **samples** are 2.7 GB, which `gather` reads once to check them before it renders.
";

const METHOD: &str = "\
* **Model**: races and clouds compare sums of the directional dipole, the note's, without a calibration. Sections on \
the truth, sizes, other renderers, the frame, the growth and the accuracy have the half-space model, the programs' own.
* **References** are means of four or more images of independent clouds and paths, seeds from 1000, which nothing else \
uses. Their own squared error, from their spread, is subtracted.
* **Errors of clouds**: a few clouds (seeds from 1), each gathered under the seeds 1 and 2. Differences of two clouds \
under one seed, times those under the other, share nothing but the clouds.
* **Errors of paths**: what the seeds 1 and 2 of the gather differ by on one cloud; at K = 1M another estimator stands \
for the roulette, whose own share is nothing there.
* **The model**: squared error `v/paths^q + c(K)²`, with `c` a power law of K, `v` a line in 1/K, and `q` measured (1 \
if the paths of a pixel are independent of each other); seconds `a + b K` for the sampling and for opening the cloud, \
and pixels times paths times `f + g K` for sums that look at every sample, or times a power of K for the tree. Times \
to an error are its least over K and paths. The note's times to 2 % and 1 % are extrapolated so, by the measured \
slopes; ours are run wherever the table says measured.
* **Runs** of the model's points have seeds from 100, other than those it was fitted to.
";

/// The processor's name, where the system tells.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split_once(':'));
    name.map_or("An unknown processor".into(), |(_, name)| name.trim().to_owned())
}
