//! The reflectance of a half-space by a model, by quadrature.

use super::Model;
use crate::{evaluate::Separation, half_space::exit_moment, medium::Medium};
use glam::DVec3;
use std::f64::consts::PI;

/// Rings of equal ratio between these distances, in reduced mean free paths.
const RINGS: i32 = 160;
const DISTANCES: [f64; 2] = [1e-3, 1e4];

impl Model {
    /// The share of light that leaves a half-space again, of that which enters it along the normal: of each channel, at
    /// most 1.
    pub fn reflectance(self, medium: &Medium) -> [f64; 3] {
        let model = self.of(medium);
        let leaving = exit_moment(0, medium.eta);
        let step = (DISTANCES[1] / DISTANCES[0]).powf(1.0 / f64::from(RINGS));
        let [mut reflectance, channels] = [[0.0; 3], medium.map(|c| c.reduced_extinction())];
        for (c, extinction) in channels.into_iter().enumerate().filter(|(_, extinction)| *extinction > 0.0) {
            let ring = |k: i32| {
                let r = DISTANCES[0] * step.powf(f64::from(k) + 0.5) / extinction;
                let (normal_in, normal_out, refracted) = (DVec3::Z, DVec3::Z, DVec3::NEG_Z);
                let bare = model.bare(c, &Separation { offset: DVec3::X * r, normal_in, refracted, normal_out });
                2.0 * PI * r * r * step.ln() * bare
            };
            reflectance[c] = (leaving * (0..RINGS).map(ring).sum::<f64>()).clamp(0.0, 1.0);
        }
        reflectance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built_in;

    /// The standard dipole's closed form (docs/method.md 3.5), which leaves in proportion to `1/π` and not to `T21`.
    #[test]
    fn the_standard_dipole_has_its_closed_form() {
        for name in ["skin1", "ketchup", "marble", "skimmilk"] {
            let medium = built_in(name).expect("it is built in");
            let own = Model::StandardDipole.reflectance(&medium);
            for (c, channel) in medium.channels.iter().enumerate() {
                let eta = medium.eta;
                let f_dr = -1.4399 / (eta * eta) + 0.7099 / eta + 0.6681 + 0.0636 * eta;
                let a = (1.0 + f_dr) / (1.0 - f_dr);
                let q = (3.0 * (1.0 - channel.reduced_albedo())).sqrt();
                let total = 0.5 * channel.reduced_albedo() * (1.0 + (-4.0 / 3.0 * a * q).exp()) * (-q).exp();
                let expected = total * exit_moment(0, eta) / PI;
                assert!((own[c] / expected - 1.0).abs() < 0.01, "{name}: {} {expected}", own[c]);
            }
        }
    }
}
