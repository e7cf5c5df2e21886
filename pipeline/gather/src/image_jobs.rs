//! The images of one run: of one camera, of a turntable about a vertical axis, or of a list of views; each has files of
//! its own.

use crate::{
    cameras::{SIDE, Viewpoint, tag, viewpoints},
    settings::{ImageNames, Request},
};
use bssrdf::Model;
use cli::{Common, Failure, LitScene, Need};
use gather::{Crop, Settings};
use glam::{DMat3, DVec3};
use scene::{Camera, View, ViewFile};
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// Pixels that an image can have.
const MAX_PIXELS: u64 = 1 << 28;

/// Memory that a pixel takes at most, bytes: sums, their copies while a pass is joined, the pixel and its channels, and what
/// is known at its center if all pixels are edges.
const BYTES_PER_PIXEL: u64 = 1376;

/// The same of the sums that are kept, as numbers and as channels.
const BYTES_OF_SUMS: u64 = 1176;

/// Pixels whose sums a file can keep.
const MAX_KEPT_PIXELS: u64 = 1 << 24;

/// One image.
pub struct ImageJob {
    pub camera: Camera,
    pub settings: Settings,
    /// The angle by which a turntable has turned the camera.
    pub degrees: f64,
    /// The argument that chose the camera.
    pub argument: String,
    /// The exposure of its preview, in powers of two.
    pub stops: f64,
    /// The tag in the names of its files, before their extensions; none if there is only one image.
    tag: Option<String>,
}

/// All images of a request. Refuses those that cannot be rendered, before any work is done.
pub fn image_jobs(request: &Request, inputs: &LitScene, model: Model) -> Result<Vec<ImageJob>, Failure> {
    let mut jobs = Vec::new();
    for viewpoint in viewpoints(request, &inputs.scene, &inputs.framing())? {
        jobs.extend(turntable(request, &viewpoint, model)?);
    }
    warn_of_aspects(&jobs, &request.common);
    let kept = request.outputs.keeps_sums;
    jobs.iter().try_for_each(|job| check_memory(&job.settings, kept).map_err(|e| job.failure(e)))?;
    Ok(jobs)
}

/// The images of one camera: one, or as many as a turntable has steps.
fn turntable(request: &Request, viewpoint: &Viewpoint, model: Model) -> Result<Vec<ImageJob>, Failure> {
    let settings = settings(request, viewpoint, model).map_err(|e| named(e, viewpoint.tag.as_deref()))?;
    let count = request.orbit.unwrap_or(1);
    let job = |index: u32| {
        let degrees = 360.0 * f64::from(index) / f64::from(count);
        let camera = turned(&viewpoint.camera, viewpoint.target, degrees);
        let tag = viewpoint.tag.clone().or_else(|| request.orbit.map(|_| tag(None, index as usize)));
        let (argument, stops) = (viewpoint.argument.clone(), request.outputs.exposure);
        ImageJob { camera, settings: settings.clone(), degrees, argument, stops, tag }
    };
    Ok((0..count).map(job).collect())
}

/// The files of the images that the output becomes, in their order.
pub fn image_paths(names: &ImageNames) -> Result<Vec<PathBuf>, Failure> {
    let tags: Vec<String> = match (names.orbit, &names.view) {
        (Some(count), _) => (0..count as usize).map(|index| tag(None, index)).collect(),
        (None, Some(path)) => match View::read(path)? {
            ViewFile::One(_) => Vec::new(),
            ViewFile::List(views) => {
                views.iter().enumerate().map(|(index, (view, _))| tag(view.name.as_deref(), index)).collect()
            }
        },
        (None, None) => Vec::new(),
    };
    if tags.is_empty() {
        return Ok(vec![names.output.clone()]);
    }
    Ok(tags.iter().map(|tag| tagged(&names.output, tag)).collect())
}

/// How to render the image of a camera.
fn settings(request: &Request, viewpoint: &Viewpoint, model: Model) -> Result<Settings, Failure> {
    let (width, height) = size(request, viewpoint)?;
    Ok(Settings {
        width,
        height,
        crop: request.crop.map(|crop| inside(crop, width, height)).transpose()?,
        paths_per_pixel: request.paths,
        filter: request.filter,
        estimator: request.estimator,
        balances: request.balances(),
        model,
        // The other estimators are the sum over the samples alone.
        near_field: request.estimator.is_hierarchical() && !request.reference,
        reference: request.reference,
        normals: cli::normal_kind(request.scene.how.normals),
        max_depth: request.max_depth,
        seed: request.common.seed,
        backdrop: None,
    })
}

/// Width and height: options beat the view file, and what is missing follows from the camera's aspect.
fn size(request: &Request, viewpoint: &Viewpoint) -> Result<(usize, usize), Failure> {
    let [width, height] = if request.size == [None; 2] { viewpoint.size } else { request.size };
    let aspect = viewpoint.camera.aspect.unwrap_or(1.0);
    let (width, height) = match (width.map(f64::from), height.map(f64::from)) {
        (Some(width), Some(height)) => (width, height),
        (Some(width), None) => (width, (width / aspect).round()),
        (None, Some(height)) => ((height * aspect).round(), height),
        (None, None) => (f64::from(SIDE), (f64::from(SIDE) / aspect).round()),
    };
    let refused = |why: &str| Failure::usage(format!("--width, --height: {width} x {height} {why}"));
    if ![width, height].iter().all(|side| (1.0..=65536.0).contains(side)) {
        return Err(refused("pixels; each must lie between 1 and 65536"));
    }
    if width * height > MAX_PIXELS as f64 {
        return Err(refused(&format!("is more than {MAX_PIXELS} pixels")));
    }
    Ok((width as usize, height as usize))
}

