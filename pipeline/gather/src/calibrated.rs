//! The calibration that images are rendered with: of a file, or made in memory before the first image.

use crate::{
    Prepared,
    settings::{CalibrationSource, Request},
    steps::Clock,
};
use bssrdf::{Medium, MediumFile, Model, Optics, Unit};
use calibration::{CalibrateError, Task, WALKS, calibrate};
use cli::{Failure, LitScene, Progress, quoted};
use formats::{
    calibration::{CalibratedMaterial, Calibration},
    cloud::shards,
};
use scene::Rays;
use std::path::Path;

/// The calibration of a file that the request names.
pub fn read(request: &Request) -> Result<Option<Calibration>, Failure> {
    match &request.calibration {
        CalibrationSource::File(path) => Ok(Some(Calibration::read(path)?)),
        CalibrationSource::Automatic | CalibrationSource::None => Ok(None),
    }
}

/// The model that was asked for, or else that of the calibration, or else the default.
pub fn model(request: &Request, kept: Option<&Calibration>) -> Result<Model, Failure> {
    let Some(kept) = kept else {
        return Ok(request.model.unwrap_or(Model::ALL[0]));
    };
    let known = Model::ALL.into_iter().find(|model| model.name() == kept.model);
    let model = known.ok_or_else(|| refused(request, &format!("of an unknown model, `{}`", kept.model)))?;
    match request.model {
        Some(asked) if asked != model => {
            Err(refused(request, &format!("of the {}, and --bssrdf is {}", model.name(), asked.name())))
        }
        _ => Ok(model),
    }
}

fn refused(request: &Request, why: &str) -> Failure {
    let path = match &request.calibration {
        CalibrationSource::File(path) => path.as_path(),
        CalibrationSource::Automatic | CalibrationSource::None => Path::new(""),
    };
    Failure::usage(format!("--calibration: {}: this calibration is {why}; calibrate again", path.display()))
}

/// The media of a calibration.
pub fn media(kept: &Calibration) -> Result<Vec<Medium>, Failure> {
    let medium = |m: &CalibratedMaterial| {
        let facts = &m.medium;
        Medium::new(MediumFile {
            name: facts.name.clone(),
            unit: Unit::Metre,
            optics: Optics::Coefficients { sigma_a: facts.sigma_a, sigma_s: facts.sigma_s },
            g: facts.g,
            eta: facts.eta,
            source: facts.source.clone(),
        })
    };
    Ok(kept.materials.iter().map(medium).collect::<Result<_, _>>()?)
}

/// Refuses a calibration of another cloud, of other media than those asked for, or of surfaces of another roughness.
pub fn check_fit(request: &Request, lit: &LitScene, kept: &Calibration) -> Result<(), Failure> {
    if kept.cloud != shards::identity(lit.clouds()) || kept.materials.len() != lit.media.len() {
        return Err(refused(request, "of another cloud"));
    }
    let own = media(kept)?;
    for (medium, (asked, material)) in own.iter().zip(lit.media.iter().zip(&kept.materials)) {
        if medium.channels != asked.channels || medium.eta != asked.eta {
            let (medium, asked, material) = (&medium.name, &asked.name, &material.name);
            let why = format!("of `{material}` as {medium}, and --medium is {asked}: leave out --medium or");
            return Err(refused(request, &why));
        }
        if material.roughness != lit.scene.roughness_digest(material.index) {
            return Err(refused(request, &format!("of `{}` with another roughness", material.name)));
        }
    }
    Ok(())
}

/// The share of the time left that a calibration may take, and the share of the walks that tells how long all would.
const TIME_SHARE: f64 = 0.3;
const TRIED: u64 = 32;

/// Calibrates in memory if the request leaves that to the program and the model is made for it. A scene that cannot be
/// calibrated is rendered without, with a warning. If the time is limited, there may be fewer walks.
pub fn make(
    request: &Request,
    prepared: &Prepared,
    rays: &Rays,
    clock: &Clock,
) -> Result<Option<Calibration>, Failure> {
    let (lit, model) = (&prepared.inputs, prepared.model);
    let automatic =
        request.calibration == CalibrationSource::Automatic && model.is_for_calibration() && !request.reference;
    if !automatic || lit.media.iter().all(Medium::is_clear) {
        return Ok(None);
    }
    let common = &request.common;
    lit.warn_of_blends("the calibration", common)?;
    let normals = cli::normal_kind(request.scene.how.normals);
    let (clouds, media, seed) = (lit.clouds(), &lit.media, common.seed);
    let run = |walks: u64| {
        let task = Task { scene: &lit.scene, rays, clouds, media, model, normals, walks, seed };
        let progress = Progress::start(common, "calibrating", task.work(), "walks and points");
        let made = common.in_pool(|| calibrate(&task, |done| progress.add(done)))?;
        Ok::<_, Failure>((made, progress.finish()))
    };
    let (made, seconds) = match clock.left().map(|left| TIME_SHARE * left) {
        None => run(WALKS)?,
        Some(time) => {
            let (tried, seconds) = run(WALKS / TRIED)?;
            let walks = walks_in(time - seconds, seconds);
            if walks < WALKS {
                let share = 100.0 * walks.max(WALKS / TRIED) as f64 / WALKS as f64;
                common.say(format_args!("--time-limit: calibrating with {share:.0} % of the walks"));
            }
            if walks > WALKS / TRIED && tried.is_ok() { run(walks)? } else { (tried, seconds) }
        }
    };
    match made {
        Ok(calibration) => {
            let command = command(request);
            common.say(format_args!("calibrated in {seconds:.1} s; to keep that for all cameras: {command}"));
            Ok(Some(calibration))
        }
        Err(error @ (CalibrateError::Open { .. } | CalibrateError::Dark { .. })) => {
            common.warn(format_args!("not calibrated: {error}"));
            Ok(None)
        }
    }
}

/// The walks that `time` is enough for, given how long a few of them took, s.
fn walks_in(time: f64, of_few: f64) -> u64 {
    let share = time / (TRIED as f64 * of_few.max(1e-9));
    (WALKS as f64 * share.clamp(0.0, 1.0)) as u64
}

/// The command that keeps the calibration in a file.
fn command(request: &Request) -> String {
    let mut words = vec!["calibrate".to_owned()];
    words.extend(request.clouds.iter().map(|path| path.display().to_string()));
    words.push(request.scene.path.display().to_string());
    words.extend(request.media.iter().flat_map(|medium| ["--medium".into(), medium.clone()]));
    words.extend(request.scene.how.words());
    if request.common.seed != 0 {
        words.extend(["--seed".into(), request.common.seed.to_string()]);
    }
    words.extend(["-o".into(), request.clouds[0].with_extension("calibration").display().to_string()]);
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thirty-second of the walks in a second: all in 32, half in 16, and none where no time is left.
    #[test]
    fn walks_fit_into_the_time() {
        assert_eq!([32.0, 100.0, 16.0, 0.0, -1.0].map(|time| walks_in(time, 1.0)), [WALKS, WALKS, WALKS / 2, 0, 0]);
    }
}
