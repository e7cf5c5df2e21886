//! The lens of a camera: what is not in focus is blurred by the disc through which light reaches the picture
//! (docs/method.md 13.7).

use crate::warp;
use glam::DVec3;
use serde::Deserialize;
use std::fmt;

/// Height of the picture that f-numbers are meant for, m: that of 35 mm film.
pub const FILM_HEIGHT: f64 = 0.024;

/// Largest radius of a lens, and largest distance of its focus, m.
const MAX_RADIUS: f64 = 1e6;
const MAX_FOCUS: f64 = 1e12;

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the opening, m; above zero.
    pub radius: f64,
    /// Distance of the plane in focus from the camera along the line of sight, m.
    pub focus: f64,
}

impl Lens {
    /// `N` of `f/N`, by the focal length with which film of 35 mm has the field of view, half of whose vertical angle
    /// has this tangent.
    pub fn f_number(&self, tangent: f64) -> f64 {
        0.5 * focal_length(tangent) / self.radius
    }

    /// The ray that crosses the lens where `xi` says, uniformly over its area, and the plane in focus where the ray
    /// through its middle does. That ray starts at the camera's place in the direction `direction`, whose part along the
    /// line of sight is 1. Returns the place on the lens from its middle, m, and a unit direction.
    pub(crate) fn ray(&self, direction: DVec3, [right, up]: [DVec3; 2], xi: [f64; 2]) -> (DVec3, DVec3) {
        let [x, y] = warp::disk(xi);
        let offset = self.radius * (x * right + y * up);
        (offset, (self.focus * direction - offset).normalize())
    }
}

/// The focal length with which film of 35 mm has a field of view, m: `f = h/(2 tan)` with the height `h` of the film.
fn focal_length(tangent: f64) -> f64 {
    0.5 * FILM_HEIGHT / tangent
}

/// The opening of a lens as a view states it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "field `aperture` must be the radius of the lens in m, or a text like \"f/2.8\"")]
pub enum Aperture {
    /// m.
    Radius(f64),
    /// `f/N`.
    FNumber(String),
}

impl Aperture {
    /// The radius, m: half of `f/N`.
    fn radius(&self, tangent: f64) -> Result<f64, String> {
        let radius = match self {
            Aperture::Radius(radius) => Some(*radius),
            Aperture::FNumber(text) => text
                .strip_prefix("f/")
                .and_then(|n| n.parse().ok())
                .map(|n: f64| if n > 0.0 { 0.5 * focal_length(tangent) / n } else { f64::NAN }),
        };
        let fault = || {
            format!("field `aperture`: {self} is neither a radius from 0 to {MAX_RADIUS} m nor \"f/2.8\" or the like")
        };
        radius.filter(|r| (0.0..=MAX_RADIUS).contains(r)).ok_or_else(fault)
    }
}

impl fmt::Display for Aperture {
    /// As in JSON.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Aperture::Radius(radius) => write!(f, "{radius}"),
            Aperture::FNumber(text) => write!(f, "{}", serde_json::Value::from(text.as_str())),
        }
    }
}

/// What a view focuses on.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "field `focus` must be a distance in m, or a point [x,y,z]")]
pub enum Focus {
    /// Along the line of sight, m.
    Distance(f64),
    /// A point of the plane in focus, world, m.
    Point([f64; 3]),
}

impl fmt::Display for Focus {
    /// As in JSON.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Focus::Distance(distance) => write!(f, "{distance}"),
            Focus::Point([x, y, z]) => write!(f, "[{x},{y},{z}]"),
        }
    }
}

