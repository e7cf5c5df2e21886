//! Errors of the models against random walks: `accuracy.md` and its pictures.

mod cases;
mod half_spaces;
mod images;
mod shapes;
mod slabs;
mod strips;

use crate::{error::Error, markdown::table, truth::Exact};
use std::{fs, path::Path};
use test_support::{transfer::scattered_reflectance, walk};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A minute, to try the program itself.
    Tiny,
    Whole,
}

impl Effort {
    fn of<T>(self, tiny: T, whole: T) -> T {
        match self {
            Effort::Tiny => tiny,
            Effort::Whole => whole,
        }
    }
}

/// Measures with the programs of a folder, and writes the report into `folder`; exact images are kept in `truths`.
pub fn write(programs: &Path, truths: &Path, effort: Effort, folder: &Path) -> Result<(), Error> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let exact = Exact::new(programs, truths, threads)?;
    let images = images::images(programs, &exact, effort, folder)?;
    let cases = cases::document(programs, &exact, effort)?;
    let slabs = slabs::document(effort)?;
    let parts = [
        INTRODUCTION,
        &images.summary,
        ADVICE,
        &images.text,
        &cases,
        &check_of_walks(effort),
        &half_spaces::document(effort),
        &slabs,
    ];
    let path = folder.join("accuracy.md");
    fs::write(&path, parts.concat().trim_end().to_owned() + "\n").map_err(Error::file(&path))
}

const INTRODUCTION: &str = "# Errors of the models

Made by `make accuracy`; do not edit. An image converges to what its model predicts, right or wrong: these are the errors
that no number of samples and paths removes. The reference are random walks in the medium behind the same smooth
boundary, without any approximation of the transport.

**Read this before you choose.** Five shapes and six media, images of converged models against exact ones:

";

const ADVICE: &str = "
relMSE is the mean over the object of (t - r)²/(r² + 0.01), where a white surface that faces the light has r = 1: 10⁻⁴ is
an error of about one per cent, 0.01 of ten. *Calibrated* is what `gather` does by default: the half-space model, times a
smooth factor that random walks measure on the shape.

* **Leave the default** unless you want to reproduce a published model. It is the only one that knows the shape.
* What the default misses most is the little light that is left behind a lit object of a medium that absorbs most of it: up
  to a third of the green and blue of ketchup.
* *Half-space* (`--bssrdf half-space --calibration none`) is right on planes, for any albedo, index and angle of the light,
  and costs no calibration. Where an object is thin beside the way that light travels, or lit from behind, it is not.
* The *dipoles* are wrong on planes as well (tables of half-spaces below). The directional one is too bright, by a quarter
  at high albedo and by orders of magnitude where most light is absorbed; the better one is within 7 per cent above a
  reduced albedo of 0.99 and too dark below, increasingly with absorption; the standard one is within 14 per cent for an
  index of 1.3, and up to half too bright for 1.5. `gather` warns when the reflectance of the chosen model is off by more
  than ten per cent for the chosen medium.
* Where a calibrated image is doubtful, `make truth` shows the exact one beside it.

";

/// The walks themselves against an exact solution.
fn check_of_walks(effort: Effort) -> String {
    let mut rows = Vec::new();
    for (k, (albedo, angle, eta)) in
        [(0.5, 0.0f64, 1.0), (0.9, 60.0, 1.0), (0.9, 0.0, 1.3), (0.9, 60.0, 1.5), (0.99, 30.0, 1.3)]
            .into_iter()
            .enumerate()
    {
        let cosine = angle.to_radians().cos();
        let exact = scattered_reflectance(albedo, eta, cosine);
        let matter = walk::Matter { albedo, asymmetry: 0.0, eta };
        let walks = effort.of(10_000, 1_000_000);
        let walked = walk::slab(&matter, f64::INFINITY, cosine, walks, 100 + k as u64).reflected;
        let difference = (walked.mean - exact) / walked.error;
        let numbers = [albedo, angle, eta].map(|x| x.to_string());
        let found =
            [format!("{exact:.5}"), format!("{:.5} ± {:.5}", walked.mean, walked.error), format!("{difference:+.1}")];
        rows.push(numbers.into_iter().chain(found).collect());
    }
    let text = "\n## Test of the random walk\n\nWhat a half-space of isotropic scatterers scatters back, by Chandrasekhar's \
                law of reflection (1950) with a smooth boundary, and\nby the walks of this report. Differences are in \
                standard errors:\n\n";
    text.to_owned() + &table(&["albedo", "angle", "index", "exact", "walk", "difference"], &rows) + "\n"
}
