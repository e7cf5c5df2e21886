//! Exact images by random walks (`gather --reference`), which errors of models are measured against.
//!
//! A truth is two images of independent seeds, so that an error is measured free of their noise. They are kept as
//! OpenEXR files in a folder and rendered only if they are not there. The name of a file is a digest of the contents of
//! the scene, of the arguments and of the files that these name, and of the program's version; where the walks
//! themselves are changed, the folder has to be removed.

use crate::{error::Error, program::Program};
use formats::Image;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// What is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// A scene in one file.
    pub scene: &'a Path,
    /// A built-in medium, or a file of one.
    pub medium: &'a str,
    /// Arguments of both programs, such as `--normals geometric`.
    pub shared: &'a [String],
    /// Further arguments of `gather`, such as `--view FILE.json`.
    pub view: &'a [String],
    /// Width and height, pixels.
    pub side: u32,
}

impl Shot<'_> {
    /// Arguments of `gather` for an image of a cloud, without those of the model and the effort.
    pub fn arguments(&self, cloud: &Path, image: &Path) -> Vec<String> {
        let side = self.side.to_string();
        let own = [&text(cloud), &text(self.scene), "-o", &text(image), "--medium", self.medium];
        let size = ["--width", &side, "--height", &side];
        own.into_iter().chain(size).map(String::from).chain(self.shared.iter().chain(self.view).cloned()).collect()
    }
}

/// Renders exact images and keeps them.
pub struct Exact {
    sample_surface: Program,
    gather: Program,
    folder: PathBuf,
    threads: usize,
}

impl Exact {
    /// Finds the programs; images are kept in `folder`.
    pub fn new(programs: &Path, folder: &Path, threads: usize) -> Result<Exact, Error> {
        fs::create_dir_all(folder).map_err(Error::file(folder))?;
        let [sample_surface, gather] = ["sample-surface", "gather"].map(|name| Program::of(programs, name));
        Ok(Exact { sample_surface: sample_surface?, gather: gather?, folder: folder.to_owned(), threads })
    }

    /// The truth of a shot, each of its images from `paths` camera paths a pixel.
    pub fn truth(&self, shot: &Shot, paths: u32) -> Result<Truth, Error> {
        let key = self.key(shot, paths)?;
        let one = |seed: u32| {
            let image = self.folder.join(format!("{key}-{seed}.exr"));
            if !image.is_file() {
                self.render(shot, paths, seed, &image)?;
            }
            Scattered::read(&image)
        };
        Ok(Truth { references: [one(1)?, one(2)?] })
    }

    /// Digest of what the images depend on, but for their seeds.
    fn key(&self, shot: &Shot, paths: u32) -> Result<String, Error> {
        let mut hasher = blake3::Hasher::new();
        let size = [shot.side, paths].map(|n| n.to_string());
        let named = [self.gather.version()?].into_iter().chain(size).chain([shot.medium.to_owned()]);
        hasher.update(&fs::read(shot.scene).map_err(Error::file(shot.scene))?);
        for argument in named.chain(shot.shared.iter().chain(shot.view).cloned()) {
            let path = Path::new(&argument);
            let content = match path.is_file() {
                true => fs::read(path).map_err(Error::file(path))?,
                false => argument.into_bytes(),
            };
            hasher.update(&content.len().to_le_bytes());
            hasher.update(&content);
        }
        Ok(hasher.finalize().to_hex()[..24].to_owned())
    }

