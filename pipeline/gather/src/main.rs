//! `gather CLOUD... SCENE -o IMAGE.exr`: arguments and files; the phase itself is the library.

mod adaptive;
mod arguments;
mod cameras;
mod cloud_files;
mod image_jobs;
mod inputs;
mod lists;
mod media;
mod outputs;
mod report;
mod scale;
mod settings;
mod summary;

use arguments::Arguments;
use clap::Parser;
use cli::{Failure, Seconds};
use formats::atomic::Output;
use gather::Input;
use image_jobs::{ImageJob, image_jobs, image_paths};
use inputs::Inputs;
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

/// Renders all images of a request.
fn render(request: &Request) -> Result<(), Failure> {
    let mut seconds = Seconds::start();
    let (inputs, jobs) = seconds.time("open", || prepare(request))?;
    let rays = seconds.time("ray_tree", || request.common.in_pool(|| inputs.rays()))?;
    for job in &jobs {
        render_image(request, &inputs, &rays, job, seconds)?;
        seconds = Seconds::start();
    }
    Ok(())
}

/// Reads and checks everything, so that what can be refused is refused before the first ray.
fn prepare(request: &Request) -> Result<(Inputs, Vec<ImageJob>), Failure> {
    let mut files = inputs::declare(request)?;
    let inputs = Inputs::read(request, &mut files)?;
    let jobs = image_jobs(request, &inputs)?;
    scale::show(request, &inputs);
    outputs::declare(&mut files, &request.outputs, &jobs)?;
    inputs.cloud_files.verify(request.common.thread_count())?;
    Ok((inputs, jobs))
}

/// Renders one image and writes its files, all or none; `seconds` are those of the steps before it.
fn render_image(
    request: &Request,
    inputs: &Inputs,
    rays: &Rays,
    job: &ImageJob,
    mut seconds: Seconds,
) -> Result<(), Failure> {
    let (common, settings) = (&request.common, &job.settings);
    let output = Output::create(&job.file(&request.outputs.image))?;
    let input =
        Input { scene: &inputs.scene, rays, clouds: inputs.clouds(), media: &inputs.media, camera: &job.camera };
    let rendered = seconds.time("render", || {
        common.in_pool(|| match request.target_error {
            None => adaptive::render_all(&input, settings, common),
            Some(target) => adaptive::render_to(target, &input, settings, common),
        })
    })?;
    inputs.cloud_files.check_unchanged()?;
    let facts = Facts::new(request, inputs, job, &rendered);
    summary::check_walks(&facts)?;
    outputs::write(&facts, output, seconds)?;
    summary::show(&facts)
}
