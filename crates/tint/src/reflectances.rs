//! How much light media reflect that a file states by colors.

use bssrdf::{Coefficients, Medium, Model, single_scattering_albedo};
use glam::DVec3;
use scene::Scatter;
use std::sync::Arc;

/// Colors from one tabulated one to the next, from 0 to 1. Between them linear interpolation is within 1e-4 of the
/// reflectance.
const STEPS: usize = 95;

/// The reflectances of half-spaces of the colors from 0 to 1, and what a texture of such colors changes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reflectances {
    table: Arc<[f64]>,
    /// Color of the medium, and the mean of its texture.
    color: DVec3,
    mean: DVec3,
}

impl Reflectances {
    /// Those by a model of media that scatter as one of the file does; the medium is of the mean of a texture.
    pub fn new(scatter: &Scatter, mean: DVec3, eta: f64, model: Model) -> Reflectances {
        let channel = |k: usize| {
            let albedo = single_scattering_albedo(k as f64 / STEPS as f64, scatter.asymmetry_of_color());
            Coefficients { sigma_a: 1.0 - albedo, sigma_s: albedo, asymmetry: scatter.asymmetry }
        };
        // Three at a time, as if they were those of red, green and blue.
        let three = |k: usize| {
            let channels = [k, k + 1, k + 2].map(channel);
            let (name, interface) = (String::new(), bssrdf::Interface::new(eta));
            model.reflectance(&Medium { source: name.clone(), name, channels, eta, interface })
        };
        let table = (0..=STEPS).step_by(3).flat_map(three).collect();
        Reflectances { table, color: scatter.color, mean }
    }

    /// The reflectance where the texture has this color, relative to that of the medium.
    pub fn relative(&self, texel: DVec3) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|c| {
            let own = self.at(self.color[c]);
            if own > 0.0 && self.mean[c] > 0.0 { self.at(self.color[c] * (texel[c] / self.mean[c])) / own } else { 1.0 }
        }))
    }

    fn at(&self, color: f64) -> f64 {
        let place = color.clamp(0.0, 1.0) * STEPS as f64;
        let first = (place as usize).min(STEPS - 1);
        let [low, high] = [self.table[first], self.table[first + 1]];
        low + (high - low) * (place - first as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bssrdf::{MediumFile, Optics, Unit};
    use scene::ScatterExtension;

    /// What the model's half-spaces of these colors reflect.
    fn reflected(scatter: &Scatter, colors: DVec3, model: Model) -> DVec3 {
        let g = if scatter.draft == ScatterExtension::Scatter { scatter.asymmetry } else { 0.0 };
        let albedo = colors.to_array().map(|color| single_scattering_albedo(color, g));
        let file = MediumFile {
            name: "own".into(),
            unit: Unit::Metre,
            optics: Optics::Coefficients {
                sigma_a: albedo.map(|a| 700.0 * (1.0 - a)),
                sigma_s: albedo.map(|a| 700.0 * a),
            },
            g: [scatter.asymmetry; 3],
            eta: 1.5,
            source: String::new(),
        };
        DVec3::from_array(model.reflectance(&Medium::new(file).expect("a medium")))
    }

    /// Seen to catch: the ratio of the colors, which is off by half; an albedo that knows no mean cosine.
    #[test]
    fn colors_reflect_as_their_media() {
        let (mean, factor) = (DVec3::new(0.5, 0.25, 0.75), DVec3::new(1.0, 0.9, 0.6));
        for draft in [ScatterExtension::Scatter, ScatterExtension::VolumeScatter] {
            for model in [Model::HalfSpace, Model::DirectionalDipole] {
                let scatter = Scatter { draft, color: factor * mean, asymmetry: 0.5 };
                let tabulated = Reflectances::new(&scatter, mean, 1.5, model);
                assert!(tabulated.relative(mean).abs_diff_eq(DVec3::ONE, 1e-12));
                for texel in [DVec3::ONE, DVec3::splat(0.37), DVec3::new(0.1, 0.5, 0.9)] {
                    let own = tabulated.relative(texel) * reflected(&scatter, factor * mean, model);
                    let expected = reflected(&scatter, factor * texel, model);
                    assert!(own.abs_diff_eq(expected, 5e-4), "{model:?} {texel}: {own}, not {expected}");
                }
            }
        }
    }

    /// Where a texture has nothing of a channel, nor has its medium, nothing is divided by nothing.
    ///
    /// Seen to catch: a mean of 0 that is divided by.
    #[test]
    fn a_channel_without_light_has_a_factor() {
        let scatter = Scatter { draft: ScatterExtension::Scatter, color: DVec3::new(0.5, 0.0, 0.0), asymmetry: 0.0 };
        let tabulated = Reflectances::new(&scatter, DVec3::new(0.5, 0.0, 1.0), 1.5, Model::HalfSpace);
        assert!(tabulated.relative(DVec3::new(0.5, 0.0, 1.0)).abs_diff_eq(DVec3::ONE, 1e-12));
    }
}
