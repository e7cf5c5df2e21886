//! The frame of a surface, whose `z` is its normal.

use glam::DVec3;
use std::f64::consts::TAU;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame([DVec3; 3]);

impl Frame {
    pub fn new(normal: DVec3) -> Frame {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Frame([tangent, bitangent, normal])
    }

    pub fn local(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.0.map(|axis| axis.dot(v)))
    }

    pub fn world(&self, v: DVec3) -> DVec3 {
        self.0[0] * v.x + self.0[1] * v.y + self.0[2] * v.z
    }
}

/// A uniform direction above the surface: what several microfacets reflect of light that is seen at a slant is at a slant
/// itself, so that its light times its cosine is nearly even.
pub(crate) fn uniform_direction([a, b]: [f64; 2]) -> DVec3 {
    let radius = ((1.0 - a) * (1.0 + a)).sqrt();
    let (sine, cosine) = (TAU * b).sin_cos();
    DVec3::new(radius * cosine, radius * sine, a)
}

/// The density of [`uniform_direction`], 1/sr.
pub(crate) const UNIFORM_DENSITY: f64 = 1.0 / TAU;
