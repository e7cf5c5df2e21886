//! Continuing an image: the settings that its paths have in common, and those of the image that is continued.

use crate::{
    image_jobs::ImageJob,
    report::{Facts, describe},
    settings::{CalibrationSource, Request, accuracy_of_gather},
    sums_file::{self, About},
};
use cli::{Failure, LitScene};
use formats::{
    calibration::Calibration,
    cloud::{hex, shards},
};
use gather::{Settings, State, estimator::Estimator};
use std::path::Path;

/// The most paths of an image.
const MAX_PATHS: u32 = 1 << 20;

/// Sets the job to the paths of the image that is continued and those that are added, and to the accuracy of its gathers.
/// Refuses an image of other settings.
pub fn prepare(
    request: &Request,
    inputs: &LitScene,
    calibration: Option<&Calibration>,
    job: &mut ImageJob,
) -> Result<(), Failure> {
    let Some(path) = request.continued.as_ref().map(|path| job.file(path)) else { return Ok(()) };
    let (state, about) = sums_file::read(&path, request.common.thread_count())?;
    compare(&path, &about.settings, &settings(request, inputs, calibration, job))?;
    if state.planes.iter().any(|plane| plane.len() != job.settings.part().pixels()) {
        return Err(Failure::usage(format!("--continue: {}: its sums are of another size", path.display())));
    }
    let (found, added) = (state.paths, job.settings.paths_per_pixel);
    let all = found.checked_add(added).filter(|all| *all <= MAX_PATHS).ok_or_else(|| {
        Failure::usage(format!("--spp: {found} paths of {} and {added} are more than {MAX_PATHS}", path.display()))
    })?;
    job.settings.paths_per_pixel = all;
    if let (Estimator::Cut { .. }, None) = (job.settings.estimator, request.target_error) {
        let accuracy = accuracy(request, about.accuracy, all, &path)?;
        job.settings.estimator = Estimator::Cut { accuracy };
        job.settings.balances = false;
    }
    Ok(())
}

/// The sums of the image that is continued, if there is one.
pub fn read(request: &Request, job: &ImageJob) -> Result<Option<State>, Failure> {
    let path = request.continued.as_ref().map(|path| job.file(path));
    let kept = path.map(|path| sums_file::read(&path, request.common.thread_count())).transpose()?;
    Ok(kept.map(|(state, _)| state))
}

/// What is kept beside the sums of an image.
pub fn about(facts: &Facts) -> About {
    let Facts { request, inputs, kept, job, .. } = facts;
    let accuracy = accuracy_of_gather(facts.settings.estimator, facts.settings.paths_per_pixel).unwrap_or(0.0);
    About { settings: settings(request, inputs, *kept, job), accuracy }
}

/// The accuracy of a pixel of so many paths whose gathers have that of the image that is continued.
fn accuracy(request: &Request, kept: f64, paths: u32, path: &Path) -> Result<f64, Failure> {
    let root = f64::from(paths).sqrt();
    let same = |accuracy: f64| (accuracy * root / kept - 1.0).abs() < 1e-9;
    match request.accuracy {
        Some(given) if same(given) => Ok(given),
        Some(given) => Err(Failure::usage(format!(
            "--continue: --accuracy is {given}, and {} gathers as accurately as --accuracy {} of {paths} paths; leave it out",
            path.display(),
            kept / root
        ))),
        None => Ok(kept / root),
    }
}

/// The settings that change values, by the names of their options: NAME, a space, VALUE. The accuracy depends on the
/// number of paths, and is not among them.
fn settings(request: &Request, inputs: &LitScene, calibration: Option<&Calibration>, job: &ImageJob) -> Vec<String> {
    let Settings { width, height, crop, filter, estimator, model, reference, max_depth, seed, .. } = &job.settings;
    let (clouds, camera) = (inputs.clouds(), &job.camera);
    let how = match estimator {
        Estimator::Cut { .. } => estimator.name().to_owned(),
        other => other.to_string(),
    };
    let media = shards::materials(clouds).iter().zip(&inputs.media).map(|(m, medium)| describe(&m.name, medium));
    let calibration = match (calibration, &request.calibration) {
        (Some(calibration), _) => hex(&calibration.content),
        (None, CalibrationSource::Automatic) => "made in memory".into(),
        (None, _) => "none".into(),
    };
    let view = (camera.position, camera.right, camera.up, camera.forward, &camera.projection);
    // Sums that were kept before there were lenses have none.
    let lens = camera.lens.map_or(String::new(), |lens| format!(" {lens:?}"));
    let crop = crop.map_or("none".into(), |c| format!("{},{},{},{}", c.x, c.y, c.width, c.height));
    let backdrop = match (request.backdrop, request.outputs.exposure_fixed) {
        (false, _) => "none",
        (true, false) => "exposed",
        (true, true) => "fixed",
    };
    let mut all = vec![
        format!("gather {}", env!("CARGO_PKG_VERSION")),
        format!("CLOUD {}", hex(&shards::identity(clouds))),
        format!("--camera {view:?}{lens}"),
        format!("--width {width}"),
        format!("--height {height}"),
        format!("--crop {crop}"),
        format!("--filter {}", filter.name()),
        format!("--max-depth {max_depth}"),
        format!("--backdrop {backdrop}"),
        format!("--seed {seed}"),
        format!("--normals {}", request.scene.how.normals),
        format!("--reference {reference}"),
        format!("--medium {}", media.collect::<Vec<_>>().join("; ")),
    ];
    all.extend(inputs.scene.gloss_digest().map(|digest| format!("roughness {}", hex(&digest))));
    if !reference {
        all.extend([
            format!("--bssrdf {}", model.name()),
            format!("--calibration {calibration}"),
            format!("--estimator {how}"),
        ]);
    }
    all
}

/// Refuses an image of other settings, and names the first that differs.
fn compare(path: &Path, there: &[String], here: &[String]) -> Result<(), Failure> {
    let split = |setting: &String| {
        setting.split_once(' ').map_or((setting.clone(), String::new()), |(name, value)| (name.into(), value.into()))
    };
    let [there, here] = [there, here].map(|all| all.iter().map(split).collect::<Vec<(String, String)>>());
    let differs = there.iter().zip(&here).find(|(a, b)| a != b);
    let Some(((name, value), (_, own))) = differs else {
        return Ok(());
    };
    let is_short = value.len() < 48 && own.len() < 48;
    let values = if is_short { format!(": {value} there, {own} here") } else { String::new() };
    let path = path.display();
    Err(Failure::usage(format!(
        "--continue: {path}: {name} differs{values}; an image goes on with the settings that it began with"
    )))
}
