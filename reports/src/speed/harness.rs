//! Runs the programs in a temporary folder and keeps a record of every run.

use crate::{
    error::Error,
    program::{Program, Spent},
    speed::{
        configuration::{CONFIGURATIONS, CloudKind, Configuration, FINE, MARBLE, MODEL, Medium, Subject, Summing},
        effort::Effort,
        made::Made,
        picture::Picture,
        record::Record,
        shot::Shot,
    },
};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};
use tempfile::TempDir;

/// A rendered image and its cost.
pub struct Taken {
    pub picture: Picture,
    /// Its file, until the next image is rendered.
    pub file: PathBuf,
    /// Cost of `sample-surface`, also if its cloud was used before.
    pub sampling: Spent,
    /// Cost of `calibrate`, also if its calibration was used before.
    pub calibrating: Option<Spent>,
    pub gathering: Spent,
    record: usize,
}

impl Taken {
    /// All programs that ran.
    fn programs(&self) -> impl Iterator<Item = &Spent> {
        [&self.sampling, &self.gathering].into_iter().chain(&self.calibrating)
    }

    /// Seconds of all programs.
    pub fn seconds(&self) -> f64 {
        self.programs().map(|p| p.wall).sum()
    }

    /// User and system seconds of all programs.
    pub fn cpu(&self) -> f64 {
        self.programs().map(|p| p.cpu).sum()
    }
}

/// The programs, a working folder, and the records of all runs.
pub struct Harness {
    pub effort: Effort,
    /// Number of threads unless a shot asks for another.
    pub threads: usize,
    /// The configurations that these programs support.
    pub configurations: Vec<Configuration>,
    pub records: Vec<Record>,
    /// The measurements that could not be made, in sentences.
    pub remarks: Vec<String>,
    made: Made,
    gather: Program,
    folder: TempDir,
    start: Instant,
}

impl Harness {
    /// Finds the programs and tries every configuration once, on a handful of samples of `subject`.
    pub fn new(programs: &Path, effort: Effort, subject: &Subject) -> Result<Harness, Error> {
        let folder = tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?;
        let mut harness = Harness {
            effort,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            configurations: Vec::new(),
            records: Vec::new(),
            remarks: Vec::new(),
            made: Made::new(programs, folder.path())?,
            gather: Program::of(programs, "gather")?,
            folder,
            start: Instant::now(),
        };
        harness.say("trying every configuration");
        for row in CONFIGURATIONS {
            let shot = harness.shot(subject, MARBLE, row);
            match harness.take(&Shot { samples: 1000, spp: 1, size: [8, 8], ..shot }) {
                Ok(_) => harness.configurations.push(row),
                Err(e) => match e.refusal() {
                    Some(why) => harness.remarks.push(format!("Configuration `{}` was left out: {why}", row.name)),
                    None => return Err(e),
                },
            }
        }
        harness.records.clear();
        harness.stand_in()?;
        Ok(harness)
    }

    /// Notes it if another configuration has to stand in for `all`, which only a trial permits.
    fn stand_in(&mut self) -> Result<(), Error> {
        let ours = self.ours().ok_or_else(|| Error::Usage(format!("no configuration runs: {:?}", self.remarks)))?;
        if ours.name != "all" && self.effort != Effort::Tiny {
            let why = self.remarks.join(" ");
            return Err(Error::Usage(format!("the programs refuse `all`, and without it this takes days. {why}")));
        }
        if ours.name != "all" {
            self.remarks.push(format!("`{}` stands in for `all` everywhere below.", ours.name));
        }
        Ok(())
    }

    /// A configuration by name, if the programs support it.
    pub fn configuration(&self, name: &str) -> Option<Configuration> {
        self.configurations.iter().copied().find(|c| c.name == name)
    }

    /// The configuration with all ingredients, or with as many as the programs support.
    fn ours(&self) -> Option<Configuration> {
        self.configuration("all").or_else(|| self.configurations.last().copied())
    }

    /// The configuration with all ingredients and the default accuracy, or its stand-in.
    pub fn all(&self) -> Configuration {
        self.ours().expect("a harness without any configuration is not made")
    }

