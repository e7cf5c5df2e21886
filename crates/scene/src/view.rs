//! Cameras: of the glTF file, or of a view file.

use crate::{
    error::SceneError,
    import::files,
    lens::{self, Aperture, Focus, Lens},
};
use glam::{DVec2, DVec3};
use serde::Deserialize;
use serde_json::Value;
use std::{collections::HashSet, fmt::Display, path::Path};

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Tangent of half the vertical field of view.
    Perspective { tangent: f64 },
    /// Half the height of what is seen, m.
    Orthographic { half_height: f64 },
}

/// A camera in world space, m, not relative to the scene's origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name of the camera, or else of its node: exporters number the nodes when names collide.
    pub name: String,
    /// Name of the node that carries it.
    pub node: String,
    pub position: DVec3,
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
    pub projection: Projection,
    /// None if all is in focus.
    pub lens: Option<Lens>,
    /// Width over height, if the file asks for one.
    pub aspect: Option<f64>,
}

impl Camera {
    /// Origin (world, m) and unit direction of the ray through `point` of an image of `size` pixels and, if there is a
    /// lens, through its middle; the top left corner is (0, 0).
    pub fn ray(&self, point: DVec2, size: DVec2) -> (DVec3, DVec3) {
        let x = (2.0 * point.x - size.x) / size.y;
        let y = 1.0 - 2.0 * point.y / size.y;
        match self.projection {
            Projection::Perspective { tangent } => {
                (self.position, (self.forward + tangent * (x * self.right + y * self.up)).normalize())
            }
            Projection::Orthographic { half_height } => {
                (self.position + half_height * (x * self.right + y * self.up), self.forward)
            }
        }
    }

    /// The point of an image of `size` pixels whose ray meets a world position, m; none behind a camera with a perspective.
    pub fn project(&self, position: DVec3, size: DVec2) -> Option<DVec2> {
        let offset = position - self.position;
        let scale = match self.projection {
            Projection::Perspective { tangent } => tangent * offset.dot(self.forward),
            Projection::Orthographic { half_height } => half_height,
        };
        let (x, y) = (offset.dot(self.right) / scale, offset.dot(self.up) / scale);
        (scale > 0.0).then(|| DVec2::new(0.5 * (x * size.y + size.x), 0.5 * (1.0 - y) * size.y))
    }

    /// The same as [`Camera::ray`], through the place on the lens that the uniform numbers `xi` choose.
    pub fn ray_through(&self, point: DVec2, size: DVec2, xi: [f64; 2]) -> (DVec3, DVec3) {
        let (origin, direction) = self.ray(point, size);
        let Some(lens) = self.lens else { return (origin, direction) };
        let (offset, direction) = lens.ray(direction / direction.dot(self.forward), [self.right, self.up], xi);
        (origin + offset, direction)
    }

    /// `worldToCamera` in OpenEXR's row-vector convention, row-major: the camera looks along −Z, Y is up.
    pub fn world_to_camera(&self) -> [f32; 16] {
        let mut m = [0.0f32; 16];
        for (c, axis) in [self.right, self.up, -self.forward].iter().enumerate() {
            for r in 0..3 {
                m[4 * r + c] = axis[r] as f32;
            }
            m[12 + c] = -self.position.dot(*axis) as f32;
        }
        m[15] = 1.0;
        m
    }

    /// The camera that looks along a unit vector; none if the vector upwards is parallel to it.
    pub(crate) fn looking(
        (name, node): (String, String),
        position: DVec3,
        [forward, up]: [DVec3; 2],
        projection: Projection,
        aspect: Option<f64>,
    ) -> Option<Camera> {
        let right = forward.cross(up).try_normalize()?;
        Some(Camera { name, node, position, right, up: right.cross(forward), forward, projection, lens: None, aspect })
    }
}

