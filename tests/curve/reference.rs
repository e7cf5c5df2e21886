//! Converged images.

use crate::{
    bench::{Bench, Shot},
    error::Error,
    measure::Reference,
    picture::Picture,
};

/// How a reference is made.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Independent clouds, each gathered under its own seed.
    pub clouds: u64,
    pub samples: u64,
    pub spp: u64,
}

/// First seed of references: none of their seeds is used for anything else.
const FIRST_SEED: u64 = 1000;

/// The converged image of a shot, with the best configuration there is.
pub fn reference(bench: &mut Bench, shot: &Shot, quality: Quality) -> Result<Reference, Error> {
    bench.say(&format!("reference of {} {} {} x {}", shot.subject.name, shot.medium.name, shot.size[0], shot.size[1]));
    let mut pictures: Vec<Picture> = Vec::new();
    for seed in FIRST_SEED..FIRST_SEED + quality.clouds {
        let one = Shot {
            configuration: bench.all(),
            samples: quality.samples,
            spp: quality.spp,
            cloud_seed: seed,
            gather_seed: seed,
            threads: bench.threads,
            ..shot.clone()
        };
        pictures.push(bench.take(&one)?.picture);
    }
    Ok(Reference::of(&pictures))
}