    /// The best configuration for this kind of cloud.
    pub fn best_on(&self, cloud: CloudKind) -> Configuration {
        Configuration { name: "best", cloud, summing: self.all().summing, model: MODEL }
    }

    /// A configuration for this kind of cloud whose sums are as good as exact beside the error of the cloud.
    pub fn fine_on(&self, cloud: CloudKind) -> Configuration {
        let summing = match self.all().summing {
            Summing::Cut(_) => FINE,
            _ => Summing::Exhaustive,
        };
        Configuration { name: "fine", cloud, summing, model: MODEL }
    }

    /// The kinds of clouds that the programs support.
    pub fn kinds(&self) -> Vec<CloudKind> {
        let mut kinds = Vec::new();
        for row in &self.configurations {
            if !kinds.contains(&row.cloud) {
                kinds.push(row.cloud);
            }
        }
        kinds
    }

    /// A shot with seeds 1 and 1, to be changed where another one is needed.
    pub fn shot<'a>(&self, subject: &'a Subject, medium: Medium, configuration: Configuration) -> Shot<'a> {
        Shot {
            subject,
            medium,
            configuration,
            samples: 100_000,
            spp: 1,
            cloud_seed: 1,
            gather_seed: 1,
            size: [64, 64],
            threads: self.threads,
            walks: None,
            more: Vec::new(),
        }
    }

    /// Writes a line with the time since the start to stderr.
    pub fn say(&self, line: &str) {
        let seconds = self.start.elapsed().as_secs();
        eprintln!("{:3}:{:02} {line}", seconds / 60, seconds % 60);
    }

    /// Seconds since the start.
    pub fn elapsed(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// The cloud of a shot, sampled if it does not exist.
    pub fn cloud(&mut self, shot: &Shot) -> Result<(PathBuf, Spent), Error> {
        self.made.cloud(shot)
    }

    /// Renders a shot.
    pub fn take(&mut self, shot: &Shot) -> Result<Taken, Error> {
        let (cloud, sampling) = self.made.cloud(shot)?;
        let calibration = self.made.calibration(shot)?;
        let image = self.folder.path().join("image.exr");
        let mut arguments = vec![text(&cloud), text(&shot.subject.path), "-o".into(), text(&image)];
        let numbers = [
            ("--width", shot.size[0]),
            ("--height", shot.size[1]),
            ("--spp", shot.spp),
            ("--seed", shot.gather_seed),
            ("--threads", shot.threads as u64),
        ];
        arguments.extend(numbers.iter().flat_map(|(flag, n)| [(*flag).to_owned(), n.to_string()]));
        arguments.extend(["--medium".into(), shot.medium.name.into()]);
        arguments.extend(shot.configuration.gather_flags(&shot.medium));
        if shot.configuration.summing != Summing::Walks {
            let file = calibration.as_ref().map_or("none".into(), |(path, _)| text(path));
            arguments.extend(["--calibration".into(), file]);
        }
        arguments.extend(shot.subject.flags.iter().map(|f| (*f).to_owned()));
        arguments.extend(shot.subject.view.iter().chain(&shot.more).cloned());
        let gathering = self.gather.run(&arguments, &self.folder.path().join("gather.json"))?;
        let picture = Picture::read(&image)?;
        let calibrating = calibration.map(|(_, spent)| spent);
        self.records.push(Record::of(shot, &sampling, calibrating.as_ref(), &gathering));
        Ok(Taken { picture, file: image, sampling, calibrating, gathering, record: self.records.len() - 1 })
    }

    /// Adds the error of an image to the record of its run.
    pub fn judge(&mut self, taken: &Taken, relative_rmse: f64, bias: Option<f64>) {
        let record = &mut self.records[taken.record];
        (record.relative_rmse, record.bias) = (Some(relative_rmse), bias);
    }

    /// Adds the error to the truth of an image to the record of its run.
    pub fn judge_truth(&mut self, taken: &Taken, relative_mse: f64) {
        self.records[taken.record].relative_mse = Some(relative_mse);
    }

    /// Removes all clouds, and the calibrations that belong to them.
    pub fn forget_clouds(&mut self) {
        self.made.forget();
    }
}

fn text(path: &Path) -> String {
    path.display().to_string()
}