    /// Renders one image. Of its cloud only the materials count.
    fn render(&self, shot: &Shot, paths: u32, seed: u32, image: &Path) -> Result<(), Error> {
        let temporary = tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?;
        let (cloud, statistics) = (temporary.path().join("cloud"), temporary.path().join("json"));
        let mut sampling = vec![text(shot.scene), "-o".into(), text(&cloud), "--samples".into(), "1000".into()];
        sampling.extend_from_slice(shot.shared);
        self.sample_surface.run(&sampling, &statistics)?;
        let mut arguments = shot.arguments(&cloud, image);
        let effort = [("--spp", paths.to_string()), ("--seed", seed.to_string()), ("-j", self.threads.to_string())];
        arguments.push("--reference".into());
        arguments.extend(effort.into_iter().flat_map(|(flag, value)| [flag.to_owned(), value]));
        self.gather.run(&arguments, &statistics).map(|_| ())
    }
}

/// The scattered light of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Scattered {
    pub width: usize,
    pub height: usize,
    /// Red, green and blue of each pixel, row after row, W/(m² sr).
    pub pixels: Vec<[f64; 3]>,
}

impl Scattered {
    /// Reads the layer `subsurface` of what `gather` wrote.
    pub fn read(path: &Path) -> Result<Scattered, Error> {
        let unreadable = |message: String| Error::Unreadable { path: path.to_owned(), message };
        let image = Image::read(path).map_err(|e| unreadable(e.to_string()))?;
        let plane = |c: &str| {
            let name = format!("subsurface.{c}");
            image.channel(&name).ok_or_else(|| unreadable(format!("no channel {name}")))
        };
        let [r, g, b] = [plane("R")?, plane("G")?, plane("B")?];
        let pixels = r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b].map(f64::from)).collect();
        Ok(Scattered { width: image.width, height: image.height, pixels })
    }

    /// Means of blocks of `block` x `block` pixels; what is left over at the right and the bottom is not used.
    pub fn blocks(&self, block: usize) -> Scattered {
        let (width, height) = (self.width / block, self.height / block);
        let mean = |k: usize| {
            let (left, top) = (k % width * block, k / width * block);
            let rows = (top..top + block).map(|y| &self.pixels[y * self.width + left..][..block]);
            let mut sum = [0.0; 3];
            rows.flatten().for_each(|p| (0..3).for_each(|c| sum[c] += p[c]));
            sum.map(|s| s / (block * block) as f64)
        };
        Scattered { width, height, pixels: (0..width * height).map(mean).collect() }
    }
}

/// Pixels of a block whose mean is compared, along each side.
pub const BLOCK: usize = 4;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    pub mean: f64,
    pub error: f64,
}

impl Estimate {
    /// The mean of two independent estimates.
    pub fn mean_of([a, b]: [Estimate; 2]) -> Estimate {
        Estimate { mean: 0.5 * (a.mean + b.mean), error: 0.5 * a.error.hypot(b.error) }
    }
}

/// The exact light of an image, twice.
pub struct Truth {
    references: [Scattered; 2],
}

impl Truth {
    /// The mean of both images.
    pub fn mean(&self) -> Scattered {
        let [a, b] = &self.references;
        let pixels = a.pixels.iter().zip(&b.pixels).map(|(a, b)| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]))).collect();
        Scattered { pixels, ..*a }
    }

    /// relMSE of each channel over the object, of means over blocks of `block` x `block` pixels: the mean of
    /// `(t − a)(t − b)/(r² + 0.01)` with the two references a, b and their mean r. It is free of their noise, since that
    /// of a and that of b are independent. The radiance `white` counts as 1: that of a white Lambertian surface that
    /// faces the light, which is 1 for an irradiance of π.
    ///
    /// The object is where the image or one of the references has scattered light: a choice by the references alone
    /// would prefer pixels in which few paths met a small light.
    pub fn relative_mse(&self, test: &Scattered, block: usize, white: f64) -> [f64; 3] {
        self.estimated_mse(test, block, white).map(|estimate| estimate.mean)
    }

    /// The same with its standard error, from how the blocks differ.
    pub fn estimated_mse(&self, test: &Scattered, block: usize, white: f64) -> [Estimate; 3] {
        let [a, b] = &self.references.each_ref().map(|r| r.blocks(block).pixels);
        let test = test.blocks(block).pixels;
        let (mut sum, mut squares, mut count) = ([0.0; 3], [0.0; 3], 0.0);
        for ((t, a), b) in test.iter().zip(a).zip(b).filter(|((t, a), b)| lit(t) || lit(a) || lit(b)) {
            for c in 0..3 {
                let [t, a, b] = [t[c], a[c], b[c]].map(|x| x / white);
                let product = (t - a) * (t - b) / ((0.5 * (a + b)).powi(2) + 0.01);
                sum[c] += product;
                squares[c] += product * product;
            }
            count += 1.0;
        }
        [0, 1, 2].map(|c| {
            let mean = sum[c] / count;
            Estimate { mean, error: ((squares[c] / count - mean * mean).max(0.0) / count).sqrt() }
        })
    }

    /// Mean light of an image over that of the truth, of each channel.
    pub fn ratio(&self, test: &Scattered) -> [f64; 3] {
        let total = |image: &Scattered, c: usize| image.pixels.iter().map(|p| p[c]).sum::<f64>();
        let mean = self.mean();
        [0, 1, 2].map(|c| total(test, c) / total(&mean, c))
    }
}