/// A camera in a file of its own, in metres and degrees.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// The name of its image, for a view of a list.
    pub name: Option<String>,
    pub eye: [f64; 3],
    pub target: [f64; 3],
    #[serde(default = "default_up")]
    pub up: [f64; 3],
    /// Vertical field of view, degrees.
    pub yfov: f64,
    pub width: Option<u32>,
    pub height: Option<u32>,
    /// The opening of its lens; none lets all be in focus.
    pub aperture: Option<Aperture>,
    /// What it focuses on: the target, if none is given.
    pub focus: Option<Focus>,
}

fn default_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

impl View {
    /// Reads and checks a view file: one view, or a list of them, as it is or as `{"views": [...]}`.
    pub fn read(path: &Path) -> Result<ViewFile, SceneError> {
        let text = files::read(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
        let stem = path.file_stem().map_or("view".into(), |s| s.to_string_lossy().into_owned());
        ViewFile::parse(&text, &stem).map_err(|what| SceneError::Invalid { path: path.to_owned(), what })
    }

    /// The text of a view file, in one line.
    pub fn json(&self) -> String {
        let three = |v: [f64; 3]| v.map(|x| x.to_string()).join(",");
        fn field<T: Display>(name: &str, value: Option<T>) -> String {
            value.map_or(String::new(), |value| format!(",\"{name}\":{value}"))
        }
        let name = self.name.as_ref().map_or(String::new(), |name| format!("\"name\":{},", Value::from(name.as_str())));
        format!(
            "{{{name}\"eye\":[{}],\"target\":[{}],\"up\":[{}],\"yfov\":{}{}{}{}{}}}",
            three(self.eye),
            three(self.target),
            three(self.up),
            self.yfov,
            field("width", self.width),
            field("height", self.height),
            field("aperture", self.aperture.as_ref()),
            field("focus", self.focus)
        )
    }

    pub(crate) fn with_camera(self, name: &str) -> Result<(View, Camera), String> {
        let name = self.name.as_deref().unwrap_or(name).to_owned();
        let [eye, target, up] = [self.eye, self.target, self.up].map(DVec3::from_array);
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return Err("fields `eye`, `target`, `up` must be finite numbers".into());
        }
        if !(self.yfov > 0.0 && self.yfov < 180.0) {
            return Err(format!("field `yfov`: {} is outside (0, 180) degrees", self.yfov));
        }
        let forward = (target - eye).try_normalize().ok_or("fields `eye` and `target` are the same point")?;
        let tangent = (0.5 * self.yfov).to_radians().tan();
        let projection = Projection::Perspective { tangent };
        let size = self.width.zip(self.height).filter(|(w, h)| *w > 0 && *h > 0);
        let aspect = size.map(|(w, h)| f64::from(w) / f64::from(h));
        let camera = Camera::looking((name.clone(), name), eye, [forward, up], projection, aspect);
        let camera = camera.ok_or("field `up` is zero or along the line of sight")?;
        let focus = self.focus.unwrap_or(Focus::Point(self.target));
        let lens = self.aperture.as_ref().map(|aperture| lens::of_view((aperture, focus), (eye, forward), tangent));
        let lens = lens.transpose()?.flatten();
        Ok((self, Camera { lens, ..camera }))
    }
}

/// The views of a file.
#[derive(Clone, Debug)]
pub enum ViewFile {
    One(Box<(View, Camera)>),
    /// At least one view. Names, or numbers for views without, differ by more than case and can be parts of file names.
    List(Vec<(View, Camera)>),
}

/// The largest number of views of a list.
const MAX_VIEWS: usize = 10_000;

/// The largest length of a view's name, bytes.
const MAX_NAME_BYTES: usize = 100;

const EXPECTED: &str = "expected {\"eye\": [x,y,z], \"target\": [x,y,z], \"up\", \"yfov\" (degrees), \"width\", \"height\", \"aperture\" (m or \"f/2.8\"), \"focus\" (m or [x,y,z])}, or a list of them";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Views {
    views: Vec<View>,
}

