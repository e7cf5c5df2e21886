//! The task of the program: the arguments, checked, before any file is read.

use crate::arguments::Arguments;
use cli::{Common, Failure, SceneSettings, stored_unit};
use formats::cloud::{Choice, Options, Pattern, Shard};
use sample_surface::Settings;
use scene::Scene;
use std::path::PathBuf;

/// The task of the program.
pub enum Task {
    ListMaterials { scene: SceneSettings, common: Common },
    Sample(Box<Request>),
}

/// A requested cloud.
pub struct Request {
    pub scene: SceneSettings,
    pub output: PathBuf,
    pub ply: Option<PathBuf>,
    pub stats: Option<PathBuf>,
    /// Samples to draw, where no target decides it.
    pub samples: u64,
    pub shard: Shard,
    /// The medium, by name or file, and the relative error in it that decide the number of samples.
    pub target: Option<(String, f64)>,
    /// Words for the materials whose surfaces are sampled; none for those that the file marks.
    pub translucent: Vec<String>,
    pub choice: Choice,
    /// Words for materials, each with its share of the samples.
    pub shares: Vec<(String, f64)>,
    pub pattern: Pattern,
    pub common: Common,
}

impl Task {
    /// The task that the arguments describe.
    pub fn of(arguments: Arguments) -> Result<Task, Failure> {
        let scene = SceneSettings { path: arguments.scene, how: arguments.scene_args };
        let common = arguments.common;
        if arguments.list_materials {
            return Ok(Task::ListMaterials { scene, common });
        }
        Ok(Task::Sample(Box::new(Request {
            scene,
            output: arguments.output.ok_or_else(|| Failure::usage("--output: give CLOUD"))?,
            ply: arguments.ply,
            stats: arguments.stats,
            samples: arguments.samples,
            shard: arguments.shard,
            target: arguments.for_medium.zip(arguments.target_error),
            translucent: arguments.translucent,
            choice: arguments.choice,
            shares: arguments.share,
            pattern: arguments.pattern,
            common,
        })))
    }
}

impl Request {
    /// How to sample this scene, in its environment and pose.
    pub fn settings(&self, scene: &Scene) -> Settings {
        let options = Options {
            seed: self.common.seed,
            shard: self.shard,
            choice: self.choice,
            pattern: self.pattern,
            shares: self.shares.clone(),
            normals: self.scene.how.normals,
            metres_per_unit: self.scene.how.metres_per_unit,
            light_unit: stored_unit(scene.units.light),
            emission_unit: stored_unit(scene.units.emission),
            pose: scene.pose.clone(),
            environment: scene.environment.identity(),
        };
        Settings { samples: self.samples, options }
    }
}