fn lit(pixel: &[f64; 3]) -> bool {
    pixel.iter().any(|x| *x != 0.0)
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gray values of a square picture.
    fn picture(values: &[f64]) -> Scattered {
        let side = values.len().isqrt();
        Scattered { width: side, height: side, pixels: values.iter().map(|x| [*x; 3]).collect() }
    }

    #[test]
    fn noise_of_the_references_does_not_count() {
        let references = [picture(&[0.9, 1.1, 0.0, 1.0]), picture(&[1.0, 1.0, 0.0, 1.0])];
        let truth = Truth { references };
        assert!(truth.relative_mse(&picture(&[1.0, 1.0, 0.0, 1.0]), 1, 1.0)[0].abs() < 1e-15);
        let off = truth.relative_mse(&picture(&[1.0, 1.0, 0.0, 1.1]), 1, 1.0)[0];
        assert!((off - 0.01 / 1.01 / 3.0).abs() < 1e-9, "{off}");
        let doubled = truth.ratio(&picture(&[2.0, 2.0, 0.0, 2.0]));
        assert_eq!(doubled, [2.0; 3]);
    }

    /// A quarter of sixteen blocks is off by a tenth.
    ///
    /// Seen to catch: the variance of the blocks in place of that of their mean.
    #[test]
    fn the_error_of_an_error_is_that_of_the_mean_of_its_blocks() {
        let references = || picture(&[1.0; 16]);
        let truth = Truth { references: [references(), references()] };
        let off = |k: usize| if k.is_multiple_of(4) { 1.1 } else { 1.0 };
        let [estimate, ..] = truth.estimated_mse(&picture(&(0..16).map(off).collect::<Vec<_>>()), 1, 1.0);
        let one = 0.01 / 1.01;
        assert!((estimate.mean - 0.25 * one).abs() < 1e-9, "{estimate:?}");
        assert!((estimate.error - one * (0.25f64 * 0.75 / 16.0).sqrt()).abs() < 1e-9, "{estimate:?}");
        let both = Estimate::mean_of([estimate, Estimate::default()]);
        assert!((both.error - 0.5 * estimate.error).abs() < 1e-15);
    }

    #[test]
    fn blocks_are_means() {
        let values: Vec<f64> = (0..25).map(f64::from).collect();
        let blocks = picture(&values).blocks(2);
        assert_eq!(blocks, picture(&[3.0, 5.0, 13.0, 15.0]));
        let truth = Truth { references: [picture(&[1.0; 16]), picture(&[1.0; 16])] };
        let checkered: Vec<f64> = (0..16).map(|k| f64::from(k % 2) * 2.0).collect();
        assert_eq!(truth.relative_mse(&picture(&checkered), 4, 1.0), [0.0; 3]);
    }
}
