//! What is kept of a reference: mean and variance of each statistic over many replicates, in one small file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::folder::Structure;
use super::statistic::is_background;
use super::{FEWEST, Kind, ReplicateError, Replicates};
use crate::meaning::Meaning;

/// The file's name in a reference folder.
pub const SUMMARY: &str = "statistics.json";
/// The mean picture's name beside it, for people to look at.
pub const MEAN_IMAGE: &str = "mean.exr";

/// Changes only when a key changes its meaning or goes.
const SCHEMA: u32 = 1;
/// A file beyond it is no summary.
const MAX_BYTES: u64 = 16 << 20;
/// Relative scatter above which a mean is taken as it is and not its logarithm, which would be skewed.
const LOGARITHM_BELOW: f64 = 0.2;
/// Skewness beyond which a statistic is left out, in standard deviations of the skewness of normal numbers, `√(6/n)`: of
/// 64 replicates 0.77. Beyond it means of eight would not be near enough to normal, five standard errors out.
const MAX_SKEWNESS: f64 = 2.5;
/// The same of the excess kurtosis, `√(24/n)`: of 64 replicates 2.
const MAX_KURTOSIS: f64 = 3.3;

/// Mean and variance of all statistics of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    schema: u32,
    scene: String,
    width: usize,
    height: usize,
    window: [i32; 2],
    channels: Vec<String>,
    /// What headers say beyond the usual about the meaning of the numbers.
    #[serde(default, skip_serializing_if = "Meaning::is_usual")]
    meaning: Meaning,
    /// The beginning of each cloud's hash: as many as there were replicates.
    clouds: Vec<String>,
    pub(super) statistics: Vec<Summarised>,
    #[serde(skip)]
    pub(super) folder: PathBuf,
}

/// A statistic over the replicates of the reference.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summarised {
    /// Layer, part of it, and channel.
    pub name: String,
    /// What it measures.
    pub kind: Kind,
    /// Whether mean and variance are of its logarithm.
    pub logarithm: bool,
    /// Mean over the replicates.
    pub mean: f64,
    /// Variance between replicates, not of their mean.
    pub variance: f64,
    /// Why it is not tested, if it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<String>,
}

impl Summary {
    /// Of a folder: its summary if there is one, else of the images in it.
    pub fn read(folder: &Path) -> Result<Summary, ReplicateError> {
        let path = folder.join(SUMMARY);
        if !path.exists() {
            return Summary::of(&Replicates::read(folder)?, folder);
        }
        let fail = |source| formats::Error::read(&path, source);
        let facts = std::fs::metadata(&path).map_err(fail)?;
        let wrong = |what: String| ReplicateError::Summary { path: path.clone(), what };
        if !facts.is_file() || facts.len() > MAX_BYTES {
            return Err(wrong(format!("not a file of at most {MAX_BYTES} bytes")));
        }
        let bytes = std::fs::read(&path).map_err(fail)?;
        // Some editors begin a file with a byte order mark.
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
        let summary: Summary = serde_json::from_slice(text).map_err(|error| wrong(error.to_string()))?;
        summary.check().map_err(wrong)?;
        Ok(Summary { folder: folder.to_owned(), ..summary })
    }

    /// The files that [`Summary::read`] reads of a folder.
    pub fn paths(folder: &Path) -> Result<Vec<PathBuf>, ReplicateError> {
        let path = folder.join(SUMMARY);
        if path.exists() { Ok(vec![path]) } else { Replicates::paths(folder) }
    }

