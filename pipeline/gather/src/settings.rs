//! The task of the program: the arguments, checked, before any file is read.

use crate::arguments::{Arguments, ExtraLayer};
use bssrdf::Model;
use cli::{Common, Failure, SceneSettings};
use gather::{Crop, Filter, estimator::Estimator};
use std::{
    path::{Path, PathBuf},
    time::Duration,
};

/// The task of the program.
pub enum Task {
    ListMedia,
    ListScene(SceneLists),
    ListFiles { scene: PathBuf },
    ListImages(ImageNames),
    Render(Box<Request>),
}

/// Lists of a scene's cameras and materials.
pub struct SceneLists {
    pub scene: SceneSettings,
    pub cameras: bool,
    pub materials: bool,
    pub common: Common,
}

/// The arguments that determine the names of images.
pub struct ImageNames {
    pub output: PathBuf,
    pub view: Option<PathBuf>,
    pub orbit: Option<u32>,
}

/// One image or several that are asked for.
pub struct Request {
    pub clouds: Vec<PathBuf>,
    pub scene: SceneSettings,
    pub camera: CameraSource,
    /// Steps of a turntable.
    pub orbit: Option<u32>,
    /// Requested width and height, pixels; a missing one follows from the camera.
    pub size: [Option<u32>; 2],
    pub crop: Option<Crop>,
    /// `[MATERIAL=]NAME|FILE.json`; a material without one has the medium that the scene gives it.
    pub media: Vec<String>,
    /// None for that of the calibration or, without one, the default.
    pub model: Option<Model>,
    pub calibration: CalibrationSource,
    pub estimator: Estimator,
    /// The accuracy that was given.
    pub accuracy: Option<f64>,
    /// Random walks instead of model and estimator.
    pub reference: bool,
    /// Paths per pixel, without those of an image that is continued; with a target error, the largest number.
    pub paths: u32,
    pub target_error: Option<f64>,
    pub time_limit: Option<Duration>,
    /// The image to which paths are added.
    pub continued: Option<PathBuf>,
    pub filter: Filter,
    pub max_depth: u32,
    /// Whether the camera sees a plain backdrop in place of the environment.
    pub backdrop: bool,
    pub outputs: Outputs,
    /// Where a viewer listens.
    pub display: Option<String>,
    pub verbose: bool,
    pub common: Common,
}

/// The source of the calibration.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrationSource {
    /// Made in memory, if the model is made for calibrations.
    Automatic,
    None,
    File(PathBuf),
}

/// The source of the cameras.
pub enum CameraSource {
    View(PathBuf),
    /// The camera of the scene with this name or index, or the first one.
    Scene(Option<String>),
}

/// The files to write; of several images, each has files of its own.
pub struct Outputs {
    pub image: PathBuf,
    pub preview: Option<PathBuf>,
    /// Exposure of the preview, in powers of two: added to that of the cloud and its media, unless it is fixed.
    pub exposure: f64,
    pub exposure_fixed: bool,
    pub stats: Option<PathBuf>,
    /// Whether the sums are kept beside the image, so that it can be continued.
    pub keeps_sums: bool,
    pub layers: Vec<ExtraLayer>,
    /// Whether the files may hold times, which differ from run to run.
    pub timings: bool,
}

/// Defaults of `--spp`: without a target error, and with one.
const PATHS: u32 = 16;
const MAX_PATHS: u32 = 4096;

/// Their defaults for random walks, whose paths are noisier.
const REFERENCE_PATHS: u32 = 64;
const MAX_REFERENCE_PATHS: u32 = 65536;

impl Request {
    /// Whether the noise of the paths decides the accuracy of the cut.
    pub fn balances(&self) -> bool {
        self.accuracy.is_none() && self.target_error.is_none() && self.estimator.is_hierarchical()
    }
}

