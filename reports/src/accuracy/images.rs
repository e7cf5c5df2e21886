//! Images by the models against exact images of the same shapes and media.

use crate::{
    accuracy::{
        Effort,
        shapes::{SHAPES, Shape, shared},
        strips,
    },
    error::Error,
    markdown::table,
    program::Program,
    truth::{BLOCK, Exact, Scattered, Shot, Truth},
};
use bssrdf::built_in;
use std::{fs, path::Path};

/// The media of the images: liquids and solids of high and low albedo.
const MEDIA: [&str; 6] = ["skimmilk", "marble", "skin1", "skin2", "ketchup", "apple"];

/// The models with their arguments of `gather`; the last is its default.
const MODELS: [(&str, &[&str]); 5] = [
    ("directional", &["--bssrdf", "directional-dipole"]),
    ("better", &["--bssrdf", "better-dipole"]),
    ("standard", &["--bssrdf", "standard-dipole"]),
    ("half-space", &["--bssrdf", "half-space", "--calibration", "none"]),
    ("calibrated", &[]),
];

/// The shapes and media that are shown.
const SHOWN: [(&str, &str); 7] = [
    ("sphere", "skimmilk"),
    ("sphere", "ketchup"),
    ("chess", "marble"),
    ("piglet", "skin2"),
    ("bear", "apple"),
    ("sheet", "skin1"),
    ("sheet", "marble"),
];

/// One medium on one shape.
struct Measured {
    medium: &'static str,
    /// relMSE and mean light over that of the truth, of each model and channel.
    errors: [[f64; 3]; MODELS.len()],
    ratios: [[f64; 3]; MODELS.len()],
}

impl Measured {
    fn worst(&self, model: usize) -> f64 {
        self.errors[model].into_iter().fold(0.0, f64::max)
    }
}

/// What the images say, and in short.
pub struct Images {
    pub text: String,
    pub summary: String,
}

/// The programs, and where files go.
struct Studio<'a> {
    exact: &'a Exact,
    sample_surface: Program,
    gather: Program,
    effort: Effort,
    temporary: &'a Path,
}

impl Studio<'_> {
    /// Hands what is to be rendered of a medium on a shape to `then`.
    fn with_shot<T>(
        &self,
        shape: &Shape,
        medium: &str,
        then: impl FnOnce(&Shot) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let of_medium = built_in(medium).map_err(|e| Error::Usage(e.to_string()))?;
        let files = shape.write(&of_medium, self.temporary)?;
        let (shared, side) = (shared(), self.effort.of(32, 128));
        then(&Shot { scene: &files.scene, medium, shared: &shared, view: &files.view, side })
    }

    /// The truth of a medium on a shape.
    fn truth(&self, shape: &Shape, medium: &str) -> Result<Truth, Error> {
        self.with_shot(shape, medium, |shot| self.exact.truth(shot, self.effort.of(4, shape.exact_paths)))
    }

    /// An image by each model of a medium on a shape.
    fn images(&self, shape: &Shape, medium: &str) -> Result<[Scattered; MODELS.len()], Error> {
        self.with_shot(shape, medium, |shot| {
            let [cloud, image, statistics] = ["cloud", "exr", "stats"].map(|name| self.temporary.join(name));
            let mut sampling = [shot.scene, Path::new("-o"), &cloud].map(|p| p.display().to_string()).to_vec();
            sampling.extend(["--samples".into(), self.effort.of(20_000, 1_000_000).to_string()]);
            sampling.extend_from_slice(shot.shared);
            self.sample_surface.run(&sampling, &statistics)?;
            let rendered = |(_, own): &(&str, &[&str])| {
                let mut arguments = shot.arguments(&cloud, &image);
                arguments.extend(["--spp".into(), self.effort.of(4, 64).to_string()]);
                arguments.extend(own.iter().map(|a| (*a).to_owned()));
                self.gather.run(&arguments, &statistics)?;
                Scattered::read(&image)
            };
            let images = MODELS.iter().map(rendered).collect::<Result<Vec<_>, _>>()?;
            fs::remove_file(&cloud).map_err(Error::file(&cloud))?;
            Ok(images.try_into().expect("there are as many images as models"))
        })
    }
}