    /// Of images in memory; `folder` is for messages.
    pub fn of(replicates: &Replicates, folder: &Path) -> Result<Summary, ReplicateError> {
        if let Some(bad) = replicates.all.iter().find(|replicate| replicate.not_finite > 0) {
            return Err(ReplicateError::NotFinite { path: bad.path.clone(), count: bad.not_finite });
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
        let Structure { scene, width, height, window, channels, meaning } = first.structure.clone();
        let clouds = replicates.all.iter().map(|replicate| replicate.cloud.clone()).collect();
        let folder = folder.to_owned();
        Ok(Summary { schema: SCHEMA, scene, width, height, window, channels, meaning, clouds, statistics, folder })
    }

    /// Refuses a folder of images: the mean would be taken for one of them, and the summary be read instead of them.
    pub fn check_target(folder: &Path) -> Result<(), ReplicateError> {
        let images = if folder.is_dir() { Replicates::paths(folder)? } else { Vec::new() };
        match images.into_iter().find(|path| !path.ends_with(MEAN_IMAGE)) {
            Some(image) => Err(ReplicateError::HoldsImages { folder: folder.to_owned(), image }),
            None => Ok(()),
        }
    }

    /// Writes the summary and the mean picture into a folder, which is made if it is not there and must hold no images.
    pub fn write(&self, replicates: &Replicates, folder: &Path) -> Result<(), ReplicateError> {
        Summary::check_target(folder)?;
        std::fs::create_dir_all(folder).map_err(|source| formats::Error::write(folder, source))?;
        let path = folder.join(SUMMARY);
        let text = serde_json::to_string_pretty(self)
            .map_err(|error| ReplicateError::Summary { path: path.clone(), what: error.to_string() })?;
        if !replicates.mean.channels.is_empty() {
            formats::atomic::write(&folder.join(MEAN_IMAGE), &replicates.mean.encode()?)?;
        }
        Ok(formats::atomic::write(&path, (text + "\n").as_bytes())?)
    }

    /// How many replicates it stands for.
    pub fn count(&self) -> usize {
        self.clouds.len()
    }

    fn check(&self) -> Result<(), String> {
        if self.schema != SCHEMA {
            return Err(format!("schema {} instead of {SCHEMA}", self.schema));
        }
        if self.count() < FEWEST {
            return Err(format!("clouds: {} of them, but {FEWEST} are the fewest", self.count()));
        }
        let sound = |s: &Summarised| s.mean.is_finite() && s.variance.is_finite() && s.variance >= 0.0;
        match self.statistics.iter().find(|statistic| !sound(statistic)) {
            Some(bad) => Err(format!("statistics: mean or variance of `{}` is no such number", bad.name)),
            None if self.statistics.is_empty() => Err("statistics: there are none".to_owned()),
            None => Ok(()),
        }
    }

    /// Whether these replicates may be judged by it.
    pub(super) fn fits(&self, test: &Replicates) -> Result<(), ReplicateError> {
        let structure = Structure {
            scene: self.scene.clone(),
            width: self.width,
            height: self.height,
            window: self.window,
            channels: self.channels.clone(),
            meaning: self.meaning.clone(),
        };
        let (first, reference) = (&test.all[0], self.folder.display().to_string());
        if let Some(what) = first.structure.difference(&structure) {
            return Err(ReplicateError::Foreign { path: first.path.clone(), what, reference });
        }
        match test.all.iter().find(|replicate| self.clouds.contains(&replicate.cloud)) {
            Some(twice) => Err(ReplicateError::SameCloud { path: twice.path.clone(), other: reference }),
            None => Ok(()),
        }
    }
}

fn summarise(name: String, kind: Kind, values: Vec<f64>) -> Summarised {
    let (mean, variance) = moments(&values);
    let logarithm = values.iter().all(|value| *value > 0.0) && variance.sqrt() < LOGARITHM_BELOW * mean;
    let values: Vec<f64> = if logarithm { values.iter().map(|value| value.ln()).collect() } else { values };
    let (mean, variance) = moments(&values);
    // A ratio to nothing is no number.
    if !mean.is_finite() || !variance.is_finite() {
        let left_out = Some("without light".to_owned());
        return Summarised { name, kind, logarithm: false, mean: 0.0, variance: 0.0, left_out };
    }
    let left_out = too_far_from_normal(&values, mean, variance);
    Summarised { name, kind, logarithm, mean, variance, left_out }
}

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

/// Mean, and variance with n − 1 degrees of freedom. Taken about the first value, so that equal values have none.
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
    fn what_is_rare_or_dark_is_left_out() {
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
