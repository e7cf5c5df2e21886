//! `scale.md`: what sampling and gathering cost in processor time, memory and files, from runs of many sizes; how well
//! that predicts runs of other sizes; and what it says of farms.

use crate::{
    error::Error,
    findings::{count, percent, table, three},
    forecast,
    linear::Linear,
    program::{Program, Spent},
};
use std::{
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// A cloud, and a call of `gather` for `views` images of it, wide as they are high or wider.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub samples: f64,
    pub width: u64,
    pub height: u64,
    pub spp: u64,
    pub views: u64,
}

const fn size(samples: f64, [width, height]: [u64; 2], spp: u64, views: u64) -> Size {
    Size { samples, width, height, spp, views }
}

/// What the model is fitted to: each part of it weighs most in one of them.
const FITTED: [Size; 16] = [
    size(1e5, [16, 16], 4, 1),
    size(1e5, [16, 16], 4, 40),
    size(1e5, [192, 192], 4, 1),
    size(1e5, [192, 192], 64, 1),
    size(3e5, [256, 256], 4, 1),
    size(3e5, [64, 64], 16, 10),
    size(1e5, [1024, 64], 64, 1),
    size(1e6, [64, 64], 4, 10),
    size(1e6, [192, 192], 16, 1),
    size(1e6, [384, 384], 4, 1),
    size(3e6, [16, 16], 4, 1),
    size(3e6, [192, 192], 64, 1),
    size(1e7, [16, 16], 4, 1),
    size(1e7, [192, 192], 4, 1),
    size(1e7, [192, 192], 16, 1),
    size(1e7, [128, 128], 64, 1),
];

/// What it is held against: within the range of the others, and beyond it.
const CHECKED: [Size; 3] = [size(2e5, [200, 150], 8, 12), size(2e6, [512, 384], 4, 1), size(2e7, [800, 450], 16, 1)];

/// Runs of one size, of which the mean is taken: ticks of the clock are 10 ms.
const RUNS: usize = 3;

impl Size {
    fn pixels(&self) -> f64 {
        (self.width * self.height * self.views) as f64
    }

    /// Pixels of the middle squares of all images, which hold what is translucent.
    fn inner(&self) -> f64 {
        (self.height * self.height * self.views) as f64
    }

    fn paths(&self) -> f64 {
        self.inner() * self.spp as f64
    }

    fn text(&self) -> String {
        let views = if self.views == 1 { String::new() } else { format!("{} views of ", self.views) };
        format!("K {}, {views}{} x {}, {} paths", count(self.samples as u64), self.width, self.height, self.spp)
    }
}

/// One figure of a run: what it is, how it is written, and what it is made of.
struct Figure {
    name: &'static str,
    unit: &'static str,
    /// Units a second, byte, ...
    scale: f64,
    parts: &'static [Part],
}