impl ViewFile {
    fn parse(text: &[u8], stem: &str) -> Result<ViewFile, String> {
        let fault = |e: serde_json::Error| format!("not a view: {e}; {EXPECTED}");
        let list: Vec<View> = match serde_json::from_slice(text).map_err(fault)? {
            Value::Array(list) => {
                check_views(&list)?;
                serde_json::from_slice(text).map_err(fault)?
            }
            Value::Object(fields) if fields.contains_key("views") => {
                fields["views"].as_array().map_or(Ok(()), |list| check_views(list))?;
                serde_json::from_slice::<Views>(text).map_err(fault)?.views
            }
            _ => {
                let view: View = serde_json::from_slice(text).map_err(fault)?;
                return view.with_camera(stem).map(|one| ViewFile::One(one.into()));
            }
        };
        if !(1..=MAX_VIEWS).contains(&list.len()) {
            return Err(format!("not a view: a list of {} views; there may be 1 to {MAX_VIEWS}", list.len()));
        }
        let mut names = HashSet::new();
        let mut read = |index: usize, view: View| {
            view.name.as_deref().map_or(Ok(()), check_name)?;
            // A view without a name is called by its number.
            let name = view.name.clone().unwrap_or_else(|| format!("{index:04}"));
            if !names.insert(name.to_ascii_lowercase()) {
                return Err(format!("field `name`: there are two `{name}`"));
            }
            view.with_camera(&format!("{stem} {name}"))
        };
        let views = list.into_iter().enumerate().map(|(k, v)| read(k, v).map_err(|e| format!("view {k}: {e}")));
        views.collect::<Result<_, String>>().map(ViewFile::List)
    }
}

/// Checks each view and names the first that is invalid. An array is refused, though serde reads structures from lists
/// of their fields. Fields that occur twice are found later, in the text.
fn check_views(list: &[Value]) -> Result<(), String> {
    list.iter().enumerate().try_for_each(|(k, value)| match View::deserialize(value) {
        Err(e) => Err(format!("view {k}: {e}; {EXPECTED}")),
        Ok(_) if !value.is_object() => Err(format!("view {k}: not an object; {EXPECTED}")),
        Ok(_) => Ok(()),
    })
}

