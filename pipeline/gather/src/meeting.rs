//! A surface point where a path meets a BSDF, and the direction in which it goes on.

use crate::{
    counts::Counts,
    path_state::{Layer, PathState},
};
use bsdf::{Bsdf, Lobe, Sample, Side, Surface, View};
use scene::{DVec3, SurfacePoint};

/// A surface point where a path meets a BSDF.
pub(crate) struct Meeting<'a> {
    /// Its normals are on the side that the path comes from.
    pub point: &'a SurfacePoint,
    pub bsdf: Surface<'a>,
    pub view: View,
}

impl Meeting<'_> {
    /// The view uses the interpolated normal, unless that normal faces away from `direction` and the triangle's own
    /// does not.
    pub fn new<'a>(
        point: &'a SurfacePoint,
        bsdf: Surface<'a>,
        side: Side,
        direction: DVec3,
        counts: &mut Counts,
    ) -> Meeting<'a> {
        let interpolated = point.normal.dot(direction) > 0.0;
        counts.geometric_normals += u64::from(!interpolated);
        let normal = if interpolated { point.normal } else { point.geometric_normal };
        Meeting { point, bsdf, view: View { normal, direction, side } }
    }

    pub fn transmittance(&self) -> f64 {
        self.bsdf.transmittance(&self.view)
    }

    /// A direction of one lobe, by the numbers of `xi` if it has several. It is sampled about the geometric normal if the
    /// interpolated one puts it on the wrong side of the triangle.
    pub fn sample(&self, lobe: Lobe, mut xi: impl FnMut() -> [f64; 2], counts: &mut Counts) -> Option<Sample> {
        let geometric = self.point.geometric_normal;
        let mut sample = |view: &View| self.bsdf.sample(view, lobe, &mut xi);
        let mut sampled = sample(&self.view);
        let on_wrong_side = |direction: DVec3| match lobe {
            Lobe::Reflection => direction.dot(geometric) <= 0.0,
            Lobe::Transmission => direction.dot(geometric) >= 0.0,
        };
        let fails = sampled.is_none_or(|sample| on_wrong_side(sample.direction));
        // A rough surface has directions that lead nowhere, whose light is not missing.
        if fails && !self.bsdf.is_specular() {
            return None;
        }
        if fails {
            counts.geometric_normals += 1;
            sampled = sample(&View { normal: geometric, ..self.view });
        }
        sampled
    }

    /// Sends the path on in a direction of one lobe, and assigns its light to the layer `event`. False if there is none.
    pub fn scatter(&self, state: &mut PathState, lobe: Lobe, event: Layer, counts: &mut Counts) -> bool {
        let mut first =
            if self.bsdf.is_specular() { None } else { state.mirrored.take().map(|numbers| numbers.mirrored()) };
        let xi = || first.take().unwrap_or_else(|| [state.uniform(), state.uniform()]);
        let Some(sample) = self.sample(lobe, xi, counts) else {
            return false;
        };
        state.throughput *= sample.weight;
        state.leave(self.point, sample.direction, event);
        true
    }
}
