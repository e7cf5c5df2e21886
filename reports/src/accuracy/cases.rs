//! The hard cases: calibrated images against exact ones, and what was said of the error against what it is.

mod list;
mod scenes;

use crate::{
    accuracy::Effort,
    error::Error,
    markdown::table,
    program::Program,
    truth::{BLOCK, Estimate, Exact, Scattered, Shot},
};
use list::CASES;
use scenes::Case;
use std::path::Path;

/// Red, green and blue.
type Channels = [f64; 3];

/// relMSE of each channel of an image, or by a calibration, before and with the factor.
struct Pair {
    before: [Estimate; 3],
    after: [Estimate; 3],
}

const NONE: [Estimate; 3] = [Estimate { mean: 0.0, error: 0.0 }; 3];

/// One case.
struct Measured {
    case: &'static Case,
    /// Mean light of the calibrated image over that of the truth, from each side.
    ratios: [Channels; 2],
    /// relMSE of both sides together, and what `calibrate` said of it.
    actual: Pair,
    said: Pair,
    /// Share of the surface that the calibration does not resolve, of the worst channel.
    unresolved: f64,
}

/// The programs, and where files go.
struct Bench<'a> {
    exact: &'a Exact,
    programs: [Program; 3],
    effort: Effort,
    temporary: &'a Path,
}

/// Measures all cases, and writes of them in Markdown.
pub fn document(programs: &Path, exact: &Exact, effort: Effort) -> Result<String, Error> {
    let temporary = tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?;
    let [sample_surface, calibrate, gather] =
        ["sample-surface", "calibrate", "gather"].map(|name| Program::of(programs, name));
    let programs = [sample_surface?, calibrate?, gather?];
    let bench = Bench { exact, programs, effort, temporary: temporary.path() };
    let measured = CASES.iter().map(|case| bench.measure(case)).collect::<Result<Vec<_>, _>>()?;
    Ok(format!("{INTRODUCTION}{}{SAID}{}", images(&measured), statements(&measured)))
}

impl Bench<'_> {
    fn measure(&self, case: &'static Case) -> Result<Measured, Error> {
        eprintln!("{}", case.what);
        let files = case.write(self.temporary)?;
        let [cloud, calibration, image, statistics] =
            ["cloud", "calibration", "exr", "stats"].map(|name| self.temporary.join(name));
        let [sample_surface, calibrate, gather] = &self.programs;
        let common = |inputs: &[&Path], output: &Path| {
            let mut arguments: Vec<String> = inputs.iter().map(|p| p.display().to_string()).collect();
            arguments.extend(["-o".to_owned(), output.display().to_string()]);
            arguments.extend_from_slice(&files.shared);
            arguments
        };
        let with = |mut arguments: Vec<String>, more: &[&str]| {
            arguments.extend(more.iter().map(|a| (*a).to_owned()));
            arguments
        };
        let samples = self.effort.of(20_000, 400_000).to_string();
        sample_surface.run(&with(common(&[&files.scene], &cloud), &["--samples", &samples]), &statistics)?;
        let inputs: [&Path; 2] = [&cloud, &files.scene];
        let walks = self.effort.of(20_000, 300_000).to_string();
        let own = with(common(&inputs, &calibration), &["--medium", &files.medium, "--walks", &walks]);
        let calibrated = calibrate.run(&own, &statistics)?.statistics;
        let said = |what: &str| [0, 1, 2].map(|c| calibrated["materials"][0][what][c].as_f64().unwrap_or(f64::NAN));
        let mut ratios = [Channels::default(); 2];
        let mut sides = [Pair { before: NONE, after: NONE }, Pair { before: NONE, after: NONE }];
        let calibration = calibration.display().to_string();
        for ((view, ratio), Pair { before, after }) in files.views.iter().zip(&mut ratios).zip(&mut sides) {
            let side = self.effort.of(32, 128);
            let shot = Shot { scene: &files.scene, medium: &files.medium, shared: &files.shared, view, side };
            let truth = self.exact.truth(&shot, self.effort.of(4, case.paths))?;
            for (factor, errors) in [("none", before), (&*calibration, after)] {
                let arguments = with(shot.arguments(&cloud, &image), &["--calibration", factor]);
                gather.run(&arguments, &statistics)?;
                let shown = Scattered::read(&image)?;
                *errors = truth.estimated_mse(&shown, BLOCK, 1.0);
                *ratio = truth.ratio(&shown);
            }
        }
        let [front, back] = sides;
        let both = |a: [Estimate; 3], b: [Estimate; 3]| [0, 1, 2].map(|c| Estimate::mean_of([a[c], b[c]]));
        let actual = Pair { before: both(front.before, back.before), after: both(front.after, back.after) };
        let unresolved = said("unresolved_share").into_iter().fold(0.0, f64::max);
        let estimates =
            |means: Channels, errors: Channels| [0, 1, 2].map(|c| Estimate { mean: means[c], error: errors[c] });
        let said = Pair {
            before: estimates(said("error_before"), [0.0; 3]),
            after: estimates(said("error_after"), said("error_uncertainty")),
        };
        Ok(Measured { case, ratios, actual, said, unresolved })
    }
}

