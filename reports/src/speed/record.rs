//! `speed.csv`: one line for each run.

use crate::{program::Spent, speed::shot::Shot};

/// One run of `gather`, with the runs of `sample-surface` and `calibrate` that it drew on.
#[derive(Clone, Debug)]
pub struct Record {
    scene: String,
    medium: &'static str,
    configuration: &'static str,
    /// None for random walks.
    model: &'static str,
    walks: Option<u64>,
    samples: u64,
    spp: u64,
    accuracy: String,
    cloud_seed: u64,
    gather_seed: u64,
    threads: usize,
    size: [u64; 2],
    seconds_sample: f64,
    seconds_calibrate: Option<f64>,
    seconds_gather: f64,
    cpu_seconds: f64,
    /// Error of the whole image, if there was a reference.
    pub relative_rmse: Option<f64>,
    /// Relative bias of the whole image.
    pub bias: Option<f64>,
    /// `relMSE` to the exact image, if there was one.
    pub relative_mse: Option<f64>,
}

const HEADER: &str = "scene,medium,configuration,model,walks,K,spp,accuracy,cloud seed,gather seed,threads,width,height,\
                      seconds sample,seconds calibrate,seconds gather,CPU seconds,relative RMSE,bias,\
                      relMSE to the truth\n";

impl Record {
    pub fn of(shot: &Shot, sampling: &Spent, calibrating: Option<&Spent>, gathering: &Spent) -> Record {
        let cpu = calibrating.map_or(0.0, |c| c.cpu);
        Record {
            scene: shot.subject.name.clone(),
            medium: shot.medium.name,
            configuration: shot.configuration.name,
            model: shot.configuration.model_name(),
            walks: shot.walks,
            samples: shot.samples,
            spp: shot.spp,
            accuracy: shot.configuration.accuracy(),
            cloud_seed: shot.cloud_seed,
            gather_seed: shot.gather_seed,
            threads: shot.threads,
            size: shot.size,
            seconds_sample: sampling.wall,
            seconds_calibrate: calibrating.map(|c| c.wall),
            seconds_gather: gathering.wall,
            cpu_seconds: sampling.cpu + cpu + gathering.cpu,
            relative_rmse: None,
            bias: None,
            relative_mse: None,
        }
    }

    fn line(&self) -> String {
        let optional = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.5}"));
        let [width, height] = self.size;
        // Names may contain a comma, but no quotation mark.
        format!(
            "{},{},\"{}\",{},{},{},{},{},{},{},{},{width},{height},{:.4},{},{:.4},{:.2},{},{},{}\n",
            self.scene,
            self.medium,
            self.configuration,
            self.model,
            self.walks.map_or(String::new(), |n| n.to_string()),
            self.samples,
            self.spp,
            self.accuracy,
            self.cloud_seed,
            self.gather_seed,
            self.threads,
            self.seconds_sample,
            self.seconds_calibrate.map_or(String::new(), |s| format!("{s:.4}")),
            self.seconds_gather,
            self.cpu_seconds,
            optional(self.relative_rmse),
            optional(self.bias),
            self.relative_mse.map_or(String::new(), |x| format!("{x:.3e}")),
        )
    }
}

/// The whole table.
pub fn table(records: &[Record]) -> String {
    records.iter().fold(HEADER.to_owned(), |text, record| text + &record.line())
}