/// A part of a cost: its name, and how much of it a run has.
type Part = (&'static str, fn(&Size) -> f64);

const START: Part = ("start", |_| 1.0);
const SAMPLE: Part = ("sample", |size| size.samples);
const IMAGE: Part = ("image", |size| size.views as f64);
/// All but the figure's own square are background.
const PIXEL: Part = ("pixel", Size::pixels);
const PIXEL_OF_ONE: Part = ("pixel of one image", |size| (size.width * size.height) as f64);
const INNER: Part = ("pixel of the middle square", Size::inner);
const OUTER: Part = ("path beside the middle square", |size| (size.pixels() - size.inner()) * size.spp as f64);
/// Pixels at edges take more rays.
const EDGE: Part = ("path of a row of the middle square", |size| (size.height * size.views * size.spp) as f64);
const PATH: Part = ("path of the middle square", Size::paths);
const LEVEL: Part = ("such a path and doubling of K from 10k on", |size| size.paths() * (size.samples / 1e4).log2());
/// How finely a path cuts: its own share of the accuracy is the larger the more paths a pixel has.
const CUT: Part = ("such a path x (K / 10k)^(1/3) / (paths a pixel)^(3/4)", |size| {
    size.paths() * (size.samples / 1e4).cbrt() * (size.spp as f64).powf(-0.75)
});

const FIGURES: [Figure; 6] = [
    Figure { name: "sampling, processor", unit: "s", scale: 1.0, parts: &[START, SAMPLE] },
    Figure { name: "sampling, memory", unit: "MB", scale: 1e6, parts: &[START, SAMPLE] },
    Figure { name: "cloud, file", unit: "MB", scale: 1e6, parts: &[START, SAMPLE] },
    Figure {
        name: "gather, processor",
        unit: "s",
        scale: 1.0,
        parts: &[START, SAMPLE, IMAGE, PIXEL, OUTER, EDGE, PATH, LEVEL, CUT],
    },
    Figure { name: "gather, memory", unit: "MB", scale: 1e6, parts: &[START, SAMPLE, PIXEL_OF_ONE] },
    Figure { name: "images, files", unit: "MB", scale: 1e6, parts: &[IMAGE, INNER, PIXEL] },
];

/// The fitted costs of a run, in the order of `FIGURES`.
pub struct Model(Vec<Linear>);

impl Model {
    fn fit(measured: &[(Size, [f64; 6])]) -> Model {
        let fit = |k: usize| {
            let row = |(size, costs): &(Size, [f64; 6])| (FIGURES[k].amounts(size), costs[k]);
            Linear::fit(&measured.iter().map(row).collect::<Vec<_>>())
        };
        Model((0..FIGURES.len()).map(fit).collect())
    }

    /// Seconds of one processor, bytes of memory, bytes of the file.
    pub fn sampling(&self, size: &Size) -> [f64; 3] {
        [0, 1, 2].map(|k| self.at(k, size))
    }

    /// Seconds of one processor, bytes of memory (the mapped cloud included), bytes of all images.
    pub fn gather(&self, size: &Size) -> [f64; 3] {
        [3, 4, 5].map(|k| self.at(k, size))
    }

    fn at(&self, k: usize, size: &Size) -> f64 {
        self.0[k].at(&FIGURES[k].amounts(size))
    }

    fn table(&self) -> String {
        let mut rows = Vec::new();
        for (figure, fitted) in FIGURES.iter().zip(&self.0) {
            for ((part, _), c) in figure.parts.iter().zip(&fitted.coefficients) {
                let value =
                    if figure.unit == "s" { format!("{} µs", three(1e6 * c)) } else { format!("{} bytes", three(*c)) };
                rows.push(vec![figure.name.into(), (*part).into(), value]);
            }
        }
        table(&["cost", "of each", "is"], &rows)
    }
}

impl Figure {
    fn amounts(&self, size: &Size) -> Vec<f64> {
        self.parts.iter().map(|(_, amount)| amount(size)).collect()
    }
}

/// Measures, and returns the text of `scale.md`.
pub fn scale(programs: &Path, data: &Path) -> Result<String, Error> {
    let farm = Farm::new(programs, data)?;
    let measure = |sizes: &[Size]| -> Result<Vec<(Size, [f64; 6])>, Error> {
        sizes.iter().map(|size| Ok((*size, farm.mean(size)?))).collect()
    };
    let (fitted, checked) = (measure(&FITTED)?, measure(&CHECKED)?);
    let model = Model::fit(&fitted);
    Ok(format!(
        "{HEAD}\n{}\n{CHECK}\n{}\n{}",
        model.table(),
        comparison(&model, &fitted, &checked),
        forecast::text(&model)
    ))
}

/// What the model says beside what was measured.
fn comparison(model: &Model, fitted: &[(Size, [f64; 6])], checked: &[(Size, [f64; 6])]) -> String {
    let error = |size: &Size, costs: &[f64; 6], k: usize| model.at(k, size) / costs[k] - 1.0;
    let mut rows = Vec::new();
    for (size, costs) in checked {
        for (k, figure) in FIGURES.iter().enumerate() {
            let said = [model.at(k, size), costs[k]].map(|x| format!("{} {}", three(x / figure.scale), figure.unit));
            let mut row = vec![size.text(), figure.name.into()];
            row.extend(said);
            row.push(percent(error(size, costs, k)));
            rows.push(row);
        }
    }
    let all = |runs: &[(Size, [f64; 6])]| {
        let errors = runs.iter().flat_map(|(size, costs)| (0..FIGURES.len()).map(move |k| error(size, costs, k).abs()));
        errors.fold(0.0, f64::max)
    };
    let (worst, own) = (percent(all(checked)), percent(all(fitted)));
    let verdict = format!("The worst of them is off by {worst}; of the runs that it was fitted to, by {own}.\n");
    format!("{}\n{verdict}", table(&["run", "what", "model", "measured", "off by"], &rows))
}

const HEAD: &str = "\
# Past one machine

Made by `make scale`; do not edit. `data/scenes/figure.glb` (its front view, skin1, all settings as they are by default) on \
one thread. The figure fills most of the middle square of an image; a wide one has floor and background beside it.

What a run costs is the sum of these. Seconds are of one processor, user and system.
";

const CHECK: &str = "\
The model against runs of other sizes than those it was fitted to (K of 100k to 10M, images up to 384 x 384, 4 to 64 paths a pixel):
";

/// The programs, the scene, and a place to work.
struct Farm {
    sample_surface: Program,
    gather: Program,
    scene: PathBuf,
    view: String,
    folder: TempDir,
}

impl Farm {
    fn new(programs: &Path, data: &Path) -> Result<Farm, Error> {
        let view = data.join("views/figure/front.json");
        Ok(Farm {
            sample_surface: Program::of(programs, "sample-surface")?,
            gather: Program::of(programs, "gather")?,
            scene: data.join("scenes/figure.glb"),
            view: fs::read_to_string(&view).map_err(Error::file(&view))?,
            folder: tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?,
        })
    }

    /// The costs of a size, in the order of `FIGURES`.
    fn mean(&self, size: &Size) -> Result<[f64; 6], Error> {
        eprintln!("scale: {}", size.text());
        let mut sum = [0.0; 6];
        for seed in 0..RUNS {
            let costs = self.run(size, &seed.to_string())?;
            sum.iter_mut().zip(costs).for_each(|(sum, cost)| *sum += cost / RUNS as f64);
        }
        Ok(sum)
    }

    fn run(&self, size: &Size, seed: &str) -> Result<[f64; 6], Error> {
        let path = |name: &str| self.folder.path().join(name).display().to_string();
        let (cloud, scene, views) = (path("a.cloud"), self.scene.display().to_string(), path("views.json"));
        let numbers = [size.samples as u64, size.width, size.height, size.spp];
        let [samples, width, height, spp] = numbers.map(|n| n.to_string());
        let both = ["--seed", seed, "--threads", "1", "-o"];
        let run = |program: &Program, words: &[&str], last: &str| {
            let words: Vec<String> = words.iter().map(|w| (*w).to_owned()).collect();
            program.run_list(&words, Path::new(&path("run.json")), Path::new(&path(last)))
        };
        let words = [&[scene.as_str(), "--samples", &samples], &both[..], &[&cloud]].concat();
        let sampling = run(&self.sample_surface, &words, "run.json")?;
        let file = bytes(Path::new(&cloud))?;
        self.write_views(Path::new(&views), size.views)?;
        let image = ["--view", &views, "--width", &width, "--height", &height, "--spp", &spp, "--medium", "skin1"];
        let output = path("image.exr");
        let words = [&[cloud.as_str(), &scene], &image[..], &both, &[&output]].concat();
        let last = if size.views == 1 { "run.json".into() } else { format!("run.{:04}.json", size.views - 1) };
        let gathering = run(&self.gather, &words, &last)?;
        let images = self.take_images()?;
        let memory = |spent: &Spent| spent.number("peak_memory_bytes").unwrap_or(f64::NAN);
        Ok([sampling.cpu, memory(&sampling), file, gathering.cpu, memory(&gathering), images])
    }

    /// A view file: one view, or a list of it as often as that.
    fn write_views(&self, path: &Path, views: u64) -> Result<(), Error> {
        let text = match views {
            1 => self.view.clone(),
            _ => format!("[{}]", vec![self.view.as_str(); views as usize].join(",")),
        };
        fs::write(path, text).map_err(Error::file(path))
    }

    /// Bytes of all images, which are removed.
    fn take_images(&self) -> Result<f64, Error> {
        let mut sum = 0.0;
        for entry in self.folder.path().read_dir().map_err(Error::file(self.folder.path()))? {
            let path = entry.map_err(Error::file(self.folder.path()))?.path();
            if path.extension().is_some_and(|e| e == "exr") {
                sum += bytes(&path)?;
                fs::remove_file(&path).map_err(Error::file(&path))?;
            }
        }
        Ok(sum)
    }
}

fn bytes(path: &Path) -> Result<f64, Error> {
    Ok(fs::metadata(path).map_err(Error::file(path))?.len() as f64)
}
