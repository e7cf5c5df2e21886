//! Runs of `sample-surface` and `gather` of many sizes, and their costs.

use crate::{
    error::Error,
    program::{Program, Spent},
    scale::cost::Size,
};
use std::{
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// Number of runs of one size, whose mean is taken: the clock ticks in 10 ms.
const RUNS: usize = 3;

/// The programs, the scene, and a working folder.
pub struct Farm {
    sample_surface: Program,
    gather: Program,
    scene: PathBuf,
    view: String,
    folder: TempDir,
}

impl Farm {
    pub fn new(programs: &Path, data: &Path) -> Result<Farm, Error> {
        let view = data.join("views/figure/front.json");
        Ok(Farm {
            sample_surface: Program::of(programs, "sample-surface")?,
            gather: Program::of(programs, "gather")?,
            scene: data.join("scenes/figure.glb"),
            view: fs::read_to_string(&view).map_err(Error::file(&view))?,
            folder: tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?,
        })
    }

    /// Mean costs of runs of one size, in the order of `FIGURES`.
    pub fn mean(&self, size: &Size) -> Result<[f64; 6], Error> {
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
        let image = ["--view", &views, "--width", &width, "--height", &height, "--spp", &spp];
        let light = ["--medium", "skin1", "--calibration", "none"];
        let output = path("image.exr");
        let words = [&[cloud.as_str(), &scene], &image[..], &light, &both, &[&output]].concat();
        let last = if size.views == 1 { "run.json".into() } else { format!("run.{:04}.json", size.views - 1) };
        let gathering = run(&self.gather, &words, &last)?;
        let images = self.take_images()?;
        let memory = |spent: &Spent| spent.number("peak_memory_bytes").unwrap_or(f64::NAN);
        Ok([sampling.cpu, memory(&sampling), file, gathering.cpu, memory(&gathering), images])
    }

    /// Writes a view file: one view, or a list that repeats it.
    fn write_views(&self, path: &Path, views: u64) -> Result<(), Error> {
        let text = match views {
            1 => self.view.clone(),
            _ => format!("[{}]", vec![self.view.as_str(); views as usize].join(",")),
        };
        fs::write(path, text).map_err(Error::file(path))
    }

    /// Removes all images; returns their bytes.
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
