//! Cameras for scenes that have none: each frames the translucent surfaces.

use crate::{
    light::{Light, contract::channel_sum},
    mesh::SurfacePoint,
    scene::Scene,
    view::{Camera, View},
};
use glam::{DMat3, DVec3};

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
}

/// Vertical field of view, degrees.
const YFOV_DEGREES: f64 = 40.0;

/// The surfaces fill this share of the image's height, or less if they would fill more than the other of its width.
const FILLED: [f64; 2] = [0.9, 0.8];

/// Angle above the horizon, and that of the front from +Z towards +X, degrees.
const ELEVATION_DEGREES: f64 = 15.0;
const FRONT_DEGREES: f64 = 30.0;

/// Steps of a turn in all of which the surfaces must be framed.
const TURNS: u32 = 36;

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

    /// The view of a made camera for an image of this aspect; none if there are no surfaces. If it `turns`, it shows them
    /// wherever it is turned to about the vertical axis through its target.
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
        let up = away.cross(right);
        let tangent = (0.5 * YFOV_DEGREES).to_radians().tan();
        let [across, upwards] = [FILLED[0] * tangent * aspect, FILLED[1] * tangent];
        let mut farthest = [[f64::NEG_INFINITY; 2]; 2];
        for turn in (0..if turns { TURNS } else { 1 }).map(|k| f64::from(k) / f64::from(TURNS)) {
            let turn = DMat3::from_rotation_y(turn * std::f64::consts::TAU);
            for p in self.corners.iter().map(|p| turn * *p) {
                let (at, towards) = ([p.dot(right), p.dot(up)], p.dot(away));
                for (k, slope) in [across, upwards].into_iter().enumerate() {
                    let [plus, minus] = &mut farthest[k];
                    (*plus, *minus) = (plus.max(at[k] + slope * towards), minus.max(slope * towards - at[k]));
                }
            }
        }
        // The eye is in the middle of what it sees: no point is beyond the slopes, and the nearest of both distances at
        // which that is so is the one.
        let distance = |k: usize, slope: f64| 0.5 * (farthest[k][0] + farthest[k][1]) / slope;
        let distance = distance(0, across).max(distance(1, upwards));
        let aside = |k: usize| 0.5 * (farthest[k][0] - farthest[k][1]);
        let beside = if turns { 0.0 } else { aside(0) };
        let eye = beside * right + aside(1) * up + distance * away;
        // The target is on the vertical axis through the middle, about which an orbit turns.
        let target = eye - away * (distance - aside(1) * elevation.tan());
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
        };
        view.with_camera(placed.name()).ok()
    }

    /// The azimuth from which most of the light is behind the surfaces, from +Z towards +X, rad.
    fn opposite_of_light(&self) -> f64 {
        let light = self.light();
        if light.length() == 0.0 || light.x.hypot(light.z) < UPRIGHT * light.length() {
            return FRONT_DEGREES.to_radians() + std::f64::consts::PI;
        }
        (-light.x).atan2(-light.z)
    }

    /// The sum of the directions towards light, each times its irradiance, in the middle of the surfaces if nothing is in
    /// the way.
    fn light(&self) -> DVec3 {
        let normals = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let points = normals.map(|normal| SurfacePoint {
            position: self.middle,
            normal,
            geometric_normal: normal,
            triangle: 0,
            material: 0,
        });
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

/// Rounded to so many decimals, fewer than none included.
fn round(x: f64, decimals: f64) -> f64 {
    let unit = 10f64.powf(decimals.abs());
    if decimals >= 0.0 { (x * unit).round() / unit } else { (x / unit).round() * unit }
}
