//! A folder of replicates, which are read one by one and reduced to their statistics.

use std::path::{Path, PathBuf};

use formats::image::{Attribute, Channel, Image};

use super::error::ReplicateError;
use super::statistic::{Statistic, statistics};
use crate::{meaning, structure::Structure};

/// The smallest number of replicates of either side; the variance of fewer would be known too badly.
pub const MIN_REPLICATES: usize = 8;

/// The attribute that tells clouds apart.
const CLOUD: &str = "pcsss/cloud";
/// The attribute that tells scenes apart.
const SCENE: &str = "pcsss/scene";
/// The number of characters of a cloud's hash that are kept. Their 64 bits tell clouds apart.
const HASH_LENGTH: usize = 16;

/// One image, reduced to its statistics.
#[derive(Clone, Debug)]
pub(super) struct Replicate {
    pub(super) path: PathBuf,
    pub(super) structure: Structure,
    /// The hash of the scene.
    pub(super) scene: String,
    /// The beginning of the hash of the cloud.
    pub(super) cloud: String,
    pub(super) not_finite: usize,
    pub(super) statistics: Vec<Statistic>,
}

/// Images of one scene, each made from a cloud of its own.
#[derive(Clone, Debug)]
pub struct Replicates {
    pub(super) all: Vec<Replicate>,
    /// The mean of the pictures, R, G and B.
    pub(super) mean: Image,
}

impl Replicate {
    /// Reduces an image. Messages contain `path`.
    fn of(path: &Path, image: &Image) -> Result<Replicate, ReplicateError> {
        let text = |attribute: &'static str| match image.attributes.get(attribute) {
            Some(Attribute::Text(text)) if !text.is_empty() => Ok(text.clone()),
            _ => Err(ReplicateError::invalid(path, format!("the header has no {attribute}; use images of gather"))),
        };
        Ok(Replicate {
            path: path.to_owned(),
            structure: Structure::of(image),
            scene: text(SCENE)?,
            cloud: text(CLOUD)?.chars().take(HASH_LENGTH).collect(),
            not_finite: image.channels.iter().flat_map(|c| &c.samples).filter(|sample| !sample.is_finite()).count(),
            statistics: statistics(image),
        })
    }

    /// Checks that it belongs to a reference of this structure and scene. Messages contain the name of the reference.
    pub(super) fn check(&self, structure: &Structure, scene: &str, name: &Path) -> Result<(), ReplicateError> {
        let what = match self.structure.check(structure) {
            Err(mismatch) => mismatch.to_string(),
            Ok(()) if self.scene == scene => return Ok(()),
            Ok(()) => format!("the scene is {}, but that of the reference is {scene}; render one scene", self.scene),
        };
        Err(ReplicateError::invalid(&self.path, format!("{what} (the reference is {})", name.display())))
    }
}

impl Replicates {
    /// Reads all `.exr` files of a folder, in order of name.
    pub fn read(folder: &Path) -> Result<Replicates, ReplicateError> {
        let images = Replicates::paths(folder)?.into_iter().map(|path| Ok((Image::read(&path)?, path)));
        Replicates::of(folder, images)
    }

    /// The files that [`Replicates::read`] reads from a folder, in order of name.
    pub fn paths(folder: &Path) -> Result<Vec<PathBuf>, ReplicateError> {
        let fail = |source| formats::Error::read(folder, source);
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(fail)? {
            let path = entry.map_err(fail)?.path();
            // Temporary files of a renderer that is still at work begin with a dot.
            let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if !hidden && path.extension().is_some_and(|extension| extension == "exr") {
                paths.push(path);
            }
        }
        paths.sort();
        Ok(paths)
    }

    /// Reduces images with their names, one after the other. Messages contain `folder`.
    pub fn of(
        folder: &Path,
        images: impl IntoIterator<Item = Result<(Image, PathBuf), ReplicateError>>,
    ) -> Result<Replicates, ReplicateError> {
        let (mut all, mut sum, mut mean) = (Vec::new(), Vec::new(), Image::default());
        for image in images {
            let (image, path) = image?;
            let replicate = Replicate::of(&path, &image)?;
            if let Some(Replicate { structure, scene, path, .. }) = all.first() {
                replicate.check(structure, scene, path)?;
            }
            if all.is_empty() {
                mean = meaning::computed_from(&image, Vec::new());
            }
            add(&mut sum, &image);
            all.push(replicate);
        }
        if all.len() < MIN_REPLICATES {
            let count = all.len();
            let what = format!(
                "{count} replicates (.exr) are too few; render at least {MIN_REPLICATES}, each from its own cloud"
            );
            return Err(ReplicateError::invalid(folder, what));
        }
        independent(&all)?;
        mean.channels = means(&sum, all.len());
        Ok(Replicates { mean, all })
    }
}

/// Checks that no cloud occurs twice.
fn independent(all: &[Replicate]) -> Result<(), ReplicateError> {
    let mut by_cloud: Vec<&Replicate> = all.iter().collect();
    by_cloud.sort_by(|a, b| (&a.cloud, &a.path).cmp(&(&b.cloud, &b.path)));
    let same = by_cloud.array_windows().find(|[a, b]| a.cloud == b.cloud);
    same.map_or(Ok(()), |[a, b]| Err(ReplicateError::same_cloud(&b.path, &a.path)))
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