/// Measures all shapes and media, and writes the pictures into `folder`.
pub fn images(programs: &Path, exact: &Exact, effort: Effort, folder: &Path) -> Result<Images, Error> {
    let temporary = tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?;
    let [sample_surface, gather] = ["sample-surface", "gather"].map(|name| Program::of(programs, name));
    let (sample_surface, gather) = (sample_surface?, gather?);
    let studio = Studio { exact, sample_surface, gather, effort, temporary: temporary.path() };
    let media = &MEDIA[..effort.of(1, MEDIA.len())];
    // Exact images come first: they are kept, whatever happens to the rest.
    for shape in SHAPES {
        for medium in media {
            eprintln!("exact: {} of {medium}", shape.name);
            studio.truth(&shape, medium)?;
        }
    }
    let mut text = INTRODUCTION.to_owned();
    let mut all = Vec::new();
    for shape in SHAPES {
        let mut rows = Vec::new();
        let mut pictures = String::new();
        for &medium in media {
            eprintln!("models: {} of {medium}", shape.name);
            let (truth, images) = (studio.truth(&shape, medium)?, studio.images(&shape, medium)?);
            if SHOWN.contains(&(shape.name, medium)) {
                let name = format!("accuracy-{}-{medium}.png", shape.name);
                let path = folder.join(&name);
                let named: Vec<_> = MODELS.iter().map(|(name, _)| *name).zip(&images).collect();
                let strip = strips::strip(&truth.mean(), &named).map_err(|e| Error::Usage(e.to_string()))?;
                fs::write(&path, strip).map_err(Error::file(&path))?;
                pictures += &format!("\n{} of {medium}:\n\n![{0} of {medium}]({name})\n", shape.name);
            }
            let errors = images.each_ref().map(|image| truth.relative_mse(image, BLOCK, 1.0));
            let ratios = images.each_ref().map(|image| truth.ratio(image));
            rows.push(Measured { medium, errors, ratios });
        }
        text += &format!("{}{pictures}\n", section(&shape, &rows));
        all.extend(rows.into_iter().map(|row| (shape.name, row)));
    }
    Ok(Images { text, summary: summary(&all) })
}

const INTRODUCTION: &str = "## Images

Exact images are random walks inside the mesh (`gather --reference`), two of independent seeds, so that their noise does
not count. Images of models: 1M samples, 64 paths for each pixel; all of 128 x 128 pixels, of which only scattered light
is compared. Each shape stands alone under one sun with an irradiance of π, so that a white Lambertian surface that faces
it has radiance 1.

Each cell is the relMSE of the worst channel, means of blocks of 4 x 4 pixels, and in brackets the mean light over that
of the truth, red, green, blue. In pictures, the first is the truth; below each model is its signed error relative to
√(truth² + 0.1²), the mean of the channels, in blocks of 4 x 4: red where the model is brighter, blue where it is darker,
full color at 50 %.

";

fn section(shape: &Shape, rows: &[Measured]) -> String {
    let header: Vec<&str> = ["medium"].into_iter().chain(MODELS.map(|(name, _)| name)).collect();
    let cells = |row: &Measured| {
        let cell = |k: usize| {
            let ratios = row.ratios[k].map(|r| format!("{r:.2}")).join(" ");
            format!("{} ({ratios})", small(row.worst(k)))
        };
        [row.medium.to_owned()].into_iter().chain((0..MODELS.len()).map(cell)).collect()
    };
    let lines: Vec<Vec<String>> = rows.iter().map(cells).collect();
    format!("### {}\n\n{}\n\n{}", shape.name, shape.what, table(&header, &lines))
}

/// A relMSE with two significant digits.
fn small(x: f64) -> String {
    match x {
        x if x >= 9.95 => format!("{x:.0}"),
        x if x >= 0.0095 => format!("{x:.*}", (1 - x.log10().floor() as i32).clamp(0, 3) as usize),
        x => format!("{x:.1e}"),
    }
}

/// Median and worst of each model, as a table.
fn summary(all: &[(&str, Measured)]) -> String {
    let row = |k: usize| {
        let mut errors: Vec<(f64, String)> =
            all.iter().map(|(shape, row)| (row.worst(k), format!("{shape} of {}", row.medium))).collect();
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ratios = || all.iter().flat_map(|(_, row)| row.ratios[k]);
        let (darkest, brightest) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
        let mut off: Vec<f64> = ratios().map(|r| (r - 1.0).abs()).collect();
        off.sort_by(f64::total_cmp);
        let (worst, which) = &errors[errors.len() - 1];
        vec![
            MODELS[k].0.to_owned(),
            small(errors[errors.len() / 2].0),
            format!("{} ({which})", small(*worst)),
            format!("{:.1} %", 100.0 * off[off.len() / 2]),
            format!("{darkest:.2} to {brightest:.2}"),
        ]
    };
    let rows: Vec<Vec<String>> = (0..MODELS.len()).map(row).collect();
    let header = [
        "model",
        "relMSE, median",
        "relMSE, worst",
        "mean light off by, median",
        "mean light over truth, all channels",
    ];
    table(&header, &rows)
}
