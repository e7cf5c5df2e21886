//! The cameras that images are rendered from. They come from a view file or from the scene.

use crate::settings::{CameraSource, Request};
use cli::{Failure, camera_names, the_one, word_for};
use scene::{Camera, DVec3, Scene, View, ViewFile};
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

/// The cameras of the view file, or the chosen camera of the scene, which turns about the `middle` of what it shows.
pub fn viewpoints(request: &Request, scene: &Scene, middle: impl Fn() -> DVec3) -> Result<Vec<Viewpoint>, Failure> {
    match &request.camera {
        CameraSource::View(path) => of_view_file(path, request.orbit.is_some()),
        CameraSource::Scene(word) => Ok(vec![of_scene(word.as_deref(), scene, &request.scene.path, middle())?]),
    }
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
    if scene.cameras.is_empty() {
        return Err(Failure::usage(format!("{path}: no camera; give one with --view FILE.json")));
    }
    let names = camera_names(scene);
    let index = match word {
        None => 0,
        Some(word) => the_one(word, &names, true).map_err(|unclear| {
            let missing = format!("{path} has no `{word}`; it has");
            Failure::usage(unclear.message("--camera", word, &missing, &format!("camera of {path}")))
        })?,
    };
    Ok(Viewpoint {
        tag: None,
        camera: scene.cameras[index].clone(),
        target: middle,
        argument: format!("--camera {}", word_for(index, &names, true)),
        size: [None; 2],
    })
}
