//! The exposure of previews: how bright the translucent surfaces look from all around.
//!
//! It follows from the scene, its clouds and the media, and from neither the camera nor the model of scattering: all
//! pictures of a turntable have one exposure, and so has an image beside its reference.

use crate::{
    estimator::Estimator,
    image::{Filter, Input, Settings},
    passes::Passes,
    path_state::{PathIndex, ThreadContext},
    renderer::Renderer,
};
use bssrdf::Model;
use formats::cloud::{Cloud, Meta, shards};
use rayon::prelude::*;
use scene::{DVec3, Framing, NormalKind, Placed};
use std::f64::consts::{PI, TAU};

/// The radiance that the preview shows as the bright part of a translucent surface, before the tone curve.
const BRIGHT: f64 = 0.8;

/// The bright part of a surface is this share from below of its lit part: highlights are above it.
const PERCENTILE: f64 = 0.8;

/// A surface that sends back less than this share of the light that falls on it on average is shown as dark.
const DARK: f64 = 0.2;

/// What is darker than this share of the bright part of all points is not lit.
const UNLIT: f64 = 0.02;

/// Points that are looked at, and rays that are followed to find them at most, in groups.
const POINTS: usize = 2048;
const RAYS: u64 = 1 << 17;
const GROUP: u64 = 1 << 13;

/// Sines of the lowest and the highest direction from which the surfaces are looked at.
const HEIGHTS: [f64; 2] = [0.0, 0.7];

/// The largest relative error of a sum over the cloud.
const ACCURACY: f64 = 0.05;

/// The fractional parts of the multiples of these numbers, powers of one root, are spread evenly in four dimensions.
const STEPS: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126_1, 0.628_706_721_037_808_6, 0.538_597_257_223_61];

/// The brightness of translucent surfaces as they are seen from all around, W/(m² sr): that of their bright part, or of
/// a dark gray in the same light if they are darker. None if no light leaves them, or if there are none. Neither the
/// camera nor a calibration of the input counts.
pub fn brightness(input: &Input) -> Option<f64> {
    let sampled: Vec<u16> = match input.clouds {
        [] => Vec::new(),
        clouds => shards::materials(clouds).iter().map(|m| m.index).collect(),
    };
    let surfaces = Framing::new(input.scene, |material| sampled.contains(&material));
    let (_, camera) = surfaces.view(Placed::Front, 1.0, true)?;
    let passes = Passes::new(&Input { calibration: None, camera: &camera, ..*input }, &settings());
    let renderer = passes.renderer();
    let rays = Around { middle: surfaces.middle() - input.scene.origin, radius: 0.5 * surfaces.size().length() };
    let mut seen = Vec::new();
    for group in (0..RAYS / GROUP).map(|k| k * GROUP..(k + 1) * GROUP) {
        let found = group.into_par_iter().filter_map(|k| look(renderer, rays.ray(k), k));
        seen.extend(found.collect::<Vec<f64>>());
        if seen.len() >= POINTS {
            break;
        }
    }
    let gray = DARK / PI * strength(irradiance(input.clouds));
    bright_part(seen).map(|bright| bright.hypot(gray))
}

/// The mean irradiance of the surfaces, W/m².
fn irradiance(clouds: &[Cloud]) -> DVec3 {
    let sum =
        |of: fn(&Meta) -> DVec3| clouds.iter().map(|c| of(c.meta()) * c.meta().samples_drawn as f64).sum::<DVec3>();
    sum(|meta| DVec3::from_array(meta.mean_flux_w)) / sum(|meta| DVec3::splat(meta.surface_area_m2))
}

/// How bright a color looks: a saturated one by its strongest channel.
fn strength(color: DVec3) -> f64 {
    0.5 * (DVec3::from_array(color::LUMINANCE).dot(color) + color.max_element())
}

/// The bright part of some values; none if all are black.
fn bright_part(mut values: Vec<f64>) -> Option<f64> {
    let at = |values: &[f64]| values.get((PERCENTILE * values.len() as f64) as usize).copied();
    values.retain(|x| x.is_finite() && *x > 0.0);
    values.sort_by(f64::total_cmp);
    let limit = UNLIT * at(&values)?;
    at(&values[values.partition_point(|x| *x < limit)..])
}

