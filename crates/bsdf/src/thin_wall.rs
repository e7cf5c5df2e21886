//! A thin wall: a sheet that reflects and lets through light equally in all directions, such as paper or a leaf.

use crate::{Bsdf, Lambertian, Lobe, Sample, View};
use glam::DVec3;

/// A Lambertian surface on both sides. Light that comes from one side leaves in part on that side, and in part on the
/// other (docs/method.md 13.8).
#[derive(Clone, Copy, Debug)]
pub struct ThinWall {
    /// Share of the light that leaves on the side where it came from, for each color channel.
    pub back: DVec3,
    /// Share that leaves on the other side.
    pub through: DVec3,
}

impl ThinWall {
    /// The albedo of the side that light from a direction meets, as seen from the viewer's side.
    fn albedo(&self, lobe: Lobe) -> DVec3 {
        match lobe {
            Lobe::Reflection => self.back,
            Lobe::Transmission => self.through,
        }
    }

    /// The lobe that light from a direction belongs to, and the view whose normal is on its side.
    fn side(view: &View, towards_light: DVec3) -> (Lobe, View) {
        if view.normal.dot(towards_light) > 0.0 {
            (Lobe::Reflection, *view)
        } else {
            (Lobe::Transmission, View { normal: -view.normal, ..*view })
        }
    }
}

impl Bsdf for ThinWall {
    /// The share of what is let through, by the mean of the channels; 0 if the wall is black.
    fn transmittance(&self, _view: &View) -> f64 {
        let [back, through] = [self.back, self.through].map(DVec3::element_sum);
        if through > 0.0 { through / (back + through) } else { 0.0 }
    }

    fn is_specular(&self) -> bool {
        false
    }

    /// `ρ/π` for light from the viewer's side, `τ/π` for light from behind.
    fn evaluate(&self, view: &View, towards_light: DVec3) -> DVec3 {
        let (lobe, view) = ThinWall::side(view, towards_light);
        Lambertian { albedo: self.albedo(lobe) }.evaluate(&view, towards_light)
    }

    /// `|cos θ|/π`.
    fn density(&self, view: &View, towards_light: DVec3) -> f64 {
        let (lobe, view) = ThinWall::side(view, towards_light);
        Lambertian { albedo: self.albedo(lobe) }.density(&view, towards_light)
    }

    /// A cosine-distributed direction on the lobe's side.
    fn sample(&self, view: &View, lobe: Lobe, xi: impl FnMut() -> [f64; 2]) -> Option<Sample> {
        let transmittance = self.transmittance(view);
        let (share, normal) = match lobe {
            Lobe::Reflection => (1.0 - transmittance, view.normal),
            Lobe::Transmission => (transmittance, -view.normal),
        };
        if share == 0.0 {
            return None;
        }
        let surface = Lambertian { albedo: self.albedo(lobe) / share };
        surface.sample(&View { normal, ..*view }, Lobe::Reflection, xi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;
    use std::f64::consts::PI;

    /// Of each lobe, every sample lies on its side and fulfills `f |cos θ| = share · weight · density`; together the lobes
    /// have the energy of both albedos; and the function is the same with light and viewer exchanged.
    ///
    /// Seen to catch: the two shares exchanged, a share left out of the weight, transmitted light about the viewer's
    /// normal.
    #[test]
    fn samples_have_their_weight_and_their_side() {
        let wall = ThinWall { back: DVec3::new(0.2, 0.1, 0.3), through: DVec3::new(0.5, 0.4, 0.1) };
        let view = View { normal: DVec3::new(0.6, 0.0, -0.8), direction: DVec3::NEG_Z, side: Side::Outside };
        let through = wall.transmittance(&view);
        assert!((through - 1.0 / 1.6).abs() < 1e-15);
        let n = 40;
        let grid = |k: usize| (k as f64 + 0.5) / n as f64;
        for (lobe, share, albedo, side) in
            [(Lobe::Reflection, 1.0 - through, wall.back, 1.0), (Lobe::Transmission, through, wall.through, -1.0)]
        {
            for k in 0..n * n {
                let sample = wall.sample(&view, lobe, || [grid(k / n), grid(k % n)]).expect("the lobe is not empty");
                let cosine = view.normal.dot(sample.direction);
                assert!(cosine * side > 0.0);
                let value = wall.evaluate(&view, sample.direction) * cosine.abs();
                assert!(value.abs_diff_eq(share * sample.weight * wall.density(&view, sample.direction), 1e-14));
                assert!((share * sample.weight).abs_diff_eq(albedo, 1e-15));
                let exchanged = View { normal: view.normal * side, direction: sample.direction, side: Side::Outside };
                assert!(wall.evaluate(&exchanged, view.direction).abs_diff_eq(albedo / PI, 1e-15));
            }
        }
    }

    /// A black wall, and one that lets nothing through.
    ///
    /// Seen to catch: a division of nothing by nothing.
    #[test]
    fn empty_lobes_have_no_samples() {
        let view = View { normal: DVec3::Z, direction: DVec3::Z, side: Side::Outside };
        let opaque = ThinWall { back: DVec3::ONE, through: DVec3::ZERO };
        assert!(opaque.sample(&view, Lobe::Transmission, || [0.5; 2]).is_none());
        let black = ThinWall { back: DVec3::ZERO, through: DVec3::ZERO };
        assert_eq!(black.transmittance(&view), 0.0);
        assert!(black.sample(&view, Lobe::Reflection, || [0.5; 2]).is_some_and(|s| s.weight == DVec3::ZERO));
    }
}
