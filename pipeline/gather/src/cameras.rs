//! The cameras that images are rendered from. They come from a view file or from the scene.

use crate::settings::{CameraSource, Request};
use cli::{Candidate, Failure, Unclear, camera_names, made_camera_names, the_one, word_for};
use scene::{Camera, DVec3, Framing, Placed, Scene, View, ViewFile};
use std::path::Path;

/// A camera with its name, its turntable's axis, and the size of its image.
pub struct Viewpoint {
    /// Its tag among the views of a list, see [`tag`]; none if it is the only one.
    pub tag: Option<String>,
    pub camera: Camera,
    /// The point that a turntable turns it about, world, m.
    pub target: DVec3,
    /// The argument that chose it.
    pub argument: String,
    /// Width and height that its view file asks for, pixels.
    pub size: [Option<u32>; 2],
}

/// The tag of an image: the name of its view, or else its index.
pub fn tag(name: Option<&str>, index: usize) -> String {
    name.map_or_else(|| format!("{index:04}"), str::to_owned)
}

/// The cameras of the view file, the chosen camera of the scene, which turns about the middle of the translucent
/// surfaces, or one that is made to frame them if the scene has none.
pub fn viewpoints(request: &Request, scene: &Scene, surfaces: &Framing) -> Result<Vec<Viewpoint>, Failure> {
    match &request.camera {
        CameraSource::View(path) => of_view_file(path, request.orbit.is_some()),
        CameraSource::Scene(word) if is_made(word.as_deref(), scene) => {
            Ok(vec![made(word.as_deref(), request, surfaces)?])
        }
        CameraSource::Scene(word) => {
            Ok(vec![of_scene(word.as_deref(), scene, &request.scene.path, surfaces.middle())?])
        }
    }
}

/// Whether a word means a camera that is made: that of its name unless the scene has one of that name, or any if the
/// scene has none.
fn is_made(word: Option<&str>, scene: &Scene) -> bool {
    let named = |word: &str| {
        let own = matches!(the_one(word, &camera_names(scene), true), Ok(_) | Err(Unclear::Several { .. }));
        !own && Placed::ALL.into_iter().any(|placed| placed.name() == word)
    };
    scene.cameras.is_empty() || word.is_some_and(named)
}

/// Side of an image, pixels, unless another is asked for.
pub const SIDE: u32 = 512;

/// A camera that is made, and said as a view file that repeats it.
fn made(word: Option<&str>, request: &Request, surfaces: &Framing) -> Result<Viewpoint, Failure> {
    let path = request.scene.path.display();
    let missing = format!("{path} has no camera, and none called `{}` is made; there are", word.unwrap_or_default());
    let placed = Placed::ALL[chosen(word, &made_camera_names(), &missing, "camera")?];
    let name = placed.name();
    let [width, height] = request.size;
    let [width, height] = [width.or(height), height.or(width)].map(|side| side.unwrap_or(SIDE));
    let framed = surfaces.view(placed, f64::from(width) / f64::from(height), request.orbit.is_some());
    let nothing = || Failure::usage(format!("{path}: nothing to frame; give a camera with --view FILE.json"));
    let (view, camera) = framed.ok_or_else(nothing)?;
    let view = View { width: Some(width), height: Some(height), ..view };
    let json = view.json();
    request.common.say(format_args!(
        "{path}: seen by --camera {name}, which is made; to keep it: echo '{json}' > {name}.json, then --view {name}.json"
    ));
    Ok(Viewpoint {
        tag: None,
        camera,
        target: DVec3::from_array(view.target),
        argument: format!("--view {json}"),
        size: [view.width, view.height],
    })
}

/// The index of the camera that a word means, or the first.
fn chosen(word: Option<&str>, names: &[Candidate], missing: &str, kind: &str) -> Result<usize, Failure> {
    let Some(word) = word else { return Ok(0) };
    the_one(word, names, true).map_err(|unclear| Failure::usage(unclear.message("--camera", word, missing, kind)))
}

fn of_view_file(path: &Path, turns: bool) -> Result<Vec<Viewpoint>, Failure> {
    let viewpoint = |tag: Option<String>, view: &View, camera: Camera| Viewpoint {
        tag,
        camera,
        target: DVec3::from_array(view.target),
        argument: "--view".to_owned(),
        size: [view.width, view.height],
    };
    match View::read(path)? {
        ViewFile::One(one) => Ok(vec![viewpoint(None, &one.0, one.1)]),
        ViewFile::List(_) if turns => {
            Err(Failure::usage(format!("--orbit: {} is a list of views; give only one of both", path.display())))
        }
        ViewFile::List(views) => {
            let tagged = |(index, (view, camera)): (usize, (View, Camera))| {
                viewpoint(Some(tag(view.name.as_deref(), index)), &view, camera)
            };
            Ok(views.into_iter().enumerate().map(tagged).collect())
        }
    }
}

/// The camera of the scene that a word on the command line names, or the first camera.
fn of_scene(word: Option<&str>, scene: &Scene, path: &Path, middle: DVec3) -> Result<Viewpoint, Failure> {
    let path = path.display();
    let names = camera_names(scene);
    let missing = format!("{path} has no `{}`; it has", word.unwrap_or_default());
    let index = chosen(word, &names, &missing, &format!("camera of {path}"))?;
    Ok(Viewpoint {
        tag: None,
        camera: scene.cameras[index].clone(),
        target: middle,
        argument: format!("--camera {}", word_for(index, &names, true)),
        size: [None; 2],
    })
}
