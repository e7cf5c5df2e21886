//! Converged images.

use crate::{
    error::Error,
    speed::{configuration::Configuration, harness::Harness, measure::Reference, picture::Picture, shot::Shot},
};

/// The effort of a reference.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Independent clouds, each gathered under its own seed.
    pub clouds: u64,
    pub samples: u64,
    pub spp: u64,
}

/// First seed of references, whose seeds are used for nothing else.
const FIRST_SEED: u64 = 1000;

/// The converged image of a shot and its model, with the best configuration there is.
pub fn reference(harness: &mut Harness, shot: &Shot, quality: Quality) -> Result<Reference, Error> {
    harness
        .say(&format!("reference of {} {} {} x {}", shot.subject.name, shot.medium.name, shot.size[0], shot.size[1]));
    let mut pictures: Vec<Picture> = Vec::new();
    for seed in FIRST_SEED..FIRST_SEED + quality.clouds {
        let one = Shot {
            configuration: Configuration { model: shot.configuration.model, ..harness.all() },
            samples: quality.samples,
            spp: quality.spp,
            cloud_seed: seed,
            gather_seed: seed,
            threads: harness.threads,
            ..shot.clone()
        };
        pictures.push(harness.take(&one)?.picture);
    }
    Ok(Reference::of(&pictures))
}
