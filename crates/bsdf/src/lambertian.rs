//! The ideal diffuse surface: the same radiance in all directions.

use crate::{Bsdf, Lobe, Sample, View};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A Lambertian surface. It transmits nothing.
#[derive(Clone, Copy, Debug)]
pub struct Lambertian {
    /// Share of the light that is reflected, for each color channel.
    pub albedo: DVec3,
}

impl Bsdf for Lambertian {
    fn transmittance(&self, _view: &View) -> f64 {
        0.0
    }

    fn is_specular(&self) -> bool {
        false
    }

    /// `ρ/π` for light from the viewer's side, 0 for light from behind.
    fn evaluate(&self, view: &View, towards_light: DVec3) -> DVec3 {
        if view.normal.dot(towards_light) > 0.0 { self.albedo / PI } else { DVec3::ZERO }
    }

    /// `cos θ/π`.
    fn density(&self, view: &View, towards_light: DVec3) -> f64 {
        view.normal.dot(towards_light).max(0.0) / PI
    }

    /// A cosine-distributed direction, whose weight is the albedo.
    fn sample(&self, view: &View, lobe: Lobe, mut xi: impl FnMut() -> [f64; 2]) -> Option<Sample> {
        if lobe == Lobe::Transmission {
            return None;
        }
        let (tangent, bitangent) = view.normal.any_orthonormal_pair();
        let [xi_cosine, xi_azimuth] = xi();
        let (radius, height) = (xi_cosine.sqrt(), (1.0 - xi_cosine).sqrt());
        let (sine, cosine) = (TAU * xi_azimuth).sin_cos();
        let direction = tangent * (radius * cosine) + bitangent * (radius * sine) + view.normal * height;
        Some(Sample { direction: direction.normalize(), weight: self.albedo })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;

    /// Every sample fulfills `f cos θ = weight · density`, and the mean cosine is 2/3.
    ///
    /// Seen to catch: directions that are uniform over the hemisphere, a value without 1/π.
    #[test]
    fn samples_have_their_weight_and_their_density() {
        let surface = Lambertian { albedo: DVec3::new(0.2, 0.5, 0.8) };
        let view = View { normal: DVec3::new(0.6, 0.0, -0.8), direction: DVec3::NEG_Z, side: Side::Outside };
        let n = 100;
        let grid = |k: usize| (k as f64 + 0.5) / n as f64;
        let mut cosines = 0.0;
        for k in 0..n * n {
            let sample = surface.sample(&view, Lobe::Reflection, || [grid(k / n), grid(k % n)]).expect("reflected");
            let cosine = view.normal.dot(sample.direction);
            let value = surface.evaluate(&view, sample.direction) * cosine;
            assert!(value.abs_diff_eq(sample.weight * surface.density(&view, sample.direction), 1e-14));
            cosines += cosine;
        }
        assert!((cosines / (n * n) as f64 - 2.0 / 3.0).abs() < 1e-4);
    }
}
