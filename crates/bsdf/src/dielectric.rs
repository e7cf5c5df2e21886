//! The smooth boundary between two dielectrics: one reflected and one refracted direction.

use crate::{Bsdf, Lobe, Sample, View, fresnel};
use glam::DVec3;

/// A smooth dielectric interface. It absorbs nothing.
#[derive(Clone, Copy, Debug)]
pub struct SmoothDielectric {
    /// Index beyond the interface over the index on the viewer's side, from outside and from inside.
    eta_ratios: [f64; 2],
}

impl SmoothDielectric {
    /// The interface of a medium of relative index `eta`, inside over outside.
    pub fn new(eta: f64) -> SmoothDielectric {
        SmoothDielectric { eta_ratios: [eta, 1.0 / eta] }
    }
}

impl Bsdf for SmoothDielectric {
    /// Fresnel's power transmittance (docs/method.md 2.1).
    fn transmittance(&self, view: &View) -> f64 {
        fresnel::transmittance(view.normal.dot(view.direction), self.eta_ratios[view.side as usize])
    }

    fn is_specular(&self) -> bool {
        true
    }

    fn evaluate(&self, _view: &View, _towards_light: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    fn density(&self, _view: &View, _towards_light: DVec3) -> f64 {
        0.0
    }

    /// The mirrored direction, or the refracted one (docs/method.md 2.3); none under total reflection.
    fn sample(&self, view: &View, lobe: Lobe, _xi: impl FnMut() -> [f64; 2]) -> Option<Sample> {
        let direction = match lobe {
            Lobe::Reflection => fresnel::reflect(view.normal, view.direction),
            Lobe::Transmission => {
                fresnel::enter(view.normal, view.direction, self.eta_ratios[view.side as usize])?.direction
            }
        };
        Some(Sample { direction, weight: DVec3::ONE })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;

    /// Seen to catch: the same index from both sides.
    #[test]
    fn a_ray_that_enters_leaves_by_the_same_way() {
        let glass = SmoothDielectric::new(1.5);
        let outside = View { normal: DVec3::Y, direction: DVec3::new(0.6, 0.8, 0.0), side: Side::Outside };
        let entered = glass.sample(&outside, Lobe::Transmission, || [0.5; 2]).expect("light enters");
        let inside = View { normal: DVec3::NEG_Y, direction: entered.direction, side: Side::Inside };
        let left = glass.sample(&inside, Lobe::Transmission, || [0.5; 2]).expect("light leaves");
        assert!(left.direction.abs_diff_eq(outside.direction, 1e-14));
        assert!((glass.transmittance(&inside) - glass.transmittance(&outside)).abs() < 1e-14);
    }

    #[test]
    fn beyond_the_critical_angle_everything_is_reflected() {
        let glass = SmoothDielectric::new(1.5);
        let view = View { normal: DVec3::Y, direction: DVec3::new(0.8, 0.6, 0.0), side: Side::Inside };
        assert_eq!(glass.transmittance(&view), 0.0);
        assert!(glass.sample(&view, Lobe::Transmission, || [0.5; 2]).is_none());
        let reflected = glass.sample(&view, Lobe::Reflection, || [0.5; 2]).expect("light is reflected");
        assert!(reflected.direction.abs_diff_eq(DVec3::new(-0.8, 0.6, 0.0), 1e-15));
    }
}
