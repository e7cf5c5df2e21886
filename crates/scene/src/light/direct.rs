//! Light that arrives at a surface point straight from the lights, by one routine for both phases.

use super::{
    bounds::ReceiverBounds,
    choice::{LightChoice, Pick},
    contract::{Illumination, Light},
    tree::{LightTree, MAX_FLAT},
};
use crate::{mesh::SurfacePoint, rays::Rays};
use glam::DVec3;
use std::ops::{Add, Div};

/// The outcome of one attempt to light a point.
#[derive(Clone, Copy, Debug)]
pub enum Lit {
    /// Direction towards the light, and its irradiance over the share of the choice, W/m².
    Light { direction: DVec3, irradiance: DVec3 },
    /// Every light is behind the surface, or the point lies outside its cone or range.
    FacingAway,
    /// The chosen light is hidden.
    Shadowed,
    /// No lit opaque surface lies in the direction that was chosen.
    NoBounce,
}

/// Picks one light by importance, then a direction, and tests whether it is visible (docs/method.md 6.4). Light must
/// come from above the triangle, whatever normal the cosine is taken with. `shadow_rays` counts the rays traced.
pub fn light_at(choice: &LightChoice, rays: &Rays, at: &SurfacePoint, xi: [f64; 3], shadow_rays: &mut u64) -> Lit {
    let Some(Pick { light, share, .. }) = choice.pick(at, xi[0]) else {
        return Lit::FacingAway;
    };
    let Some(arriving) = arriving(light, at, [xi[1], xi[2]]) else {
        return Lit::FacingAway;
    };
    *shadow_rays += 1;
    if !rays.visible(at.position, arriving.direction, arriving.distance, Some(at.triangle)) {
        return Lit::Shadowed;
    }
    Lit::Light { direction: arriving.direction, irradiance: arriving.irradiance / share }
}

/// Number of nodes in the list from which the lights of a single point are picked.
const NODES_PER_POINT: usize = 128;

/// The light of two layers that a surface reflects towards a viewer, W/(m² sr).
#[derive(Clone, Copy, Debug, Default)]
pub struct Reflected {
    pub mirrored: DVec3,
    pub diffuse: DVec3,
}

impl Add for Reflected {
    type Output = Reflected;

    fn add(self, other: Reflected) -> Reflected {
        Reflected { mirrored: self.mirrored + other.mirrored, diffuse: self.diffuse + other.diffuse }
    }
}

impl Div<f64> for Reflected {
    type Output = Reflected;

    fn div(self, x: f64) -> Reflected {
        Reflected { mirrored: self.mirrored / x, diffuse: self.diffuse / x }
    }
}

/// Irradiance for surfaces that are lit once a path, as of [`all_lights_at`] with one direction each.
pub fn all_light_at(
    lights: &LightTree,
    rays: &Rays,
    at: &SurfacePoint,
    xi: impl FnMut() -> [f64; 2],
    shadow_rays: &mut u64,
) -> DVec3 {
    all_lights_at(lights, rays, at, (1, xi), shadow_rays, |light| light.irradiance)
}

/// The sum over all lights of what `reflect` makes of each that is not hidden. Up to `MAX_FLAT` lights are all sampled, in
/// the mean of `tries` directions each, since the choice of one would be noise; of more, as many are picked, one direction
/// each. Each call of `xi` gives two uniform numbers; those of one light follow each other.
pub fn all_lights_at<T: Default + Add<Output = T> + Div<f64, Output = T>>(
    lights: &LightTree,
    rays: &Rays,
    at: &SurfacePoint,
    (tries, mut xi): (usize, impl FnMut() -> [f64; 2]),
    shadow_rays: &mut u64,
    reflect: impl Fn(&Illumination) -> T,
) -> T {
    let mut visible = |light: &dyn Light, xi: [f64; 2]| {
        let Some(arriving) = arriving(light, at, xi) else { return T::default() };
        *shadow_rays += 1;
        let clear = rays.visible(at.position, arriving.direction, arriving.distance, Some(at.triangle));
        if clear { reflect(&arriving) } else { T::default() }
    };
    if lights.lights.len() <= MAX_FLAT {
        let mut mean = |light: &dyn Light| {
            let numbers = (0..tries).map(|_| xi());
            // A light of one direction is the same at each try. It takes as many numbers, so that those of the next light
            // stay together.
            if light.delta().is_some() {
                return numbers.last().map_or_else(T::default, |xi| visible(light, xi));
            }
            numbers.fold(T::default(), |sum, xi| sum + visible(light, xi)) / tries as f64
        };
        return lights.lights.iter().fold(T::default(), |sum, light| sum + mean(*light));
    }
    let choice = LightChoice::new(lights, &ReceiverBounds::point(at), NODES_PER_POINT);
    let [shift, _] = xi();
    let one = |k: usize| {
        let picked = choice.pick(at, (k as f64 + shift) / MAX_FLAT as f64);
        picked.map_or_else(T::default, |p| visible(p.light, xi()) / p.share)
    };
    (0..MAX_FLAT).map(one).fold(T::default(), |sum, x| sum + x) / MAX_FLAT as f64
}

/// Light from above the triangle.
fn arriving(light: &dyn Light, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
    let arriving = light.illuminate(at, xi)?;
    (arriving.direction.dot(at.geometric_normal) > 0.0 && arriving.irradiance != DVec3::ZERO).then_some(arriving)
}
