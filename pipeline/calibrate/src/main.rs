//! `calibrate CLOUD... SCENE -o FILE.calibration`: arguments and files; the work itself is the library `calibration`.

mod arguments;
mod report;

use arguments::Arguments;
use calibration::{Task, calibrate};
use clap::Parser;
use cli::{Failure, LitScene, Media, Progress, Seconds, declare_inputs};
use formats::atomic::Group;
use std::path::PathBuf;

fn main() {
    let arguments = Arguments::parse();
    cli::run("calibrate", || {
        run(arguments)?;
        Ok(0)
    });
}

fn run(mut arguments: Arguments) -> Result<(), Failure> {
    let missing = || Failure::usage("give CLOUD and then SCENE; see --help");
    let scene = arguments.files.pop().filter(|_| !arguments.files.is_empty()).ok_or_else(missing)?;
    let mut seconds = Seconds::start();
    let request = Request { scene: cli::SceneSettings { path: scene, how: arguments.scene_args.clone() }, arguments };
    let lit = seconds.time("open", || request.read())?;
    let common = &request.arguments.common;
    let rays = seconds.time("ray_tree", || common.in_pool(|| lit.rays()))?;
    let task = Task {
        scene: &lit.scene,
        rays: &rays,
        clouds: lit.clouds(),
        media: &lit.media,
        model: request.arguments.bssrdf,
        normals: cli::normal_kind(request.scene.how.normals),
        walks: request.arguments.walks,
        seed: common.seed,
    };
    let progress = Progress::start(common, "calibrating", task.work(), "walks and points");
    let calibration = seconds
        .time("walks", || common.in_pool(|| calibrate(&task, |done| progress.add(done))))?
        .map_err(|e| Failure::usage(format!("{}: {e}", request.scene.path.display())))?;
    progress.finish();
    lit.cloud_files.check_unchanged()?;
    let mut files = Group::default();
    let output = &request.arguments.output;
    files.write(output, &calibration.encode(output)?)?;
    if let Some(path) = &request.arguments.stats {
        files.write(path, &report::statistics(&calibration, common, &seconds))?;
    }
    files.commit()?;
    report::lines(&calibration).iter().for_each(|line| common.say(line));
    Ok(())
}

/// What is asked for.
struct Request {
    arguments: Arguments,
    scene: cli::SceneSettings,
}

impl Request {
    /// Reads and checks everything, so that what can be refused is refused before the first walk.
    fn read(&self) -> Result<LitScene, Failure> {
        let Arguments { files: clouds, medium, common, output, stats, .. } = &self.arguments;
        let mut files = declare_inputs(clouds, &self.scene, medium)?;
        let lit = LitScene::read(clouds, &self.scene, Media::Named(medium), common, &mut files)?;
        let outputs: [(&str, Option<&PathBuf>); 2] = [("--output", Some(output)), ("--stats", stats.as_ref())];
        for (option, path) in outputs {
            path.map_or(Ok(()), |path| files.writes(option, path))?;
        }
        lit.cloud_files.verify(common.thread_count())?;
        Ok(lit)
    }
}
