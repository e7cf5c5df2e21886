//! The summary of a reference: the mean and variance of each statistic over many replicates, in one small file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::ReplicateError;
use super::folder::{MIN_REPLICATES, Replicates};
use super::statistic::{Kind, is_background};
use crate::{meaning::Meaning, structure::Structure};

/// The name of the file in a reference folder.
pub const SUMMARY: &str = "statistics.json";
/// The name of the mean picture beside it, which is for people to look at.
pub const MEAN_IMAGE: &str = "mean.exr";

/// The version of the keys, which changes only when a key changes its meaning or is removed.
const SCHEMA: u32 = 1;
/// The length of the longest file that is read, in bytes.
const MAX_BYTES: u64 = 16 << 20;
/// The relative standard deviation below which logarithms are compared. Above it they would be skewed.
const LOGARITHM_BELOW: f64 = 0.2;
/// The largest skewness of a statistic that is tested, in units of `√(6/n)`, the standard deviation of the skewness of
/// normal numbers. For 64 replicates it is 0.77. Beyond it, means of eight would not be nearly normal five standard
/// errors out.
const MAX_SKEWNESS: f64 = 2.5;
/// The largest excess kurtosis, in units of `√(24/n)`. For 64 replicates it is 2.
const MAX_KURTOSIS: f64 = 3.3;

/// The mean and variance of all statistics of a set of replicates.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    schema: u32,
    scene: String,
    width: usize,
    height: usize,
    window: [i32; 2],
    channels: Vec<String>,
    /// The attributes that decide whether images can be compared.
    #[serde(default, skip_serializing_if = "Meaning::is_usual")]
    meaning: Meaning,
    /// The beginning of the hash of each replicate's cloud.
    clouds: Vec<String>,
    pub(super) statistics: Vec<Summarised>,
    #[serde(skip)]
    pub(super) folder: PathBuf,
}

/// A statistic over the replicates of the reference.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summarised {
    /// The layer, the part of it, and the channel.
    pub name: String,
    /// The quantity that the statistic measures.
    pub kind: Kind,
    /// Whether mean and variance are those of its logarithm.
    pub logarithm: bool,
    /// The mean over the replicates.
    pub mean: f64,
    /// The variance between replicates, which is not that of their mean.
    pub variance: f64,
    /// The reason if it is not tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<String>,
}

impl Summary {
    /// Reads the summary of a folder, or makes it of the images in the folder if there is none.
    pub fn read(folder: &Path) -> Result<Summary, ReplicateError> {
        let path = folder.join(SUMMARY);
        if !path.exists() {
            return Summary::of(&Replicates::read(folder)?, folder);
        }
        let fail = |source| formats::Error::read(&path, source);
        let facts = std::fs::metadata(&path).map_err(fail)?;
        let wrong = |what: String| ReplicateError::invalid(&path, what + "; summarise the images again");
        if !facts.is_file() || facts.len() > MAX_BYTES {
            return Err(wrong(format!("it is not a file of at most {MAX_BYTES} bytes")));
        }
        let bytes = std::fs::read(&path).map_err(fail)?;
        // Guards against a byte order mark, with which some editors begin a file.
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
        let summary: Summary = serde_json::from_slice(text).map_err(|error| wrong(error.to_string()))?;
        summary.check().map_err(wrong)?;
        Ok(Summary { folder: folder.to_owned(), ..summary })
    }

    /// The files that [`Summary::read`] reads from a folder.
    pub fn paths(folder: &Path) -> Result<Vec<PathBuf>, ReplicateError> {
        let path = folder.join(SUMMARY);
        if path.exists() { Ok(vec![path]) } else { Replicates::paths(folder) }
    }

    /// Summarises images in memory. Messages contain `folder`.
    pub fn of(replicates: &Replicates, folder: &Path) -> Result<Summary, ReplicateError> {
        if let Some(bad) = replicates.all.iter().find(|replicate| replicate.not_finite > 0) {
            let count = bad.not_finite;
            let what = format!("{count} samples are not finite, which a reference must not hold; render it again");
            return Err(ReplicateError::invalid(&bad.path, what));
        }
        let first = &replicates.all[0];
        let names = first.statistics.iter().enumerate();
        let mut statistics: Vec<Summarised> = names
            .map(|(index, statistic)| {
                let values = replicates.all.iter().map(|replicate| replicate.statistics[index].value).collect();
                summarise(statistic.name.clone(), statistic.kind, values)
            })
            .collect();
        leave_out_background(&mut statistics, replicates);
        let Structure { size: [width, height], window, channels, meaning } = first.structure.clone();
        let scene = first.scene.clone();
        let clouds = replicates.all.iter().map(|replicate| replicate.cloud.clone()).collect();
        let folder = folder.to_owned();
        Ok(Summary { schema: SCHEMA, scene, width, height, window, channels, meaning, clouds, statistics, folder })
    }

    /// Refuses a folder of images, where the mean would be taken for a replicate and the summary would be read instead
    /// of them.
    pub fn check_target(folder: &Path) -> Result<(), ReplicateError> {
        let images = if folder.is_dir() { Replicates::paths(folder)? } else { Vec::new() };
        images.into_iter().find(|path| !path.ends_with(MEAN_IMAGE)).map_or(Ok(()), |image| {
            let what = format!("it holds images such as {}; give a folder without images", image.display());
            Err(ReplicateError::invalid(folder, what))
        })
    }