/// The crop, if it lies inside the image.
fn inside(crop: Crop, width: usize, height: usize) -> Result<Crop, Failure> {
    let Crop { x, y, width: columns, height: rows } = crop;
    if x + columns <= width && y + rows <= height {
        return Ok(crop);
    }
    let image = format!("the image of {width} x {height} pixels");
    Err(Failure::usage(format!("--crop: {x},{y},{columns},{rows} is not inside {image}")))
}

/// Refuses an image that cannot fit into memory. The cloud is mapped.
fn check_memory(settings: &Settings, keeps_sums: bool) -> Result<(), Failure> {
    let pixels = settings.part().pixels() as u64;
    if keeps_sums && pixels > MAX_KEPT_PIXELS {
        return Err(Failure::usage(format!("--keep-sums: the sums of at most {MAX_KEPT_PIXELS} pixels can be kept")));
    }
    let held = pixels.saturating_mul(BYTES_PER_PIXEL + if keeps_sums { BYTES_OF_SUMS } else { 0 });
    cli::require_memory("this image", Need { held, mapped: 0 }, "make it smaller")
}

/// Warns once if the aspect ratio of any image differs from the one that its camera asks for.
fn warn_of_aspects(jobs: &[ImageJob], common: &Common) {
    let aspects = |job: &ImageJob| Some((job.camera.aspect?, job.settings.width as f64 / job.settings.height as f64));
    let misfit = |(wanted, own): &(f64, f64)| (wanted / own - 1.0).abs() > 0.01;
    if let Some((wanted, own)) = jobs.iter().filter_map(aspects).find(misfit) {
        common.warn(format_args!(
            "the camera's aspect is {wanted:.3}, the image's {own:.3}: its vertical field of view is kept"
        ));
    }
}

impl ImageJob {
    /// A failure of this image, which names the image if there are several.
    pub fn failure(&self, failure: Failure) -> Failure {
        named(failure, self.tag.as_deref())
    }

    /// A line about this image, which names the image if there are several.
    pub fn line(&self, line: &str) -> String {
        self.tag.as_ref().map_or_else(|| line.to_owned(), |tag| format!("{}: {line}", label(tag)))
    }

    /// The file of this image: `NAME.0007.exr` for `NAME.exr`, if there are several images.
    pub fn file(&self, path: &Path) -> PathBuf {
        self.tag.as_ref().map_or_else(|| path.to_owned(), |tag| tagged(path, tag))
    }
}

/// A camera turned about +Y through `target` (world, m), counter-clockwise seen from above.
fn turned(camera: &Camera, target: DVec3, degrees: f64) -> Camera {
    if degrees == 0.0 {
        // A rotation by 0 would round the camera.
        return camera.clone();
    }
    let turn = DMat3::from_rotation_y(degrees.to_radians());
    Camera {
        position: target + turn * (camera.position - target),
        right: turn * camera.right,
        up: turn * camera.up,
        forward: turn * camera.forward,
        ..camera.clone()
    }
}

/// The failure of an image, with its name if it has one.
fn named(failure: Failure, tag: Option<&str>) -> Failure {
    match tag {
        Some(tag) => failure.within(label(tag)),
        None => failure,
    }
}

/// The name of an image in messages.
fn label(tag: &str) -> String {
    format!("view {tag}")
}

fn tagged(path: &Path, tag: &str) -> PathBuf {
    let mut end = OsString::from(tag);
    if let Some(extension) = path.extension() {
        end.push(".");
        end.push(extension);
    }
    path.with_extension(end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Projection;

    /// A quarter of a turn, computed on paper. Seen to catch: a turn the other way, and one about the origin.
    #[test]
    fn a_quarter_turn_goes_from_the_front_to_the_right() {
        let camera = Camera {
            name: "front".into(),
            node: "front".into(),
            position: DVec3::new(1.0, 3.0, 7.0),
            right: DVec3::X,
            up: DVec3::Y,
            forward: DVec3::NEG_Z,
            projection: Projection::Perspective { tangent: 0.2 },
            lens: None,
            aspect: None,
        };
        let turned = super::turned(&camera, DVec3::new(1.0, 2.0, 2.0), 90.0);
        assert!(turned.position.distance(DVec3::new(6.0, 3.0, 2.0)) < 1e-12, "{}", turned.position);
        assert!(turned.forward.distance(DVec3::NEG_X) < 1e-12 && turned.right.distance(DVec3::NEG_Z) < 1e-12);
        assert!(turned.up.distance(DVec3::Y) < 1e-12);
        assert_eq!(super::turned(&camera, DVec3::splat(0.3), 0.0), camera);
    }

    #[test]
    fn files_are_numbered_before_their_extension() {
        assert_eq!(tagged(Path::new("a.b/turn.v2.exr"), "0007"), Path::new("a.b/turn.v2.0007.exr"));
        assert_eq!(tagged(Path::new("turn"), "front"), Path::new("turn.front"));
    }
}
