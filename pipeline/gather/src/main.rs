//! `gather CLOUD... SCENE -o IMAGE.exr`: arguments and files; the phase itself is the library.

mod adaptive;
mod arguments;
mod calibrated;
mod cameras;
mod exposed;
mod holes;
mod image_jobs;
mod inputs;
mod lists;
mod outputs;
mod report;
mod scale;
mod settings;
mod summary;

use arguments::Arguments;
use bssrdf::Model;
use clap::Parser;
use cli::{Failure, LitScene, Seconds};
use formats::{atomic::Output, calibration::Calibration};
use gather::Input;
use image_jobs::{ImageJob, image_jobs, image_paths};
use report::Facts;
use scene::{Rays, Scene};
use settings::{Request, Task};

fn main() {
    let arguments = Arguments::parse();
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
struct Prepared {
    inputs: LitScene,
    model: Model,
    /// The calibration that a file keeps.
    kept: Option<Calibration>,
    jobs: Vec<ImageJob>,
}

/// Renders all images of a request.
fn render(request: &Request) -> Result<(), Failure> {
    let mut seconds = Seconds::start();
    let Prepared { inputs, model, kept, mut jobs } = seconds.time("open", || prepare(request))?;
    let rays = seconds.time("ray_tree", || request.common.in_pool(|| inputs.rays()))?;
    let calibration = match kept {
        Some(kept) => Some(kept),
        None => seconds.time("calibrate", || calibrated::make(request, &inputs, &rays, model))?,
    };
    seconds.time("exposure", || exposed::expose(request, &inputs, &rays, &mut jobs))?;
    for job in &jobs {
        render_image(request, &inputs, &rays, calibration.as_ref(), job, seconds)?;
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
    let jobs = image_jobs(request, &inputs, model)?;
    scale::show(request, &inputs, model);
    outputs::declare(&mut files, &request.outputs, &jobs)?;
    inputs.cloud_files.verify(request.common.thread_count())?;
    Ok(Prepared { inputs, model, kept, jobs })
}

/// Renders one image and writes its files, all or none; `seconds` are those of the steps before it.
fn render_image(
    request: &Request,
    inputs: &LitScene,
    rays: &Rays,
    calibration: Option<&Calibration>,
    job: &ImageJob,
    mut seconds: Seconds,
) -> Result<(), Failure> {
    let common = &request.common;
    let output = Output::create(&job.file(&request.outputs.image))?;
    let (scene, clouds, media, camera) = (&inputs.scene, inputs.clouds(), &inputs.media, &job.camera);
    let input = Input { scene, rays, clouds, media, calibration, camera };
    let rendered = seconds.time("render", || {
        common.in_pool(|| match request.target_error {
            None => adaptive::render_all(&input, job, common),
            Some(target) => adaptive::render_to(target, &input, job, common),
        })
    })??;
    inputs.cloud_files.check_unchanged()?;
    let facts = Facts::new(request, inputs, calibration, job, &rendered);
    holes::check(&rendered.counts, job)?;
    outputs::write(&facts, output, seconds)?;
    summary::show(&facts)
}