    /// Writes the summary and the mean picture into a folder, which must hold no images and is made if it does not
    /// exist.
    pub fn write(&self, replicates: &Replicates, folder: &Path) -> Result<(), ReplicateError> {
        Summary::check_target(folder)?;
        std::fs::create_dir_all(folder).map_err(|source| formats::Error::write(folder, source))?;
        let path = folder.join(SUMMARY);
        let text =
            serde_json::to_string_pretty(self).map_err(|error| ReplicateError::invalid(&path, error.to_string()))?;
        if !replicates.mean.channels.is_empty() {
            formats::atomic::write(&folder.join(MEAN_IMAGE), &replicates.mean.encode()?)?;
        }
        Ok(formats::atomic::write(&path, (text + "\n").as_bytes())?)
    }

    /// The number of replicates that it was made of.
    pub fn count(&self) -> usize {
        self.clouds.len()
    }

    /// Checks what was read from a file.
    fn check(&self) -> Result<(), String> {
        if self.schema != SCHEMA {
            return Err(format!("`schema` is {} instead of {SCHEMA}", self.schema));
        }
        if self.count() < MIN_REPLICATES {
            return Err(format!("`clouds` has {} entries, but at least {MIN_REPLICATES} are needed", self.count()));
        }
        let sound = |s: &Summarised| s.mean.is_finite() && s.variance.is_finite() && s.variance >= 0.0;
        match self.statistics.iter().find(|statistic| !sound(statistic)) {
            Some(bad) => Err(format!("the mean or the variance of `{}` is not a valid number", bad.name)),
            None if self.statistics.is_empty() => Err("`statistics` is empty".to_owned()),
            None => Ok(()),
        }
    }

    /// Checks whether these replicates can be judged by this summary.
    pub(super) fn fits(&self, test: &Replicates) -> Result<(), ReplicateError> {
        let structure = Structure {
            size: [self.width, self.height],
            window: self.window,
            channels: self.channels.clone(),
            meaning: self.meaning.clone(),
        };
        test.all[0].check(&structure, &self.scene, &self.folder)?;
        let twice = test.all.iter().find(|replicate| self.clouds.contains(&replicate.cloud));
        twice.map_or(Ok(()), |twice| Err(ReplicateError::same_cloud(&twice.path, &self.folder)))
    }
}

/// Reduces the values of a statistic to mean and variance.
fn summarise(name: String, kind: Kind, values: Vec<f64>) -> Summarised {
    let (mean, variance) = moments(&values);
    let logarithm = values.iter().all(|value| *value > 0.0) && variance.sqrt() < LOGARITHM_BELOW * mean;
    let values: Vec<f64> = if logarithm { values.iter().map(|value| value.ln()).collect() } else { values };
    let (mean, variance) = moments(&values);
    // Guards 0/0: the ratio of two black channels.
    if !mean.is_finite() || !variance.is_finite() {
        let left_out = Some("without light".to_owned());
        return Summarised { name, kind, logarithm: false, mean: 0.0, variance: 0.0, left_out };
    }
    let left_out = too_far_from_normal(&values, mean, variance);
    Summarised { name, kind, logarithm, mean, variance, left_out }
}

/// The reason if the values are too far from normally distributed.
fn too_far_from_normal(values: &[f64], mean: f64, variance: f64) -> Option<String> {
    if variance == 0.0 {
        return None;
    }
    let n = values.len() as f64;
    let moment =
        |power: i32| values.iter().map(|value| ((value - mean) / variance.sqrt()).powi(power)).sum::<f64>() / n;
    let (skewness, kurtosis) = (moment(3), moment(4) - 3.0);
    let far = skewness.abs() > MAX_SKEWNESS * (6.0 / n).sqrt() || kurtosis > MAX_KURTOSIS * (24.0 / n).sqrt();
    far.then(|| format!("far from normal: skewness {skewness:.2}, excess kurtosis {kurtosis:.2}"))
}

fn leave_out_background(statistics: &mut [Summarised], replicates: &Replicates) {
    let first = &replicates.all[0].statistics;
    let light = |name: &str| first.iter().find(|statistic| statistic.name == name).map_or(f64::NAN, |s| s.value);
    for statistic in statistics.iter_mut().filter(|statistic| is_background(&statistic.name, light)) {
        statistic.left_out = Some("nearly all background".to_owned());
    }
}

/// The mean, and the variance with n − 1 degrees of freedom. Sums are relative to the first value, so that the variance
/// of equal values is exactly zero.
pub(super) fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let first = values.first().copied().unwrap_or(f64::NAN);
    let mean = first + values.iter().map(|value| value - first).sum::<f64>() / n;
    (mean, values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_on_paper() {
        assert_eq!(moments(&[1.0, 2.0, 3.0, 6.0]), (3.0, 14.0 / 3.0));
        assert_eq!(moments(&[0.1; 7]), (0.1, 0.0));
        assert!(moments(&[1.0, f64::NAN]).0.is_nan());
    }

    #[test]
    fn rare_and_black_statistics_are_left_out() {
        let summary = |values: &[f64]| summarise("name".to_owned(), Kind::Light, values.to_vec());
        let even: Vec<f64> = (0..32).map(|i| 1.0 + 0.01 * f64::from(i % 8)).collect();
        assert!(summary(&even).left_out.is_none() && summary(&even).logarithm);
        let mut rare = vec![0.0; 32];
        rare[3] = 1.0;
        assert!(summary(&rare).left_out.is_some_and(|why| why.starts_with("far from normal")));
        assert!(summary(&[0.0; 32]).left_out.is_none());
        assert_eq!(summary(&[f64::NAN; 32]).left_out.as_deref(), Some("without light"));
        let wide: Vec<f64> = (0..32).map(|i| 1.0 + 0.3 * f64::from(i % 8)).collect();
        assert!(!summary(&wide).logarithm && summary(&wide).left_out.is_none());
    }
}
