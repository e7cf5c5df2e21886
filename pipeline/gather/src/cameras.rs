//! The cameras that images are rendered from. They come from a view file or from the scene.

use crate::settings::{CameraSource, Request};
use cli::{Failure, Unclear, camera_names, the_one, word_for};
use scene::{Camera, DVec3, Scene, View, ViewFile};
use std::path::Path;

/// A camera with its name, its turntable's axis, and the size of its image.
pub struct Viewpoint {
    /// Its name in a list of views, if it has one.
    pub name: Option<String>,
    pub camera: Camera,
    /// The point that a turntable turns it about, world, m.
    pub target: DVec3,
    /// The argument that chose it.
    pub argument: String,
    /// Width and height that its view file asks for, pixels.
    pub size: [Option<u32>; 2],
}

/// One camera, or a list of them.
pub enum Viewpoints {
    One(Box<Viewpoint>),
    List(Vec<Viewpoint>),
}

/// The cameras of the view file, or the chosen camera of the scene, which turns about the `middle` of what it shows.
pub fn viewpoints(request: &Request, scene: &Scene, middle: impl Fn() -> DVec3) -> Result<Viewpoints, Failure> {
    match &request.camera {
        CameraSource::View(path) => of_view_file(path, request.orbit.is_some()),
        CameraSource::Scene(word) => {
            of_scene(word.as_deref(), scene, &request.scene.path, middle()).map(|own| Viewpoints::One(Box::new(own)))
        }
    }
}

fn of_view_file(path: &Path, turns: bool) -> Result<Viewpoints, Failure> {
    let viewpoint = |(view, camera): (View, Camera)| Viewpoint {
        name: view.name,
        camera,
        target: DVec3::from_array(view.target),
        argument: "--view".to_owned(),
        size: [view.width, view.height],
    };
    match View::read(path)? {
        ViewFile::One(one) => Ok(Viewpoints::One(Box::new(viewpoint(*one)))),
        ViewFile::List(_) if turns => {
            Err(Failure::usage(format!("--orbit: {} is a list of views; give only one of both", path.display())))
        }
        ViewFile::List(views) => Ok(Viewpoints::List(views.into_iter().map(viewpoint).collect())),
    }
}

/// The camera of the scene that a word on the command line names, or the first camera.
fn of_scene(word: Option<&str>, scene: &Scene, path: &Path, middle: DVec3) -> Result<Viewpoint, Failure> {
    let path = path.display();
    if scene.cameras.is_empty() {
        return Err(Failure::usage(format!("{path}: no camera; give one with --view FILE.json")));
    }
    let names = camera_names(scene);
    let index = match word.map_or(Ok(0), |word| the_one(word, &names, true)) {
        Ok(index) => index,
        Err(unclear) => {
            let word = word.unwrap_or_default();
            return Err(Failure::usage(match unclear {
                Unclear::Unknown { known } => format!("--camera: {path} has no `{word}`; it has {known}"),
                Unclear::Several { choices } => {
                    format!("--camera: `{word}` may be more than one camera of {path}: give one of {choices}")
                }
            }));
        }
    };
    Ok(Viewpoint {
        name: None,
        camera: scene.cameras[index].clone(),
        target: middle,
        argument: format!("--camera {}", word_for(index, &names, true)),
        size: [None; 2],
    })
}
