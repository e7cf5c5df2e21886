//! Draws and writes the cloud, or keeps the existing file if it is up to date.

use crate::{inputs::Inputs, search::search, settings::Request, surfaces::failure};
use cli::{Failure, Progress, Seconds};
use formats::{
    atomic::{Group, Output},
    cloud::{self, Cloud},
};
use sample_surface::{Plan, SampleError, Sampled, sample};
use scene::Rays;
use std::{fs::OpenOptions, path::Path, time::SystemTime};

/// The cloud that was asked for.
pub struct Made {
    pub cloud: Cloud,
    /// True if an up-to-date file was there already.
    pub kept: bool,
}

/// Keeps the cloud of the output file if it is the one that is asked for, and undamaged; makes it otherwise, as one of
/// `files`.
pub fn make_or_keep(
    request: &Request,
    inputs: &Inputs,
    seconds: &mut Seconds,
    files: &mut Group,
) -> Result<Made, Failure> {
    let path = &request.output;
    if is_current(path, &inputs.plan) {
        touch(path);
        request.common.say(format_args!("{}: up to date, kept", path.display()));
        return Ok(Made { cloud: Cloud::open(path)?, kept: true });
    }
    let mut output = Output::create(path)?;
    request.common.in_pool(|| make(request, inputs, seconds, &mut output))??;
    let cloud = Cloud::open(output.written()?)?;
    files.add(output);
    Ok(Made { cloud, kept: false })
}

/// Whether the file already is the planned cloud, undamaged.
fn is_current(path: &Path, plan: &Plan) -> bool {
    Cloud::open(path).is_ok_and(|cloud| cloud.meta().content == plan.content && cloud.verify(path).is_ok())
}

/// Renews the time of modification, so that make does not ask for the file again.
fn touch(path: &Path) {
    if let Ok(file) = OpenOptions::new().append(true).open(path) {
        file.set_modified(SystemTime::now()).ok();
    }
}

fn make(request: &Request, inputs: &Inputs, seconds: &mut Seconds, output: &mut Output) -> Result<(), Failure> {
    let rays = seconds.time("ray_tree", || Rays::of_scene(&inputs.scene, |material| inputs.plan.samples(material)));
    let sampled = seconds.time("sample", || match inputs.goal() {
        Some(goal) => search(request, inputs, &rays, &goal),
        None => draw(request, inputs, &rays),
    });
    let sampled = sampled.map_err(|e| failure(request, &e))?;
    seconds.time("write", || cloud::write(output, &request.output, &sampled.content, &sampled.meta))?;
    Ok(())
}

/// Draws as many samples as are asked for.
fn draw(request: &Request, inputs: &Inputs, rays: &Rays) -> Result<Sampled, SampleError> {
    let progress = Progress::start(&request.common, "sampling", request.samples, "samples");
    let sampled = sample(&inputs.scene, rays, &inputs.settings, &inputs.plan, |n| progress.add(n))?;
    progress.finish();
    Ok(sampled)
}