/// The factor by which the preview of surfaces of this brightness is brightened, in powers of two.
pub fn stops(brightness: f64) -> f64 {
    (BRIGHT / brightness).log2().clamp(-64.0, 64.0)
}

fn settings() -> Settings {
    Settings {
        width: 64,
        height: 64,
        crop: None,
        paths_per_pixel: 1,
        filter: Filter::Point,
        estimator: Estimator::Cut { accuracy: ACCURACY },
        balances: false,
        model: Model::ALL[0],
        near_field: true,
        reference: false,
        normals: NormalKind::Shading,
        max_depth: 16,
        seed: 0,
        backdrop: None,
    }
}

/// Parallel rays from all around a ball.
struct Around {
    /// m from the scene's origin.
    middle: DVec3,
    radius: f64,
}

impl Around {
    /// Origin and direction of ray `k`: it starts where it enters the box around the ball.
    fn ray(&self, k: u64) -> (DVec3, DVec3) {
        let [turn, height, x, y] = STEPS.map(|step| (0.5 + step * k as f64).fract());
        let height = HEIGHTS[0] + (HEIGHTS[1] - HEIGHTS[0]) * height;
        let (sine, cosine) = (TAU * turn).sin_cos();
        let level = (1.0 - height * height).sqrt();
        let away = DVec3::new(level * sine, height, level * cosine);
        let right = DVec3::Y.cross(away).normalize();
        let aside = (2.0 * x - 1.0) * right + (2.0 * y - 1.0) * away.cross(right);
        (self.middle + self.radius * (away + aside), -away)
    }
}

/// How bright a translucent surface looks along a ray; none if the ray meets none first.
fn look(renderer: &Renderer, (origin, direction): (DVec3, DVec3), index: u64) -> Option<f64> {
    let hit = renderer.input.rays.closest(origin, direction, None)?;
    let mesh = &renderer.input.scene.mesh;
    let material = mesh.triangles[hit.triangle as usize].material;
    renderer.objects[usize::from(material)].as_ref()?;
    let mut context = ThreadContext::new(renderer.input.scene.materials.len());
    let path = PathIndex { pixel: index, path: 0, edge: false, walks: None, near: None, surface: None };
    let light = renderer.trace(path, origin, direction, &mut context);
    Some(strength(light.layers.iter().sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neither a few highlights nor a dark side decide. Seen to fail when the unlit values counted.
    #[test]
    fn the_bright_part_is_that_of_what_is_lit() {
        let values = |dark: usize| {
            let lit = (0..1000).map(|k| 1.0 + 0.001 * f64::from(k));
            lit.chain(vec![1e6; 20]).chain(vec![1e-9; dark]).chain([0.0, f64::NAN]).collect::<Vec<f64>>()
        };
        for dark in [0, 3000] {
            let bright = bright_part(values(dark)).expect("some are lit");
            assert!((bright - 1.8).abs() < 0.05, "{dark}: {bright}");
        }
        assert_eq!((bright_part(Vec::new()), bright_part(vec![0.0; 9])), (None, None));
        assert!((stops(0.4) - 1.0).abs() < 1e-12 && stops(0.2 * BRIGHT) > stops(BRIGHT));
    }

    /// Rays come from all around and above, and cover the ball.
    #[test]
    fn rays_cover_the_ball() {
        let around = Around { middle: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let rays: Vec<(DVec3, DVec3)> = (0..4096).map(|k| around.ray(k)).collect();
        let mean: DVec3 = rays.iter().map(|(_, direction)| *direction).sum::<DVec3>() / 4096.0;
        assert!(mean.x.abs() < 0.01 && mean.z.abs() < 0.01 && (mean.y + 0.35).abs() < 0.01, "{mean}");
        let nearest = |(origin, direction): &(DVec3, DVec3)| {
            let to = around.middle - *origin;
            (to - direction.dot(to) * *direction).length() / around.radius
        };
        let inside = rays.iter().filter(|ray| nearest(ray) < 1.0).count() as f64 / 4096.0;
        assert!((inside - PI / 4.0).abs() < 0.01, "{inside}");
    }
}