/// The lens of a view from `eye` along the unit vector `forward`; none if it has no opening. Half of its vertical field of
/// view has this tangent.
pub(crate) fn of_view(
    (aperture, focus): (&Aperture, Focus),
    (eye, forward): (DVec3, DVec3),
    tangent: f64,
) -> Result<Option<Lens>, String> {
    let radius = aperture.radius(tangent)?;
    let distance = match focus {
        Focus::Distance(distance) => distance,
        Focus::Point(point) => (DVec3::from_array(point) - eye).dot(forward),
    };
    if distance > 0.0 && distance <= MAX_FOCUS {
        return Ok((radius > 0.0).then_some(Lens { radius, focus: distance }));
    }
    Err(format!("field `focus`: {focus} is {distance} m before the camera; that must be above zero"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{Camera, View};
    use glam::DVec2;
    use serde_json::json;

    const SIZE: DVec2 = DVec2::new(300.0, 200.0);

    fn view(fields: serde_json::Value) -> Result<(View, Camera), String> {
        let mut view = json!({ "eye": [1, 2, 7], "target": [1, 2, 5], "yfov": 30 });
        view.as_object_mut().expect("an object").extend(fields.as_object().expect("an object").clone());
        serde_json::from_value::<View>(view).map_err(|e| e.to_string())?.with_camera("test")
    }

    fn lens(fields: serde_json::Value) -> Lens {
        view(fields).expect("a view").1.lens.expect("a lens")
    }

    /// Places around the rim of the lens, and in it.
    fn across() -> impl Iterator<Item = [f64; 2]> {
        (0..=8).flat_map(|i| (0..=8).map(move |j| [f64::from(i) / 8.0, f64::from(j) / 8.0]))
    }

    /// The rays of one place of the image meet in the plane in focus, where the pinhole's is.
    ///
    /// Seen to catch: a focus at that distance along each ray, which is a sphere; rays parallel to the pinhole's.
    #[test]
    fn the_plane_in_focus_is_that_of_a_pinhole() {
        let (_, camera) = view(json!({ "aperture": 0.1, "focus": 3.0 })).expect("a view");
        for place in [[150.0, 100.0], [3.0, 190.0], [299.0, 4.0]] {
            let plane = |(origin, direction): (DVec3, DVec3)| {
                assert!((direction.length() - 1.0).abs() < 1e-14);
                let height = (origin - camera.position).dot(camera.forward);
                origin + direction * ((3.0 - height) / direction.dot(camera.forward))
            };
            let sharp = plane(camera.ray(place.into(), SIZE));
            for xi in across() {
                assert!(plane(camera.ray_through(place.into(), SIZE, xi)).distance(sharp) < 1e-12);
            }
        }
    }

    /// The circle of confusion by the thin-lens formula, `c = A f |z − F|/(z (F − f))` on the film, of a lens of focal
    /// length `f` and diameter `A` that is focused at `F`, and a point at the depth `z`. Its film lies `v` behind the lens,
    /// `1/v = 1/f − 1/F`, and has that field of view.
    ///
    /// Seen to catch: the radius of the lens in place of its diameter; the distance to the focus not divided by it.
    #[test]
    fn a_point_out_of_focus_is_a_circle_of_confusion() {
        let (focal, diameter, focus): (f64, f64, f64) = (0.05, 0.025, 0.8);
        let film = 1.0 / (1.0 / focal - 1.0 / focus);
        let yfov = (2.0 * (0.5 * FILM_HEIGHT / film).atan()).to_degrees();
        let (_, camera) = view(json!({ "aperture": 0.5 * diameter, "focus": focus, "yfov": yfov })).expect("a view");
        for depth in [0.3, 0.6, 0.8, 2.0, 50.0] {
            let point = DVec3::new(1.02, 2.01, 7.0 - depth);
            // Where the ray through a place of the image crosses the plane of the point; this is linear in the place.
            let crosses = |place: DVec2, xi: [f64; 2]| {
                let (origin, direction) = camera.ray_through(place, SIZE, xi);
                (origin + direction * ((point.z - origin.z) / direction.z)).truncate()
            };
            let seen_at = |xi: [f64; 2]| {
                let [a, b] = [DVec2::ZERO, SIZE].map(|place| crosses(place, xi));
                (point.truncate() - a) / (b - a) * SIZE
            };
            let places: Vec<DVec2> = across().map(seen_at).collect();
            let widest = places.iter().flat_map(|a| places.iter().map(|b| a.distance(*b))).fold(0.0, f64::max);
            let expected = diameter * focal * (depth - focus).abs() / (depth * (focus - focal));
            assert!((widest / SIZE.y * FILM_HEIGHT - expected).abs() < 1e-12, "{depth}: {widest}");
        }
    }

    /// By radius or f-number, at a distance, a point or the target; no opening is no lens.
    ///
    /// Seen to catch: the diameter of an f-number in place of its radius; the distance of a point that is not on the axis.
    #[test]
    fn views_state_lenses() {
        assert_eq!(lens(json!({ "aperture": 0.01 })), Lens { radius: 0.01, focus: 2.0 });
        assert_eq!(lens(json!({ "aperture": 0.01, "focus": 3 })), Lens { radius: 0.01, focus: 3.0 });
        assert_eq!(lens(json!({ "aperture": 0.01, "focus": [5, 9, 4.5] })), Lens { radius: 0.01, focus: 2.5 });
        // 35 mm film has a vertical field of view of 30 degrees at a focal length of 44.8 mm.
        let of_number = lens(json!({ "aperture": "f/2.8" }));
        assert!((of_number.radius - 0.0448 / 5.6).abs() < 1e-5, "{of_number:?}");
        assert!((of_number.f_number(15f64.to_radians().tan()) - 2.8).abs() < 1e-12);
        for none in [json!({}), json!({ "aperture": 0 }), json!({ "focus": 3 }), json!({ "aperture": null })] {
            assert_eq!(view(none).expect("a view").1.lens, None);
        }
        let (said, _) = view(json!({ "aperture": "f/2.8", "focus": [1, 2, 3] })).expect("a view");
        assert!(said.json().ends_with(r#""aperture":"f/2.8","focus":[1,2,3]}"#), "{}", said.json());
    }

    /// Seen to catch: apertures and focuses that are not checked.
    #[test]
    fn wrong_lenses_are_named() {
        for wrong in [json!(-0.1), json!(1e9), json!("f/0"), json!("f/-1"), json!("2.8"), json!("f/x"), json!([1])] {
            let message = view(json!({ "aperture": wrong })).expect_err("refused");
            assert!(message.contains("`aperture`"), "{wrong}: {message}");
        }
        for wrong in [json!(0), json!(-2), json!([1, 2, 8]), json!("target"), json!([1, 2])] {
            let message = view(json!({ "aperture": 0.1, "focus": wrong })).expect_err("refused");
            assert!(message.contains("`focus`"), "{wrong}: {message}");
        }
    }
}
