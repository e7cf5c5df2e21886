//! Cameras for scenes that have none: each frames the translucent surfaces.

use crate::{
    light::{Light, contract::channel_sum},
    mesh::SurfacePoint,
    scene::Scene,
    view::{Camera, View},
};
use glam::{DMat3, DVec3};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    f64::consts::{PI, TAU},
};

/// A camera that is made for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placed {
    /// Three quarters from the front, which is +Z in glTF.
    Front,
    /// On the other side of the surfaces than most of the light.
    Backlit,
}

impl Placed {
    pub const ALL: [Placed; 2] = [Placed::Front, Placed::Backlit];

    /// The word that users type.
    pub fn name(self) -> &'static str {
        match self {
            Placed::Front => "front",
            Placed::Backlit => "backlit",
        }
    }

    /// The degrees about +Y, counter-clockwise seen from above, by which the front is turned to `away`, a direction
    /// from the surfaces; 0 if that is vertical.
    pub fn turned_to(away: DVec3) -> f64 {
        let degrees = away.x.atan2(away.z).to_degrees() - FRONT_DEGREES;
        if away.x == 0.0 && away.z == 0.0 { 0.0 } else { degrees }
    }
}

/// Vertical field of view, degrees.
const YFOV_DEGREES: f64 = 40.0;

/// The surfaces fill this share of the image's height, or less if they would fill more than the other of its width.
const FILLED: [f64; 2] = [0.9, 0.8];

/// Angle above the horizon, and that of the front from +Z towards +X, degrees.
const ELEVATION_DEGREES: f64 = 15.0;
const FRONT_DEGREES: f64 = 30.0;

/// Steps of a turn in all of which the surfaces must be framed, and the heights that are told apart.
const TURNS: u32 = 36;
const RINGS: f64 = 256.0;

/// Steps in which a camera is fitted.
const STEPS: u32 = 5;

/// Light whose horizontal part is less than this comes from above or from all around.
const UPRIGHT: f64 = 0.1;

/// Positions of cameras are rounded to so many digits of their distance, so that they can be typed.
const DIGITS: f64 = 5.0;

/// Samples of each light along both of its coordinates, by which the direction of most of the light is found.
const LIGHT_SAMPLES: u32 = 4;

/// The translucent surfaces of a scene as cameras frame them.
pub struct Framing<'a> {
    scene: &'a Scene,
    /// Corners of their triangles, m from their middle.
    corners: Vec<DVec3>,
    /// The middle of the box around them, m from the scene's origin.
    middle: DVec3,
    /// The extent of that box, m.
    size: DVec3,
}

