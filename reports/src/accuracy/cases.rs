//! The hard cases: calibrated images against exact ones, and what was said of the error against what it is.

mod list;
mod scenes;

use crate::{
    accuracy::Effort,
    error::Error,
    markdown::table,
    program::Program,
    truth::{BLOCK, Exact, Scattered, Shot},
};
use list::CASES;
use scenes::Case;
use std::path::Path;

/// Red, green and blue.
type Channels = [f64; 3];

/// An image, or a calibration, before and with the factor.
struct Pair {
    before: Channels,
    after: Channels,
}

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
        let mut actual = Pair { before: [0.0; 3], after: [0.0; 3] };
        let calibration = calibration.display().to_string();
        for (view, ratio) in files.views.iter().zip(&mut ratios) {
            let side = self.effort.of(32, 128);
            let shot = Shot { scene: &files.scene, medium: &files.medium, shared: &files.shared, view, side };
            let truth = self.exact.truth(&shot, self.effort.of(4, case.paths))?;
            for (factor, sum) in [("none", &mut actual.before), (&*calibration, &mut actual.after)] {
                let arguments = with(shot.arguments(&cloud, &image), &["--calibration", factor]);
                gather.run(&arguments, &statistics)?;
                let shown = Scattered::read(&image)?;
                let error = truth.relative_mse(&shown, BLOCK, 1.0);
                sum.iter_mut().zip(error).for_each(|(sum, e)| *sum += 0.5 * e);
                *ratio = truth.ratio(&shown);
            }
        }
        let unresolved = said("unresolved_share").into_iter().fold(0.0, f64::max);
        let said = Pair { before: said("error_before"), after: said("error_after") };
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
there is an image. The images show the same surface from two sides. The last two columns are what was said over what is,
of the channel with the largest error. Where less than 10⁻³ is left, the statement is the floor of what facets, angles and
sixteen paths leave, and means \"small\".

";

fn images(measured: &[Measured]) -> String {
    let row = |m: &Measured| {
        let mean = |r: Channels| r.map(|x| format!("{x:.3}")).join(" ");
        let worst = |e: Channels| format!("{:.1e}", worst(e).1);
        let [front, back] = m.ratios;
        vec![m.case.what.to_owned(), mean(front), mean(back), worst(m.actual.before), worst(m.actual.after)]
    };
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    table(&["case", "mean, first side", "mean, other side", "relMSE without", "relMSE calibrated"], &rows)
}

fn statements(measured: &[Measured]) -> String {
    let row = |m: &Measured| {
        let number = |x: f64| format!("{x:.1e}");
        let columns = |said: Channels, actual: Channels| {
            let (channel, error) = worst(actual);
            let said = said[channel];
            ([number(said), number(error)], format!("{:.2}", said / error))
        };
        let (before, of_before) = columns(m.said.before, m.actual.before);
        let (after, of_after) = columns(m.said.after, m.actual.after);
        let unresolved = format!("{:.0} %", 100.0 * m.unresolved);
        [m.case.name.to_owned()]
            .into_iter()
            .chain(before)
            .chain(after)
            .chain([of_before, of_after, unresolved])
            .collect()
    };
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    let header = [
        "case",
        "was off, said",
        "was off",
        "is off, said",
        "is off",
        "said / is, before",
        "said / is, calibrated",
        "not resolved",
    ];
    table(&header, &rows)
}

/// The channel with the largest error, and the error.
fn worst(errors: Channels) -> (usize, f64) {
    let channel = (0..3).max_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap_or(0);
    (channel, errors[channel])
}
