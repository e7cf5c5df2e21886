//! Clouds and calibrations, each made once and kept until there are too many.

use crate::{
    error::Error,
    program::{Program, Spent},
    speed::{configuration::CloudKind, shot::Shot},
};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// What a cloud depends on.
#[derive(Clone, PartialEq, Eq, Hash)]
struct CloudKey {
    scene: PathBuf,
    kind: CloudKind,
    samples: u64,
    seed: u64,
    threads: usize,
}

/// What a calibration depends on.
#[derive(Clone, PartialEq, Eq, Hash)]
struct CalibrationKey {
    cloud: CloudKey,
    medium: &'static str,
    model: &'static str,
    walks: u64,
}

/// The files that `gather` reads, and what they cost.
pub struct Made {
    sample_surface: Program,
    calibrate: Program,
    folder: PathBuf,
    clouds: HashMap<CloudKey, (PathBuf, Spent)>,
    calibrations: HashMap<CalibrationKey, (PathBuf, Spent)>,
    count: usize,
}

impl Made {
    /// Finds the programs; files are kept in `folder`.
    pub fn new(programs: &Path, folder: &Path) -> Result<Made, Error> {
        Ok(Made {
            sample_surface: Program::of(programs, "sample-surface")?,
            calibrate: Program::of(programs, "calibrate")?,
            folder: folder.to_owned(),
            clouds: HashMap::new(),
            calibrations: HashMap::new(),
            count: 0,
        })
    }

    /// The cloud of a shot, sampled if it does not exist.
    pub fn cloud(&mut self, shot: &Shot) -> Result<(PathBuf, Spent), Error> {
        let key = cloud_key(shot);
        if let Some(known) = self.clouds.get(&key) {
            return Ok(known.clone());
        }
        let path = self.path("cloud");
        let mut arguments = vec![text(&shot.subject.path)];
        arguments.extend(["--samples".into(), shot.samples.to_string()]);
        arguments.extend(shot.configuration.sample_flags());
        arguments.extend(common(shot, &path));
        let spent = self.sample_surface.run(&arguments, &self.folder.join("sample.json"))?;
        self.clouds.insert(key, (path.clone(), spent.clone()));
        Ok((path, spent))
    }

    /// The calibration of a shot, made if it is one with walks and does not exist.
    pub fn calibration(&mut self, shot: &Shot) -> Result<Option<(PathBuf, Spent)>, Error> {
        let Some(walks) = shot.walks else { return Ok(None) };
        let model = shot.configuration.model.name();
        let key = CalibrationKey { cloud: cloud_key(shot), medium: shot.medium.name, model, walks };
        if let Some(known) = self.calibrations.get(&key) {
            return Ok(Some(known.clone()));
        }
        let (cloud, _) = self.cloud(shot)?;
        let path = self.path("calibration");
        let mut arguments = vec![text(&cloud), text(&shot.subject.path)];
        let named = [("--medium", shot.medium.name), ("--bssrdf", model), ("--walks", &walks.to_string())];
        arguments.extend(named.iter().flat_map(|(flag, value)| [(*flag).to_owned(), (*value).to_owned()]));
        arguments.extend(common(shot, &path));
        let spent = self.calibrate.run(&arguments, &self.folder.join("calibrate.json"))?;
        self.calibrations.insert(key, (path.clone(), spent.clone()));
        Ok(Some((path, spent)))
    }

    /// Removes all files: large clouds would fill the disk.
    pub fn forget(&mut self) {
        let clouds = self.clouds.drain().map(|(_, made)| made);
        for (path, _) in clouds.chain(self.calibrations.drain().map(|(_, made)| made)) {
            std::fs::remove_file(path).ok();
        }
    }

    fn path(&mut self, kind: &str) -> PathBuf {
        self.count += 1;
        self.folder.join(format!("{}.{kind}", self.count))
    }
}

fn cloud_key(shot: &Shot) -> CloudKey {
    CloudKey {
        scene: shot.subject.path.clone(),
        kind: shot.configuration.cloud,
        samples: shot.samples,
        seed: shot.cloud_seed,
        threads: shot.threads,
    }
}

/// Arguments of both programs.
fn common(shot: &Shot, output: &Path) -> Vec<String> {
    let numbers = [("--seed", shot.cloud_seed.to_string()), ("--threads", shot.threads.to_string())];
    let pairs = numbers.into_iter().chain([("-o", text(output))]).flat_map(|(flag, value)| [flag.to_owned(), value]);
    pairs.chain(shot.subject.flags.iter().map(|f| (*f).to_owned())).collect()
}

fn text(path: &Path) -> String {
    path.display().to_string()
}
