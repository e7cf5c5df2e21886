//! Fresnel's equations of a smooth dielectric interface, and the moments of its reflectance over the hemisphere.
//!
//! Where a form differs from the usual print, its comment says why.

use glam::DVec3;

/// Power transmittance `T(c, η_r)` of an interface for light whose cosine in the incident medium is `cosine`;
/// `eta_ratio` is the index of the transmitting medium over that of the incident one (docs/method.md 2.1).
///
/// It is 0 for total reflection and for light from behind. One minus the mean of squared amplitude ratios, the usual
/// form, would cancel near grazing.
pub fn transmittance(cosine: f64, eta_ratio: f64) -> f64 {
    if cosine <= 0.0 {
        return 0.0;
    }
    if eta_ratio == 1.0 {
        return 1.0;
    }
    let c = cosine.min(1.0);
    let Some(t) = refracted_cosine(c, eta_ratio) else {
        return 0.0;
    };
    let q = 4.0 * eta_ratio * c * t;
    let perpendicular = c + eta_ratio * t;
    let parallel = eta_ratio * c + t;
    0.5 * (q / (perpendicular * perpendicular) + q / (parallel * parallel))
}

/// Cosine `t = √(1 − s²)` on the transmitted side; none beyond the critical angle.
fn refracted_cosine(cosine: f64, eta_ratio: f64) -> Option<f64> {
    let sine_squared = (1.0 - cosine) * (1.0 + cosine) / (eta_ratio * eta_ratio);
    (sine_squared < 1.0).then(|| (1.0 - sine_squared).sqrt())
}

/// Light that crosses an interface.
#[derive(Clone, Copy, Debug)]
pub struct Refraction {
    /// Unit direction of the refracted light, pointing away from the surface.
    pub direction: DVec3,
    /// Power transmittance.
    pub transmittance: f64,
}

/// Refracts light that arrives from `direction` (unit, pointing away from the surface, back along the light) through
/// a surface with unit `normal` on its side; `eta_ratio` is transmitted over incident index (docs/method.md 2.2, 2.3).
/// None if the light comes from behind or is totally reflected.
pub fn enter(normal: DVec3, direction: DVec3, eta_ratio: f64) -> Option<Refraction> {
    let cosine = normal.dot(direction).min(1.0);
    let transmittance = transmittance(cosine, eta_ratio);
    if transmittance <= 0.0 {
        return None;
    }
    if eta_ratio == 1.0 {
        return Some(Refraction { direction: -direction, transmittance });
    }
    let t = refracted_cosine(cosine, eta_ratio)?;
    let refracted = (cosine * normal - direction) / eta_ratio - t * normal;
    Some(Refraction { direction: refracted.normalize(), transmittance })
}

/// Mirrors `direction` (pointing away from the surface) about the unit `normal`.
pub fn reflect(normal: DVec3, direction: DVec3) -> DVec3 {
    (2.0 * normal.dot(direction) * normal - direction).normalize()
}

/// `2C₁(n)`: twice the first moment of the reflectance from inside a medium of relative index `n`
/// (fit of d'Eon and Irving 2011; docs/method.md 2.4). Valid for 0.4 ≤ n ≤ 2.5.
pub fn twice_first_moment(n: f64) -> f64 {
    if n < 1.0 {
        polynomial(n, &[0.919317, -3.4793, 6.75335, -7.80989, 4.98554, -1.36881])
    } else {
        polynomial(n, &[-9.23372, 22.2272, -20.9292, 10.2291, -2.54396, 0.254913])
    }
}

/// `3C₂(n)`: three times the second moment (docs/method.md 2.5). In float32 it would lose four digits: its terms reach
/// 1.6·10³.
pub fn thrice_second_moment(n: f64) -> f64 {
    if n < 1.0 {
        polynomial(n, &[0.828421, -2.62051, 3.36231, -1.95284, 0.236494, 0.145787])
    } else {
        let inverse = polynomial(1.0 / n, &[0.0, 1376.53, -656.175, 135.926]);
        inverse + polynomial(n, &[-1641.1, 1213.67, -568.556, 164.798, -27.0181, 1.91826])
    }
}

/// Width of the interval below `n = 1` in which the moments are blended.
const JOINT: f64 = 0.04;

