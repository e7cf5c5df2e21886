//! The error of the models' reflectance, for a warning before users look at a picture.

/// The reflectance of a model is called good within this relative error.
pub const GOOD: f64 = 0.10;

/// Reduced albedos that the errors are tabulated for.
const ALBEDOS: [f64; 11] = [0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999];

/// Relative errors of a model's reflectance of a half-space under normal incidence: a row for each of the indices 1.3
/// and 1.5, whose columns are the reduced albedos 0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99 and 0.999. The
/// reference are random walks, which agree with the exact values of `docs/reports/accuracy.md`.
pub type ReflectanceErrors = [[f64; ALBEDOS.len()]; 2];

/// The error at a reduced albedo and an index; beyond the ends of the table that of the end.
pub fn interpolated(errors: &ReflectanceErrors, albedo: f64, eta: f64) -> f64 {
    let along = ((eta - 1.3) / 0.2).clamp(0.0, 1.0);
    let at = |column: usize| {
        let [low, high] = errors.map(|row| row[column]);
        low + along * (high - low)
    };
    match ALBEDOS.partition_point(|tabulated| *tabulated < albedo) {
        0 => at(0),
        next if next < ALBEDOS.len() => {
            let (low, high) = (ALBEDOS[next - 1], ALBEDOS[next]);
            at(next - 1) + (albedo - low) / (high - low) * (at(next) - at(next - 1))
        }
        _ => at(ALBEDOS.len() - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_met_at_its_columns_and_between() {
        let errors: ReflectanceErrors = [1.0, 2.0].map(|error| ALBEDOS.map(|albedo| error / albedo));
        let error = |albedo| interpolated(&errors, albedo, 1.3);
        assert!((error(0.9) - 1.0 / 0.9).abs() < 1e-9);
        assert!(error(0.85) > error(0.9) && error(0.85) < error(0.8));
        assert_eq!([error(0.0), error(1.0)], [error(0.02), error(0.999)]);
        assert!((interpolated(&errors, 0.9, 1.4) - 1.5 / 0.9).abs() < 1e-9);
    }
}
