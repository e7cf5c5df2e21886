//! How far the models' reflectance is off, so that users hear of it before they look at a picture.

use crate::{Coefficients, Medium, Model};

/// A model is called good where its reflectance is within this of the exact one.
pub const GOOD: f64 = 0.10;

/// Relative error of the reflectance of a half-space under normal incidence, for index 1.3 and 1.5.
struct Row {
    albedo: f64,
    directional: [f64; 2],
    better: [f64; 2],
    standard: [f64; 2],
}

/// From the random walks of `docs/reports/accuracy.md`, which `make accuracy` makes anew.
const ROWS: &[Row] = &[
    Row { albedo: 0.02, directional: [91.67, 101.50], better: [-1.00, -1.00], standard: [0.13, 0.60] },
    Row { albedo: 0.1, directional: [17.46, 18.68], better: [-0.90, -0.89], standard: [0.11, 0.50] },
    Row { albedo: 0.3, directional: [5.12, 5.44], better: [-0.72, -0.70], standard: [0.12, 0.50] },
    Row { albedo: 0.5, directional: [2.54, 2.68], better: [-0.54, -0.53], standard: [0.10, 0.46] },
    Row { albedo: 0.7, directional: [1.36, 1.38], better: [-0.37, -0.37], standard: [0.06, 0.34] },
    Row { albedo: 0.8, directional: [0.97, 0.94], better: [-0.27, -0.29], standard: [0.02, 0.24] },
    Row { albedo: 0.9, directional: [0.63, 0.57], better: [-0.17, -0.18], standard: [-0.04, 0.09] },
    Row { albedo: 0.95, directional: [0.48, 0.40], better: [-0.09, -0.12], standard: [-0.06, -0.01] },
    Row { albedo: 0.98, directional: [0.37, 0.30], better: [-0.04, -0.06], standard: [-0.08, -0.08] },
    Row { albedo: 0.99, directional: [0.33, 0.26], better: [-0.02, -0.03], standard: [-0.08, -0.10] },
    Row { albedo: 0.999, directional: [0.27, 0.22], better: [-0.00, -0.00], standard: [-0.07, -0.10] },
];

impl Model {
    /// Relative error of this model's reflectance for one channel: of a half-space under normal incidence, by reduced
    /// albedo and index, interpolated from a table of random walks; beyond its ends the end.
    pub fn reflectance_error(self, channel: &Coefficients, eta: f64) -> f64 {
        let along = ((eta - 1.3) / 0.2).clamp(0.0, 1.0);
        let at = |row: &Row| {
            let [low, high] = match self {
                Model::DirectionalDipole => row.directional,
                Model::BetterDipole => row.better,
                Model::StandardDipole => row.standard,
            };
            low + along * (high - low)
        };
        let albedo = channel.reduced_albedo();
        let next = ROWS.partition_point(|row| row.albedo < albedo);
        match (next.checked_sub(1).and_then(|k| ROWS.get(k)), ROWS.get(next)) {
            (Some(low), Some(high)) => {
                let share = (albedo - low.albedo) / (high.albedo - low.albedo);
                at(low) + share * (at(high) - at(low))
            }
            (one, other) => one.or(other).map_or(0.0, at),
        }
    }

    /// The errors of the three channels if any that scatters is off by more than [`GOOD`].
    pub fn poor_reflectance(self, medium: &Medium) -> Option<[f64; 3]> {
        let errors = medium.map(|c| self.reflectance_error(c, medium.eta));
        let poor = |(c, e): (&Coefficients, &f64)| c.scatters() && e.abs() > GOOD;
        medium.channels.iter().zip(&errors).any(poor).then_some(errors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built_in;

    #[test]
    fn known_strengths_and_weaknesses() {
        let spectralon = built_in("spectralon").expect("a medium");
        assert!(Model::BetterDipole.poor_reflectance(&spectralon).is_none());
        assert!(Model::DirectionalDipole.poor_reflectance(&spectralon).is_some_and(|e| e[0] > 0.2));
        let ketchup = built_in("ketchup").expect("a medium");
        assert!(Model::BetterDipole.poor_reflectance(&ketchup).is_some_and(|e| e[1] < -0.5));
    }

    #[test]
    fn the_table_is_met_at_its_rows_and_between() {
        let channel = |albedo: f64| Coefficients { sigma_a: 1.0 - albedo, sigma_s: albedo, asymmetry: 0.0 };
        let error = |albedo| Model::DirectionalDipole.reflectance_error(&channel(albedo), 1.3);
        assert!((error(0.9) - 0.63).abs() < 1e-9);
        assert!(error(0.85) > 0.63 && error(0.85) < error(0.8));
        assert_eq!(error(1.0), error(0.999));
    }
}