/// A fitted moment without the jump between its branches at `n = 1`, where the upper branch is off by 0.0043 (2C₁) and
/// −0.0068 (3C₂), and the lower one by a twentieth of that. The models contain `C_φ(η)/C_φ(1/η)`, one of each branch,
/// so the published radiance jumps by 0.41 % on both sides of `η = 1`. Here the lower branch leads linearly to the
/// value of the upper one within 0.04; then the errors of both cancel to 0.04 %. Nothing changes at `η = 1` itself, nor
/// outside 0.96 < η < 1.042.
fn joined(moment: fn(f64) -> f64, n: f64) -> f64 {
    let along = (n - (1.0 - JOINT)) / JOINT;
    if n >= 1.0 || along <= 0.0 {
        return moment(n);
    }
    moment(n) + along * (moment(1.0) - moment(1.0f64.next_down()))
}

/// `C_φ(n) = ¼(1 − 2C₁(n))` (docs/method.md 2.6), continuous at 1.
pub fn c_phi(n: f64) -> f64 {
    0.25 * (1.0 - joined(twice_first_moment, n))
}

/// `C_E(n) = ½(1 − 3C₂(n))` (docs/method.md 2.6), continuous at 1.
pub fn c_e(n: f64) -> f64 {
    0.5 * (1.0 - joined(thrice_second_moment, n))
}

/// `F_dr(η)`: reflectance of diffuse light from inside (fit of Egan and Hilgeman 1973; docs/method.md 3.1).
pub fn diffuse_reflectance(eta: f64) -> f64 {
    if eta < 1.0 {
        polynomial(1.0 / eta, &[-0.4399, 0.7099, -0.3319, 0.0636])
    } else {
        -1.4399 / (eta * eta) + 0.7099 / eta + 0.6681 + 0.0636 * eta
    }
}

/// `Σ coefficients[k] xᵏ` by Horner's rule.
fn polynomial(x: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_has_the_textbook_value() {
        let eta = 1.5;
        let reflectance: f64 = (0.5f64 / 2.5).powi(2);
        assert!((transmittance(1.0, eta) - (1.0 - reflectance)).abs() < 1e-15);
        assert!((transmittance(1.0, 1.0 / eta) - (1.0 - reflectance)).abs() < 1e-15);
    }

    #[test]
    fn transmittance_is_the_same_from_both_sides() {
        for eta in [0.5, 0.7, 1.3, 2.5] {
            for k in 1..100 {
                let c = f64::from(k) / 100.0;
                // Close to the critical angle, crossing twice loses half the digits of t.
                if let Some(t) = refracted_cosine(c, eta).filter(|t| *t > 0.05) {
                    assert!((transmittance(c, eta) - transmittance(t, 1.0 / eta)).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn refraction_obeys_snell_and_reflection_the_mirror() {
        let normal = DVec3::new(0.36, 0.48, 0.8);
        let direction = DVec3::new(0.6, -0.2, 0.7).normalize();
        let entry = enter(normal, direction, 1.33).expect("no total reflection into a denser medium");
        let sine_in = normal.cross(direction).length();
        let sine_out = normal.cross(entry.direction).length();
        assert!((sine_in - 1.33 * sine_out).abs() < 1e-14);
        assert!(entry.direction.dot(normal) < 0.0);
        let mirrored = reflect(normal, direction);
        assert!((mirrored.dot(normal) - direction.dot(normal)).abs() < 1e-15);
        assert!((mirrored + direction).cross(normal).length() < 1e-15);
    }

    #[test]
    fn grazing_and_total_reflection_transmit_nothing() {
        assert_eq!(transmittance(0.0, 1.3), 0.0);
        assert_eq!(transmittance(-0.1, 1.3), 0.0);
        assert_eq!(transmittance(0.3, 1.0 / 1.5), 0.0);
        let tiny = transmittance(1e-7, 1.3);
        assert!(tiny > 0.0 && tiny < 2e-6);
    }

    /// The fits against a quadrature of the exact moments, with the errors that docs/method.md states.
    #[test]
    fn fits_of_the_moments_are_as_close_as_published() {
        let moment = |n: f64, power: i32| {
            let steps = 200_000;
            let width = 1.0 / f64::from(steps);
            let term = |k| {
                let c = (f64::from(k) + 0.5) * width;
                (1.0 - transmittance(c, 1.0 / n)) * c.powi(power) * width
            };
            (0..steps).map(term).sum::<f64>()
        };
        for (n, first, second) in [(0.6, 5e-5, 5e-5), (0.8, 5e-5, 5e-5), (1.3, 1.2e-3, 3.5e-3), (1.5, 2e-3, 4e-3)] {
            assert!((2.0 * moment(n, 1) - twice_first_moment(n)).abs() < first, "2C1({n})");
            assert!((3.0 * moment(n, 2) - thrice_second_moment(n)).abs() < second, "3C2({n})");
        }
    }
}
