//! What happens to one particle of light at a rough boundary: it is mirrored or refracted whole, without a weight.
//!
//! A path that meets the boundary a hundred times would gather a hundred weights, which are 1 on the mean alone.

use super::RoughDielectric;
use crate::{Bsdf, Lobe, Side, View, frame::Frame, fresnel};
use glam::DVec3;
use std::f64::consts::TAU;

/// Tries to draw a direction of what several microfacets scatter. The distribution is at least a hundredth of its
/// largest value on the mean wherever that matters.
const TRIES: usize = 10_000;

impl RoughDielectric<'_> {
    /// The lobe and the direction, away from the surface, that a particle from `view` goes on in. The direction has the
    /// density `f |cos θ|` of [`Bsdf::evaluate`] (docs/method.md 18.6). Each call of `xi` gives a uniform number.
    pub fn scatter(&self, view: &View, mut xi: impl FnMut() -> f64) -> (Lobe, DVec3) {
        let frame = Frame::new(view.normal);
        let local = frame.local(view.direction);
        let facet = self.ggx.sample_visible(local, [xi(), xi()]);
        // A particle that the facets' neighbors are in the way of meets several.
        let (lobe, direction, kept) = match fresnel::enter(facet, local, self.ratio(view.side)) {
            Some(entry) if xi() < entry.transmittance => {
                let below = -entry.direction.z;
                let kept = if below > 0.0 { self.ggx.masking(below) } else { 0.0 };
                (Lobe::Transmission, entry.direction, kept)
            }
            _ => {
                let mirrored = fresnel::reflect(facet, local);
                let seen = 1.0 + self.ggx.lambda(local.z);
                let kept = if mirrored.z > 0.0 { seen / (seen + self.ggx.lambda(mirrored.z)) } else { 0.0 };
                (Lobe::Reflection, mirrored, kept)
            }
        };
        if xi() < kept {
            return (lobe, frame.world(direction).normalize());
        }
        let returns = xi() < self.between(view.side, |one| one.returned);
        let lobe = if returns { Lobe::Reflection } else { Lobe::Transmission };
        let up = self.of_several(view.side, lobe, &mut xi);
        let direction = if returns { up } else { up.with_z(-up.z) };
        (lobe, frame.world(direction).normalize())
    }

    /// The direction of a particle that crosses the boundary from `view`: [`RoughDielectric::scatter`] until it does, so
    /// that the density is that of the lobe. None if that is hopeless.
    pub fn cross(&self, view: &View, mut xi: impl FnMut() -> f64) -> Option<DVec3> {
        let crossed = |_| match self.scatter(view, &mut xi) {
            (Lobe::Transmission, direction) => Some(direction),
            (Lobe::Reflection, _) => None,
        };
        (0..TRIES).find_map(crossed)
    }

    /// A direction in proportion to the share that meets several microfacets, times its cosine, on the side of `lobe`.
    fn of_several(&self, side: Side, lobe: Lobe, mut xi: impl FnMut() -> f64) -> DVec3 {
        let side = match (lobe, side) {
            (Lobe::Reflection, side) => side,
            (Lobe::Transmission, Side::Outside) => Side::Inside,
            (Lobe::Transmission, Side::Inside) => Side::Outside,
        };
        let most = self.between(side, |one| one.lost.largest());
        let mut cosine = 0.0;
        for _ in 0..TRIES {
            cosine = xi().sqrt();
            if xi() * most < self.between(side, |one| one.lost.at(cosine)) {
                break;
            }
        }
        let (sine, (y, x)) = ((1.0 - cosine * cosine).max(0.0).sqrt(), (TAU * xi()).sin_cos());
        DVec3::new(sine * x, sine * y, cosine)
    }

    /// The density of [`RoughDielectric::scatter`] over both lobes, 1/sr.
    pub fn scatter_density(&self, view: &View, towards_light: DVec3) -> f64 {
        self.evaluate(view, towards_light).x * view.normal.dot(towards_light).abs()
    }
}
