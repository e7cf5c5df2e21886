//! `calibrate CLOUD... SCENE -o FILE.calibration`: arguments and files; the work itself is the library `calibration`.

mod arguments;
mod report;

use arguments::Arguments;
use calibration::{Task, WALKS, calibrate};
use cli::{Common, Failure, LitScene, Media, Progress, Seconds, declare_inputs};
use formats::{atomic::Group, calibration::Calibration};
use std::path::PathBuf;

fn main() {
    let arguments: Arguments = cli::parse();
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
        walks: request.arguments.walks.unwrap_or(WALKS),
        seed: common.seed,
    };
    lit.warn_of_blends("the calibration", common)?;
    let calibration = seconds.time("walks", || match request.arguments.target_error {
        None => once(&task, common),
        Some(target) => until(target, &task, common),
    });
    let calibration = calibration.map_err(|failure| failure.within(request.scene.path.display()))?;
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

/// Follows the walks of a task.
fn once(task: &Task, common: &Common) -> Result<Calibration, Failure> {
    let progress = Progress::start(common, "calibrating", task.work(), "walks and points");
    let made = common.in_pool(|| calibrate(task, |done| progress.add(done)))?;
    progress.finish();
    made.map_err(Failure::from)
}

/// Most walks with a target error, and by how many times they grow.
const MAX_WALKS: u64 = 1 << 30;
const GROWTH: u64 = 4;

/// More walks that leave more than this share of the error are the last.
const USELESS: f64 = 0.8;

/// Follows more and more walks until the worst channel meets the target, or they no longer help.
fn until(target: f64, task: &Task, common: &Common) -> Result<Calibration, Failure> {
    let error = |c: &Calibration| {
        let all = c.materials.iter().flat_map(|m| m.errors.map(|e| e.after));
        all.fold(0.0, f64::max).sqrt()
    };
    let mut calibration = once(task, common)?;
    loop {
        let (reached, walks) = (error(&calibration), calibration.walks.saturating_mul(GROWTH));
        if reached <= target {
            return Ok(calibration);
        }
        let stays = |why: &str| common.warn(format_args!("the error stays at about {reached:.3}: {why}"));
        if walks > MAX_WALKS {
            stays("more walks are not followed");
            return Ok(calibration);
        }
        calibration = once(&Task { walks, ..*task }, common)?;
        if error(&calibration) > USELESS * reached && error(&calibration) > target {
            stays("more walks do not help");
            return Ok(calibration);
        }
    }
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
        let lit = LitScene::read(clouds, &self.scene, Media::Named(medium), common, &mut files, false)?;
        let outputs: [(&str, Option<&PathBuf>); 2] = [("--output", Some(output)), ("--stats", stats.as_ref())];
        for (option, path) in outputs {
            path.map_or(Ok(()), |path| files.writes(option, path))?;
        }
        lit.cloud_files.verify(common.thread_count())?;
        Ok(lit)
    }
}