impl Framing<'_> {
    /// The surfaces of these materials.
    pub fn new(scene: &Scene, is_of: impl Fn(u16) -> bool) -> Framing<'_> {
        let (low, high) = scene.bounds_of(&is_of);
        let (middle, size) = (0.5 * (low + high), high - low);
        let corners = scene.corners_of(is_of).map(|p| p - middle).collect();
        Framing { scene, corners, middle, size }
    }

    /// The middle of the box around them, world, m.
    pub fn middle(&self) -> DVec3 {
        self.scene.origin + self.middle
    }

    /// The extent of the box around them, m.
    pub fn size(&self) -> DVec3 {
        self.size
    }

    /// The view of a made camera for an image of this aspect; none if there are no surfaces. If it `turns`, it shows
    /// them wherever it is turned to about the vertical axis through its target.
    pub fn view(&self, placed: Placed, aspect: f64, turns: bool) -> Option<(View, Camera)> {
        if self.corners.is_empty() {
            return None;
        }
        let azimuth = match placed {
            Placed::Front => FRONT_DEGREES.to_radians(),
            Placed::Backlit => self.opposite_of_light(),
        };
        let elevation = ELEVATION_DEGREES.to_radians();
        let away = DVec3::new(azimuth.sin(), elevation.tan(), azimuth.cos()).normalize();
        let right = DVec3::Y.cross(away).normalize();
        let axes = [right, away.cross(right), away];
        let tangent = (0.5 * YFOV_DEGREES).to_radians().tan();
        let slopes = [FILLED[0] * tangent * aspect, FILLED[1] * tangent];
        let [beside, above, distance] = fitted(&self.turned(turns), axes, slopes);
        let beside = if turns { 0.0 } else { beside };
        let eye = beside * axes[0] + above * axes[1] + distance * away;
        // The target is on the vertical axis through the middle, about which an orbit turns.
        let target = eye - away * (distance - above * elevation.tan());
        let decimals = DIGITS - distance.log10().ceil();
        let rounded = |p: DVec3| (self.middle() + p).to_array().map(|x| round(x, decimals));
        let view = View {
            name: None,
            eye: rounded(eye),
            target: rounded(target),
            up: [0.0, 1.0, 0.0],
            yfov: YFOV_DEGREES,
            width: None,
            height: None,
            aperture: None,
            focus: None,
        };
        view.with_camera(placed.name()).ok()
    }

    /// The points that must be seen, m from the middle: the corners or, of surfaces that turn, those that are farthest
    /// out at their heights, wherever they are turned to.
    fn turned(&self, turns: bool) -> Cow<'_, [DVec3]> {
        if !turns {
            return Cow::Borrowed(&self.corners);
        }
        let mut rings: BTreeMap<i64, DVec3> = BTreeMap::new();
        for p in &self.corners {
            let ring = rings.entry((RINGS * p.y / self.size.max_element()).floor() as i64).or_insert(*p);
            let radius = |q: &DVec3| q.x.hypot(q.z);
            *ring =
                DVec3::new(radius(ring).max(radius(p)), if p.y < 0.0 { ring.y.min(p.y) } else { ring.y.max(p.y) }, 0.0);
        }
        let turns = (0..TURNS).map(|k| DMat3::from_rotation_y(TAU * f64::from(k) / f64::from(TURNS)));
        turns.flat_map(|turn| rings.values().map(move |p| turn * *p)).collect()
    }

    /// The azimuth from which most of the light is behind the surfaces, from +Z towards +X, rad.
    fn opposite_of_light(&self) -> f64 {
        let light = self.light();
        if light.length() == 0.0 || light.x.hypot(light.z) < UPRIGHT * light.length() {
            return FRONT_DEGREES.to_radians() + PI;
        }
        (-light.x).atan2(-light.z)
    }

    /// The sum of the directions towards light, each times its irradiance, in the middle of the surfaces if nothing is
    /// in the way.
    fn light(&self) -> DVec3 {
        let normals = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let points = normals.map(|normal| SurfacePoint::smooth(self.middle, normal, normal, 0, 0));
        let points: Vec<SurfacePoint> = points.collect();
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(LIGHT_SAMPLES);
        let numbers = || (0..LIGHT_SAMPLES).flat_map(|x| (0..LIGHT_SAMPLES).map(move |y| [at(x), at(y)]));
        let of_light = |light: &dyn Light| -> DVec3 {
            let samples = points.iter().flat_map(|point| numbers().filter_map(|xi| light.illuminate(point, xi)));
            samples.map(|sample| sample.direction * channel_sum(sample.irradiance)).sum()
        };
        self.scene.lights().map(of_light).sum()
    }
}

/// Where the eye sees all points within these slopes to both sides of its axis, across and upwards, and fills one of
/// them: its position along the axes to the right, upwards and towards it, m.
///
/// A point at `x` beside an eye at `e` is within a slope `s` if `|x - e| <= s (d - z)` at its depth `z` and the
/// distance `d` of the eye, so that two points decide `e` and `d` for each slope. The larger distance is the one; the
/// other slope is then reduced to what its points fill, in a few steps, so that these are in the middle too.
fn fitted(points: &[DVec3], [right, up, away]: [DVec3; 3], mut slopes: [f64; 2]) -> [f64; 3] {
    let mut eye = [0.0; 2];
    let mut distance = None;
    for _ in 0..STEPS {
        let mut farthest = [[f64::NEG_INFINITY; 2]; 2];
        for p in points {
            let (at, towards) = ([p.dot(right), p.dot(up)], p.dot(away));
            for (k, [plus, minus]) in farthest.iter_mut().enumerate() {
                let depth = slopes[k] * towards;
                (*plus, *minus) = (plus.max(depth + at[k]), minus.max(depth - at[k]));
            }
        }
        let distances = [0, 1].map(|k| 0.5 * (farthest[k][0] + farthest[k][1]) / slopes[k]);
        let distance = *distance.get_or_insert(distances[0].max(distances[1]));
        eye = farthest.map(|[plus, minus]| 0.5 * (plus - minus));
        slopes.iter_mut().zip(distances).for_each(|(slope, own)| *slope *= own / distance);
    }
    [eye[0], eye[1], distance.unwrap_or_default()]
}

/// Rounded to so many decimals, fewer than none included.
fn round(x: f64, decimals: f64) -> f64 {
    let unit = 10f64.powf(decimals.abs());
    if decimals >= 0.0 { (x * unit).round() / unit } else { (x / unit).round() * unit }
}
