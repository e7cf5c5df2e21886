//! `gather CLOUD... SCENE -o IMAGE.exr`: arguments and files; the phase itself is the library.

mod adaptive;
mod arguments;
mod calibrated;
mod cameras;
mod continuation;
mod display;
mod exposed;
mod holes;
mod image_jobs;
mod inputs;
mod judge;
mod lists;
mod outputs;
mod report;
mod scale;
mod settings;
mod steps;
mod summary;
mod sums_file;
mod textured;

use adaptive::{End, Work};
use arguments::Arguments;
use bssrdf::Model;
use cli::{Asked, Failure, LitScene, Seconds, count};
use display::Display;
use formats::{atomic::Output, calibration::Calibration};
use gather::{Input, Passes};
use image_jobs::{ImageJob, image_jobs, image_paths};
use report::Facts;
use scene::{Rays, Scene};
use settings::{Request, Task};
use std::time::Instant;
use steps::{Clock, Live};
use tint::Tinted;

fn main() {
    let arguments: Arguments = cli::parse();
    cli::run("gather", || {
        match Task::of(arguments)? {
            Task::ListMedia => lists::media()?,
            Task::ListScene(wanted) => lists::scene(&wanted)?,
            Task::ListFiles { scene } => lists::paths(&Scene::files_of(&scene)?)?,
            Task::ListImages(names) => lists::paths(&image_paths(&names)?)?,
            Task::Render(request) => render(&request)?,
        }
        Ok(0)
    });
}

/// Everything that the images of a request need.
pub struct Prepared {
    inputs: LitScene,
    model: Model,
    /// The calibration that a file keeps.
    kept: Option<Calibration>,
    jobs: Vec<ImageJob>,
}

/// Renders all images of a request.
fn render(request: &Request) -> Result<(), Failure> {
    let (asked, mut seconds, clock) = (Asked::listen(), Seconds::start(), Clock::start(request.time_limit));
    let mut prepared = seconds.time("open", || prepare(request))?;
    let rays = seconds.time("ray_tree", || request.common.in_pool(|| prepared.inputs.rays()))?;
    let made = match prepared.kept {
        Some(_) => None,
        None => seconds.time("calibrate", || calibrated::make(request, &prepared, &rays, &clock))?,
    };
    let tints = textured::make(request, &prepared.inputs, &rays, prepared.model)?;
    seconds.time("exposure", || exposed::expose(request, (&prepared.inputs, &tints), &rays, &mut prepared.jobs))?;
    let calibration = prepared.kept.as_ref().or(made.as_ref());
    for (index, job) in prepared.jobs.iter().enumerate() {
        let deadline = clock.deadline(job, prepared.jobs.len() - index, request.common.thread_count());
        let image = ImageToRender { request, prepared: &prepared, rays: &rays, tints: &tints, calibration, job };
        image.render(&asked, deadline, seconds)?;
        seconds = Seconds::start();
    }
    Ok(())
}

/// Reads and checks everything, so that what can be refused is refused before the first ray.
fn prepare(request: &Request) -> Result<Prepared, Failure> {
    let mut files = inputs::declare(request)?;
    let kept = calibrated::read(request)?;
    let model = calibrated::model(request, kept.as_ref())?;
    let inputs = inputs::read(request, kept.as_ref(), &mut files)?;
    let mut jobs = image_jobs(request, &inputs, model)?;
    scale::show(request, &inputs, model);
    if request.reference {
        inputs.warn_of_blends("--reference", &request.common)?;
    }
    inputs::declare_continued(&mut files, request, &jobs)?;
    outputs::declare(&mut files, &request.outputs, &jobs)?;
    for job in &mut jobs {
        let prepared = continuation::prepare(request, &inputs, kept.as_ref(), job);
        prepared.map_err(|failure| job.failure(failure))?;
    }
    inputs.cloud_files.verify(request.common.thread_count())?;
    Ok(Prepared { inputs, model, kept, jobs })
}

/// One image with all that it is made from.
struct ImageToRender<'a> {
    request: &'a Request,
    prepared: &'a Prepared,
    rays: &'a Rays<'a>,
    tints: &'a [Option<Tinted>],
    calibration: Option<&'a Calibration>,
    job: &'a ImageJob,
}

impl ImageToRender<'_> {
    /// Renders the image and writes its files, all or none; `seconds` are those of the steps before it.
    fn render(&self, asked: &Asked, deadline: Option<Instant>, mut seconds: Seconds) -> Result<(), Failure> {
        let ImageToRender { request, prepared, rays, tints, calibration, job } = *self;
        let (common, inputs) = (&request.common, &prepared.inputs);
        let path = job.file(&request.outputs.image);
        let output = Output::create(&path)?;
        let (scene, clouds, media, camera) = (&inputs.scene, inputs.clouds(), &inputs.media, &job.camera);
        let part = job.settings.part();
        let start = |address: &String| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            Display::start(address, &name, [part.width, part.height], common)
        };
        let display = request.display.as_ref().map(start);
        let live = Live { deadline, asked, write: &|passes| self.write_so_far(passes), display };
        let work = Work {
            input: Input { scene, rays, clouds, media, tints, calibration, camera },
            job,
            common,
            before: continuation::read(request, job)?,
            live: &live,
            keeps_sums: request.outputs.keeps_sums,
        };
        let outcome = seconds.time("render", || common.in_pool(|| work.render(request.target_error)))??;
        inputs.cloud_files.check_unchanged()?;
        let facts = Facts::new((request, prepared), calibration, job, &outcome);
        holes::check(&outcome.rendered.counts, job)?;
        outputs::write(&facts, output, seconds)?;
        if let Some(display) = live.display {
            display.finish(part, &outcome.rendered.pixels);
        }
        summary::show(&facts)
    }

    /// Writes the files of the image with the paths that it has, as the user asked by a signal. A failure is said, and
    /// rendering goes on.
    fn write_so_far(&self, passes: &Passes) {
        let ImageToRender { request, prepared, calibration, job, .. } = *self;
        let outcome = adaptive::outcome(passes, End::Asked, request.outputs.keeps_sums);
        let facts = Facts::new((request, prepared), calibration, job, &outcome);
        let path = job.file(&request.outputs.image);
        let written = holes::check(&outcome.rendered.counts, job)
            .and_then(|()| Ok(prepared.inputs.cloud_files.check_unchanged()?))
            .and_then(|()| outputs::write(&facts, Output::create(&path)?, Seconds::start()));
        let paths = count(u64::from(passes.paths()));
        match written {
            Ok(()) => {
                request.common.say(format_args!("SIGUSR1: wrote {} with {paths} paths per pixel", path.display()))
            }
            Err(failure) => request.common.warn(format_args!("SIGUSR1: {}", failure.message)),
        }
    }
}
