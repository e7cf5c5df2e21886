//! Other renderers on the same scenes, as they were measured before on a similar machine: pbrt-v3 with its tabulated
//! photon beam diffusion, Cycles 4.5, POV-Ray 3.7 and Mitsuba 3.9. 128 x 128 pixels, user and system seconds of whole
//! processes, start-up included.

use crate::speed::plot::Curve;

/// What is known of a renderer on one scene.
pub struct Other {
    pub name: &'static str,
    /// relMSE times CPU seconds against its own converged image; none if it has no noise to speak of.
    pub noise: Option<f64>,
    pub floor: Floor,
    /// What of the scattering it leaves out.
    pub ignores: &'static str,
}

/// relMSE of the converged image to the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Floor {
    Measured(f64),
    Unknown,
    /// The image is black.
    Black,
    /// The light had to be another: its noise alone can be compared.
    OtherLight,
}

const BEAMS: &str = "the shape, as all BSSRDFs; boundary and albedo beyond diffusion";
const WALK: &str = "reflection at the boundary inside";
const DIPOLE: &str = "the shape and the direction of the light; its estimate is biased besides";
const PATHS: &str = "this light: a path tracer cannot connect directional light through a smooth boundary";
const ENVIRONMENT: &str = "nothing, but lit by a constant environment instead";

/// Sphere, skim milk.
pub const ON_SPHERE: [Other; 5] = [
    Other { name: "pbrt-v3", noise: Some(0.085), floor: Floor::Measured(0.0168), ignores: BEAMS },
    Other { name: "Cycles, random walk", noise: Some(0.21), floor: Floor::Measured(0.0116), ignores: WALK },
    Other { name: "POV-Ray, dipole", noise: Some(0.0003), floor: Floor::Measured(0.0170), ignores: DIPOLE },
    Other { name: "Mitsuba, volpath", noise: None, floor: Floor::Black, ignores: PATHS },
    Other { name: "Mitsuba, volpathmis", noise: Some(0.18), floor: Floor::OtherLight, ignores: ENVIRONMENT },
];

/// Bunny, marble.
pub const ON_BUNNY: [Other; 6] = [
    Other { name: "pbrt-v3", noise: Some(0.065), floor: Floor::Unknown, ignores: BEAMS },
    Other { name: "Cycles, random walk", noise: Some(0.12), floor: Floor::Unknown, ignores: WALK },
    Other {
        name: "Cycles, Burley",
        noise: Some(0.0085),
        floor: Floor::Unknown,
        ignores: "the shape, the direction of the light, the index of refraction",
    },
    Other { name: "POV-Ray, dipole", noise: Some(0.037), floor: Floor::Unknown, ignores: DIPOLE },
    Other { name: "Mitsuba, volpath", noise: None, floor: Floor::Black, ignores: PATHS },
    Other { name: "Mitsuba, volpathmis", noise: Some(0.27), floor: Floor::OtherLight, ignores: ENVIRONMENT },
];

impl Other {
    /// relMSE to the truth after so many CPU seconds; `black` is that of a black image. Without a known floor it is
    /// that of the noise alone, and the truth is further away.
    pub fn at(&self, seconds: f64, black: f64) -> f64 {
        let floor = match self.floor {
            Floor::Measured(floor) => floor,
            Floor::Black => black,
            Floor::Unknown | Floor::OtherLight => 0.0,
        };
        self.noise.unwrap_or(0.0) / seconds + floor
    }

    /// The curve over a range of seconds.
    pub fn curve(&self, [from, to]: [f64; 2], black: f64) -> Curve {
        let seconds = (0..=24).map(|k| from * (to / from).powf(f64::from(k) / 24.0));
        let noise_only = if self.floor == Floor::Unknown { ": noise" } else { "" };
        Curve {
            label: format!("{}{noise_only}", self.name),
            line: seconds.map(|s| (s, self.at(s, black))).collect(),
            ..Curve::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_falls_to_the_floor() {
        let [pbrt, _, _, mitsuba, _] = ON_SPHERE;
        assert!((pbrt.at(1.0, 0.9) - 0.1018).abs() < 1e-12);
        assert!((pbrt.at(1e9, 0.9) - 0.0168).abs() < 1e-6);
        assert_eq!(mitsuba.at(1.0, 0.9), 0.9);
        assert!(ON_BUNNY[2].curve([1.0, 10.0], 0.9).label.ends_with(": noise"));
    }
}