/// Checks that a name can be the middle of any file name.
fn check_name(name: &str) -> Result<(), String> {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    if (1..=MAX_NAME_BYTES).contains(&name.len()) && name.chars().all(good) {
        return Ok(());
    }
    Err(format!("field `name`: {name:?} is not of 1 to {MAX_NAME_BYTES} letters, digits, `-` and `_`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to fail: names that are not checked; an empty list; a name that is also a number; names alike but for case.
    #[test]
    fn lists_are_read_and_their_faults_named() {
        let parse = |text: &str| ViewFile::parse(text.as_bytes(), "turn");
        let view = |more: &str| format!(r#"{{"eye":[0,0,2],"target":[0,0,0],"yfov":90{more}}}"#);
        let list = format!(r#"[{},{}]"#, view(r#","name":"a-1""#), view(""));
        for text in [list.clone(), format!(r#"{{"views":{list}}}"#)] {
            let Ok(ViewFile::List(views)) = parse(&text) else { panic!("{text}") };
            assert_eq!([0, 1].map(|k| views[k].1.name.clone()), ["a-1", "turn 0001"]);
            assert_eq!([0, 1].map(|k| views[k].0.name.clone()), [Some("a-1".into()), None]);
        }
        assert!(matches!(parse(&view("")), Ok(ViewFile::One(one)) if one.1.name == "turn"));
        let twice = format!("[{0},{0}]", view(r#","name":"a""#));
        let faults = [
            ("[]".into(), "0 views"),
            (format!(r#"{{"views":{list},"more":1}}"#), "more"),
            (format!("[{},3]", view("")), "view 1"),
            (format!("[{}]", view(r#","name":"../a""#)), "name"),
            (format!("[{}]", view(r#","name":"""#)), "name"),
            (twice, "two `a`"),
            (format!("[{}]", view(r#","yfov":30"#)), "duplicate field `yfov`"),
            (r#"{"views":[[null,[0,0,1],[0,0,0],[0,1,0],30,8,8]]}"#.into(), "view 0"),
            (format!("[{},{}]", view(r#","name":"a""#), view(r#","name":"A""#)), "two `A`"),
            (format!("[{},{}]", view(r#","name":"0001""#), view("")), "two `0001`"),
            (format!("[{}]", view(r#","yfoo":1"#)), "yfoo"),
        ];
        for (text, word) in faults {
            let message = parse(&text).unwrap_err();
            assert!(message.contains(word), "{text}: {message}");
        }
    }

    fn view(json: &str) -> Result<Camera, String> {
        let view: View = serde_json::from_str(json).map_err(|e| e.to_string())?;
        view.with_camera("test").map(|(_, camera)| camera)
    }

    #[test]
    fn corners_of_the_image_lie_where_the_field_of_view_says() {
        let camera = view(r#"{"eye":[0,0,2],"target":[0,0,0],"yfov":90}"#).expect("valid");
        let size = DVec2::new(200.0, 100.0);
        let (_, top_left) = camera.ray(DVec2::ZERO, size);
        assert!((top_left - DVec3::new(-2.0, 1.0, -1.0).normalize()).length() < 1e-15);
        let (_, center) = camera.ray(size / 2.0, size);
        assert!((center - DVec3::NEG_Z).length() < 1e-15);
    }

    /// Seen to catch: x and y exchanged, points behind the camera taken for ones before it, the width for the height.
    #[test]
    fn points_are_projected_to_where_their_rays_start() {
        let perspective = view(r#"{"eye":[1,2,3],"target":[4,2,-1],"yfov":30}"#).expect("valid");
        let orthographic = Camera { projection: Projection::Orthographic { half_height: 2.0 }, ..perspective.clone() };
        let size = DVec2::new(200.0, 100.0);
        for camera in [perspective, orthographic] {
            for point in [DVec2::ZERO, DVec2::new(30.5, 77.25), size] {
                let (origin, direction) = camera.ray(point, size);
                let projected = camera.project(origin + 7.0 * direction, size).expect("a point before the camera");
                assert!((projected - point).length() < 1e-9, "{point}: {projected}");
            }
            let behind = camera.project(camera.position - camera.forward, size);
            assert_eq!(behind.is_some(), matches!(camera.projection, Projection::Orthographic { .. }));
        }
    }

    /// OpenEXR multiplies row vectors: p · M.
    #[test]
    fn world_to_camera_takes_the_target_onto_the_negative_z_axis() {
        let camera = view(r#"{"eye":[1,2,3],"target":[4,2,-1],"yfov":30}"#).expect("valid");
        let m = camera.world_to_camera();
        let target = [4.0f32, 2.0, -1.0, 1.0];
        let column = |c: usize| (0..4).map(|r| target[r] * m[4 * r + c]).sum::<f32>();
        assert!(column(0).abs() < 1e-5 && column(1).abs() < 1e-5);
        assert!((column(2) + 5.0).abs() < 1e-5 && column(3) == 1.0);
    }

    #[test]
    fn nonsense_is_named() {
        assert!(view(r#"{"eye":[0,0,0],"target":[0,0,0],"yfov":30}"#).unwrap_err().contains("same point"));
        assert!(view(r#"{"eye":[0,0,1],"target":[0,0,0],"yfov":0}"#).unwrap_err().contains("yfov"));
        assert!(view(r#"{"eye":[0,1,0],"target":[0,0,0],"yfov":30}"#).unwrap_err().contains("up"));
        assert!(view(r#"{"eye":[0,1,0],"target":[0,0,0],"yfov":30,"fov":1}"#).unwrap_err().contains("fov"));
    }
}