const INTRODUCTION: &str = "## Hard cases

Calibrated images of the half-space model, with the defaults of the programs (16 paths for each pixel, 300k walks) and
400k samples, against exact ones. Each object is seen from two opposite sides, 128 x 128 pixels: the first is the side of
the camera for which the light was placed. The mean is that of the image over that of the truth, red, green, blue; relMSE
is of blocks of 4 x 4 pixels of both sides together, worst channel, without any calibration and with it. Noise of a few
10⁻⁵ is left in it, more with lamps that walks have to meet (`area`, `sky`), so that a small value may be below zero.

Without absorption and in a constant environment (`white`), what leaves is what enters, so that the mean is also that of
the energy.

";

const SAID: &str = "
### What is said of the error

`calibrate` says by how much the model was off, and what is left: relMSE over the whole surface, which it can say before
there is an image. The images show the same surface from two sides. The columns are those of the channel with the largest
error that is left; the last but one says in how many of the three channels the one is within a factor of two of the
other, given the standard errors of both.

What is said is too low where the images show what walks do not: smooth normals over flat triangles (`normals`), and a
misfit of less than three standard errors (`sheet`). The images of `ear` show that part alone, of a whole piglet that is
calibrated. Of small lamps close by (`point`, `area`) it is too high. Below its ± (`constant`, `sky`, `white`) it says no
more than that.

";

fn images(measured: &[Measured]) -> String {
    let row = |m: &Measured| {
        let mean = |r: Channels| r.map(|x| format!("{x:.3}")).join(" ");
        let largest = |e: [Estimate; 3]| format!("{:.1e}", e[worst(e)].mean);
        let [front, back] = m.ratios;
        vec![m.case.what.to_owned(), mean(front), mean(back), largest(m.actual.before), largest(m.actual.after)]
    };
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    table(&["case", "mean, first side", "mean, other side", "relMSE without", "relMSE calibrated"], &rows)
}

fn statements(measured: &[Measured]) -> String {
    let row = |m: &Measured| {
        let c = worst(m.actual.after);
        let number = |x: f64| format!("{x:.1e}");
        let both = |e: Estimate| format!("{:.1e} ± {:.0e}", e.mean, e.error);
        let (said, actual) = (&m.said, &m.actual);
        let agreeing = (0..3).filter(|c| are_within_two(said.after[*c], actual.after[*c])).count();
        vec![
            m.case.name.to_owned(),
            number(said.before[c].mean),
            number(actual.before[c].mean),
            both(said.after[c]),
            both(actual.after[c]),
            format!("{:.2}", said.after[c].mean / actual.after[c].mean),
            format!("{agreeing} of 3"),
            format!("{:.0} %", 100.0 * m.unresolved),
        ]
    };
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    let header = [
        "case",
        "was off, said",
        "was off",
        "is off, said",
        "is off",
        "said / is",
        "within a factor of two",
        "not resolved",
    ];
    table(&header, &rows)
}

/// Whether some values within the standard errors of both are within a factor of two.
fn are_within_two(a: Estimate, b: Estimate) -> bool {
    let reaches = |a: Estimate, b: Estimate| 2.0 * (a.mean + a.error) >= b.mean - b.error;
    reaches(a, b) && reaches(b, a)
}

/// The channel with the largest error.
fn worst(errors: [Estimate; 3]) -> usize {
    (0..3).max_by(|a, b| errors[*a].mean.total_cmp(&errors[*b].mean)).unwrap_or(0)
}
