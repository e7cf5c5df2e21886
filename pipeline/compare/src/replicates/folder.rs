//! A folder of replicates: read one by one, reduced at once.

use std::path::{Path, PathBuf};

use formats::image::{Attribute, Channel, Image};

use super::statistic::{Statistic, statistics};
use super::{FEWEST, ReplicateError};
use crate::meaning::{self, Difference, Meaning};

/// The attribute that tells clouds apart.
const CLOUD: &str = "pcsss/cloud";
/// The attribute that tells scenes apart.
const SCENE: &str = "pcsss/scene";
/// Characters of a cloud's hash that are kept: 64 bits tell any clouds apart.
const HASH_LENGTH: usize = 16;

/// What all replicates of a case have in common.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Structure {
    pub scene: String,
    pub width: usize,
    pub height: usize,
    pub window: [i32; 2],
    pub channels: Vec<String>,
    pub meaning: Meaning,
}

/// What is left of one image.
#[derive(Clone, Debug)]
pub(super) struct Replicate {
    pub(super) path: PathBuf,
    pub(super) structure: Structure,
    pub(super) cloud: String,
    pub(super) not_finite: usize,
    pub(super) statistics: Vec<Statistic>,
}

/// Images of one scene, each from a cloud of its own.
#[derive(Clone, Debug)]
pub struct Replicates {
    pub(super) all: Vec<Replicate>,
    /// Mean of the picture, R, G and B.
    pub(super) mean: Image,
}

impl Replicate {
    /// Reduces an image; `path` is for messages.
    fn of(path: &Path, image: &Image) -> Result<Replicate, ReplicateError> {
        let text = |attribute: &'static str| match image.attributes.get(attribute) {
            Some(Attribute::Text(text)) if !text.is_empty() => Ok(text.clone()),
            _ => Err(ReplicateError::NoOrigin { path: path.to_owned(), attribute }),
        };
        let mut channels: Vec<String> = image.channels.iter().map(|channel| channel.name.clone()).collect();
        channels.sort();
        let (width, height, window, meaning) = (image.width, image.height, image.window, Meaning::of(image).judged());
        Ok(Replicate {
            path: path.to_owned(),
            structure: Structure { scene: text(SCENE)?, width, height, window, channels, meaning },
            cloud: text(CLOUD)?.chars().take(HASH_LENGTH).collect(),
            not_finite: image.channels.iter().flat_map(|c| &c.samples).filter(|sample| !sample.is_finite()).count(),
            statistics: statistics(image),
        })
    }
}

impl Replicates {
    /// All `.exr` files of a folder, in order of name.
    pub fn read(folder: &Path) -> Result<Replicates, ReplicateError> {
        let images = Replicates::paths(folder)?.into_iter().map(|path| Ok((Image::read(&path)?, path)));
        Replicates::of(folder, images)
    }

    /// The files that [`Replicates::read`] reads of a folder, in order of name.
    pub fn paths(folder: &Path) -> Result<Vec<PathBuf>, ReplicateError> {
        images(folder)
    }

    /// Images with their names, one after the other; `folder` is for messages.
    pub fn of(
        folder: &Path,
        images: impl IntoIterator<Item = Result<(Image, PathBuf), ReplicateError>>,
    ) -> Result<Replicates, ReplicateError> {
        let (mut all, mut sum, mut mean) = (Vec::new(), Vec::new(), Image::default());
        for image in images {
            let (image, path) = image?;
            let replicate = Replicate::of(&path, &image)?;
            belongs(&replicate, all.first())?;
            if all.is_empty() {
                let Image { width, height, window, display, .. } = image;
                mean =
                    Image { width, height, window, display, attributes: meaning::kept(&image), channels: Vec::new() };
            }
            add(&mut sum, &image);
            all.push(replicate);
        }
        if all.len() < FEWEST {
            return Err(ReplicateError::TooFew { folder: folder.to_owned(), found: all.len(), wanted: FEWEST });
        }
        independent(&all)?;
        mean.channels = means(&sum, all.len());
        Ok(Replicates { mean, all })
    }
}

fn images(folder: &Path) -> Result<Vec<PathBuf>, ReplicateError> {
    let fail = |source| formats::Error::read(folder, source);
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        // A temporary file of a renderer that is still at work begins with a dot.
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !hidden && path.extension().is_some_and(|extension| extension == "exr") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn belongs(replicate: &Replicate, first: Option<&Replicate>) -> Result<(), ReplicateError> {
    let Some(first) = first else { return Ok(()) };
    match replicate.structure.difference(&first.structure) {
        None => Ok(()),
        Some(what) => Err(ReplicateError::Foreign {
            path: replicate.path.clone(),
            what,
            reference: first.path.display().to_string(),
        }),
    }
}

/// Each cloud once.
fn independent(all: &[Replicate]) -> Result<(), ReplicateError> {
    let mut by_cloud: Vec<&Replicate> = all.iter().collect();
    by_cloud.sort_by(|a, b| (&a.cloud, &a.path).cmp(&(&b.cloud, &b.path)));
    match by_cloud.array_windows().find(|[a, b]| a.cloud == b.cloud) {
        None => Ok(()),
        Some([a, b]) => Err(ReplicateError::SameCloud { path: b.path.clone(), other: a.path.display().to_string() }),
    }
}

impl Structure {
    /// What differs from the reference, in words.
    pub(super) fn difference(&self, reference: &Structure) -> Option<String> {
        let (size, expected) = ((self.width, self.height), (reference.width, reference.height));
        if size != expected || self.window != reference.window {
            return Some(format!(
                "{} x {} pixels at {:?} instead of {} x {} at {:?}; render both at one size",
                size.0, size.1, self.window, expected.0, expected.1, reference.window
            ));
        }
        if self.channels != reference.channels {
            return Some("other channels; write both with one version of the renderer".to_owned());
        }
        if let Some(Difference { name, reference, test, way_out }) = self.meaning.difference(&reference.meaning) {
            return Some(format!(
                "{name} is {test} instead of {reference}, so that equal numbers are not the same; {way_out}"
            ));
        }
        let scenes = (&self.scene, &reference.scene);
        (scenes.0 != scenes.1).then(|| format!("its scene is {} instead of {}; render one scene", scenes.0, scenes.1))
    }
}

fn add(sum: &mut Vec<Vec<f64>>, image: &Image) {
    for (index, name) in ["R", "G", "B"].iter().enumerate() {
        let samples = image.channel(name).unwrap_or_default();
        match sum.get_mut(index) {
            None => sum.push(samples.iter().map(|sample| f64::from(*sample)).collect()),
            Some(plane) => plane.iter_mut().zip(samples).for_each(|(sum, sample)| *sum += f64::from(*sample)),
        }
    }
}

fn means(sum: &[Vec<f64>], count: usize) -> Vec<Channel> {
    let channels = ["R", "G", "B"].iter().zip(sum).filter(|(_, plane)| !plane.is_empty());
    let mean = |(name, plane): (&&str, &Vec<f64>)| Channel {
        name: (*name).to_owned(),
        samples: plane.iter().map(|sum| (sum / count as f64) as f32).collect(),
    };
    channels.map(mean).collect()
}
