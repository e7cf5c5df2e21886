//! From arguments to a camera, a size, and how to render.

use crate::arguments::{Arguments, EstimatorName, FilterName, ModelName, RuleName};
use bssrdf::Model;
use cli::{Failure, Unclear, camera_names, the_one, word_for};
use gather::{
    Crop, Filter, Settings,
    estimator::{Estimator, Rule},
};
use scene::{Camera, DVec3, Scene, View, ViewFile};
use std::path::Path;

/// Default of `--accuracy`.
const ACCURACY: f64 = 0.01;

/// Default of `--spp`, and of the most paths that `--target-error` may take.
const PATHS: u32 = 16;
const MAX_PATHS: u32 = 4096;

pub fn estimator(arguments: &Arguments) -> Result<Estimator, Failure> {
    if arguments.accuracy.is_some() && arguments.estimator != EstimatorName::Cut {
        return Err(Failure::usage("--accuracy: only --estimator cut has an accuracy; leave it out"));
    }
    match arguments.estimator {
        EstimatorName::Cut => {
            // What the cut adds may be half of the error asked for: a quarter of its square.
            let default = arguments.target_error.map_or(ACCURACY, |target| 0.5 * target);
            Ok(Estimator::Cut { accuracy: arguments.accuracy.unwrap_or(default) })
        }
        EstimatorName::Exhaustive => Ok(Estimator::Exhaustive),
        EstimatorName::Roulette => Ok(Estimator::Roulette(match arguments.roulette {
            RuleName::Mixture => Rule::Mixture,
            RuleName::Mean => Rule::Mean,
            RuleName::Min => Rule::Min,
        })),
    }
}

/// A camera, the point that it turns about, and the size of image that its view file asks for.
#[derive(Clone)]
pub struct Chosen {
    pub camera: Camera,
    /// World, m.
    pub target: DVec3,
    /// The argument that chose it.
    pub argument: String,
    width: Option<u32>,
    height: Option<u32>,
}

/// The cameras of a list of views, each with its name if it has one.
pub type List = Vec<(Option<String>, Chosen)>;

/// One camera or a list of them.
pub enum Cameras {
    One(Box<Chosen>),
    List(List),
}

/// The cameras of the view file, which says what they look at, or one of the scene, which turns about the `middle`.
pub fn cameras(
    arguments: &Arguments,
    scene: &Scene,
    scene_path: &Path,
    middle: impl Fn() -> DVec3,
) -> Result<Cameras, Failure> {
    let Some(path) = &arguments.view else {
        return own_camera(arguments, scene, scene_path, middle).map(|own| Cameras::One(Box::new(own)));
    };
    let chosen = |view: View, camera: Camera| {
        let target = DVec3::from_array(view.target);
        let argument = "--view".to_owned();
        (view.name, Chosen { camera, target, argument, width: view.width, height: view.height })
    };
    match View::read(path)? {
        ViewFile::One(one) => Ok(Cameras::One(Box::new(chosen(one.0, one.1).1))),
        ViewFile::List(_) if arguments.orbit.is_some() => {
            Err(Failure::usage(format!("--orbit: {} is a list of views; give one of both", path.display())))
        }
        ViewFile::List(views) => Ok(Cameras::List(views.into_iter().map(|(v, camera)| chosen(v, camera)).collect())),
    }
}

/// A camera of the scene.
fn own_camera(
    arguments: &Arguments,
    scene: &Scene,
    scene_path: &Path,
    middle: impl Fn() -> DVec3,
) -> Result<Chosen, Failure> {
    if scene.cameras.is_empty() {
        let message = format!("{}: no camera; give one with --view FILE.json", scene_path.display());
        return Err(Failure::usage(message));
    }
    let names = camera_names(scene);
    let index = arguments.camera.as_deref().map_or(Ok(0), |word| the_one(word, &names, true));
    let index = index.map_err(|unclear| {
        let (path, wanted) = (scene_path.display(), arguments.camera.as_deref().unwrap_or_default());
        Failure::usage(match unclear {
            Unclear::Unknown { known } => format!("--camera: {path} has no `{wanted}`; it has {known}"),
            Unclear::Several { choices } => {
                format!("--camera: `{wanted}` may be more than one camera of {path}: give one of {choices}")
            }
        })
    })?;
    let argument = format!("--camera {}", word_for(index, &names, true));
    Ok(Chosen { camera: scene.cameras[index].clone(), target: middle(), argument, width: None, height: None })
}

/// Most pixels of an image.
const MAX_PIXELS: u64 = 1 << 28;

pub fn settings(arguments: &Arguments, chosen: &Chosen, estimator: Estimator) -> Result<Settings, Failure> {
    let (width, height) = size(arguments, chosen)?;
    if width as u64 * height as u64 > MAX_PIXELS {
        return Err(Failure::usage(format!("--width, --height: {width} x {height} is more than {MAX_PIXELS} pixels")));
    }
    let model = match arguments.bssrdf {
        ModelName::Directional => Model::DirectionalDipole,
        ModelName::Better => Model::BetterDipole,
        ModelName::Standard => Model::StandardDipole,
    };
    Ok(Settings {
        width,
        height,
        crop: arguments.crop.map(|crop| inside(crop, width, height)).transpose()?,
        paths_per_pixel: arguments.spp.unwrap_or(if arguments.target_error.is_some() { MAX_PATHS } else { PATHS }),
        filter: match arguments.filter {
            FilterName::Box => Filter::Box,
            FilterName::Point => Filter::Point,
        },
        estimator,
        model,
        normals: arguments.scene_args.normal_kind(),
        max_depth: arguments.max_depth,
        seed: arguments.common.seed,
    })
}

/// The crop, if the image has all of it.
fn inside(crop: Crop, width: usize, height: usize) -> Result<Crop, Failure> {
    let Crop { x, y, width: across, height: down } = crop;
    if x + across <= width && y + down <= height {
        return Ok(crop);
    }
    Err(Failure::usage(format!("--crop: {x},{y},{across},{down} is not inside the image of {width} x {height} pixels")))
}

/// Width and height: flags beat the view file, what is missing follows from the aspect.
fn size(arguments: &Arguments, chosen: &Chosen) -> Result<(usize, usize), Failure> {
    let given = (arguments.width, arguments.height);
    let (width, height) = if given == (None, None) { (chosen.width, chosen.height) } else { given };
    let aspect = chosen.camera.aspect.unwrap_or(1.0);
    let (width, height) = match (width, height) {
        (Some(w), Some(h)) => (f64::from(w), f64::from(h)),
        (Some(w), None) => (f64::from(w), (f64::from(w) / aspect).round()),
        (None, Some(h)) => ((f64::from(h) * aspect).round(), f64::from(h)),
        (None, None) => (512.0, (512.0 / aspect).round()),
    };
    let good = |x: f64| (1.0..=65536.0).contains(&x);
    if good(width) && good(height) {
        return Ok((width as usize, height as usize));
    }
    Err(Failure::usage(format!("--width, --height: {width} x {height} pixels; each must lie between 1 and 65536")))
}