impl Task {
    /// The task that the arguments describe.
    pub fn of(mut arguments: Arguments) -> Result<Task, Failure> {
        if arguments.list_media {
            return Ok(Task::ListMedia);
        }
        let scene = arguments.files.pop();
        if arguments.list_cameras || arguments.list_materials || arguments.list_files {
            let missing = || Failure::usage("--list-cameras, --list-files, --list-materials: give SCENE");
            let scene = scene.ok_or_else(missing)?;
            if !(arguments.list_cameras || arguments.list_materials) {
                return Ok(Task::ListFiles { scene });
            }
            return Ok(Task::ListScene(SceneLists {
                scene: SceneSettings { path: scene, how: arguments.scene_args },
                cameras: arguments.list_cameras,
                materials: arguments.list_materials,
                common: arguments.common,
            }));
        }
        let output = arguments.output.take().ok_or_else(|| Failure::usage("--output: give IMAGE.exr"))?;
        if arguments.list_images {
            return Ok(Task::ListImages(ImageNames { output, view: arguments.view, orbit: arguments.orbit }));
        }
        let scene = scene.filter(|_| !arguments.files.is_empty());
        let scene = scene.ok_or_else(|| Failure::usage("give CLOUD and then SCENE; see --help"))?;
        request(arguments, scene, output).map(|request| Task::Render(Box::new(request)))
    }
}

fn request(arguments: Arguments, scene: PathBuf, image: PathBuf) -> Result<Request, Failure> {
    let default = match (arguments.target_error.is_some(), arguments.reference) {
        (false, false) => PATHS,
        (true, false) => MAX_PATHS,
        (false, true) => REFERENCE_PATHS,
        (true, true) => MAX_REFERENCE_PATHS,
    };
    let paths = arguments.spp.unwrap_or(default);
    if paths == 1 && (arguments.keep_sums || arguments.continued.is_some()) {
        return Err(Failure::usage("--spp: one path has no second half to go on with; give 2 or more"));
    }
    Ok(Request {
        accuracy: arguments.accuracy,
        estimator: estimator(&arguments, paths)?,
        clouds: arguments.files,
        scene: SceneSettings { path: scene, how: arguments.scene_args },
        camera: arguments.view.map_or(CameraSource::Scene(arguments.camera), CameraSource::View),
        orbit: arguments.orbit,
        size: [arguments.width, arguments.height],
        crop: arguments.crop,
        media: arguments.medium,
        model: arguments.bssrdf,
        calibration: calibration(arguments.calibration),
        reference: arguments.reference,
        paths,
        target_error: arguments.target_error,
        time_limit: arguments.time_limit,
        filter: arguments.filter,
        max_depth: arguments.max_depth,
        backdrop: arguments.backdrop,
        outputs: Outputs {
            image,
            preview: arguments.preview,
            exposure: arguments.exposure,
            exposure_fixed: arguments.exposure_fixed,
            stats: arguments.stats,
            keeps_sums: arguments.keep_sums || arguments.continued.is_some(),
            layers: arguments.layers,
            timings: !arguments.no_timings,
        },
        continued: arguments.continued,
        display: arguments.display,
        verbose: arguments.verbose,
        common: arguments.common,
    })
}

/// The calibration of a file, or none for the word `none`.
fn calibration(argument: Option<PathBuf>) -> CalibrationSource {
    match argument {
        None => CalibrationSource::Automatic,
        Some(word) if word == Path::new("none") => CalibrationSource::None,
        Some(path) => CalibrationSource::File(path),
    }
}

/// The relative error that the cut may add to one gather of a pixel of so many paths.
pub fn accuracy_of_gather(estimator: Estimator, paths: u32) -> Option<f64> {
    Some(estimator.accuracy()? * f64::from(paths).sqrt())
}

/// The tenths of a target error that the cut may add: nearly half of its square is left to the paths.
const TENTHS: f64 = 7.5;

/// The estimator of this name with the parameters that were given, for so many paths per pixel.
fn estimator(arguments: &Arguments, paths: u32) -> Result<Estimator, Failure> {
    match arguments.estimator {
        Estimator::Cut { .. } => {
            let default = arguments
                .target_error
                .map_or_else(|| gather::accuracy_of_unknown_noise(paths), |target| target / 10.0 * TENTHS);
            Ok(Estimator::Cut { accuracy: arguments.accuracy.unwrap_or(default) })
        }
        _ if arguments.accuracy.is_some() => {
            Err(Failure::usage("--accuracy: only --estimator cut has an accuracy; leave it out"))
        }
        Estimator::Roulette(_) => Ok(Estimator::Roulette(arguments.roulette)),
        other => Ok(other),
    }
}
