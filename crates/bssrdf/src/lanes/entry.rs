//! How light enters a medium, for sixteen samples (docs/method.md 2.1 to 2.3); [`bsdf::fresnel::enter`] is the float64
//! reference.
//!
//! Normals `N` and directions `D` are vectors of integers, of any length. So `m = N·D`, `N²` and `D²` are exact, and
//! the cosine `m/√(N² D²)` keeps its digits at grazing angles, where a dot product of unit vectors in float32 loses
//! them. With `w = √(m² + (η² − 1) N² D²)`, which is `η t √(N² D²)`:
//!
//! ```text
//! T12 = 2 m w [1/(m + w)² + η²/(η² m + w)²]        ω12 = [(m − w) N/N² − D] / (η √D²)
//! ```

use super::block::{LANES, Lane, each};
use crate::rough_interface::RoughEntry;

/// Integers, one for each sample.
type Integers = [i32; LANES];

/// Sixteen directions, component by component, of any length. The magnitudes of the components of a vector add up to
/// 32768 at most, so that its products fit into an `i32`.
pub type Directions = [Integers; 3];

/// The interface that light enters through, from outside; no units.
#[derive(Clone, Debug)]
pub struct EntryRefraction {
    /// `η² − 1`: float64, because beyond it there is total reflection if `η < 1`.
    excess: f64,
    /// `η²`.
    squared: f32,
    /// `1/η`.
    inverse: f32,
    /// The transmittance of a rough interface; light goes on in the direction that a smooth one sends it in.
    rough: Option<RoughEntry>,
}

/// The light of sixteen samples that enters; no units.
#[derive(Clone, Copy, Debug)]
pub struct Entered {
    /// `n_i`, unit.
    pub normal: [Lane; 3],
    /// `ω12`, unit, into the medium; finite but without meaning where nothing enters.
    pub refracted: [Lane; 3],
    /// `T12`; 0 where nothing enters.
    pub transmittance: Lane,
}

impl EntryRefraction {
    /// The interface of relative index `eta`, inside over outside.
    pub fn new(eta: f64) -> EntryRefraction {
        let (excess, squared) = ((eta - 1.0) * (eta + 1.0), (eta * eta) as f32);
        EntryRefraction { excess, squared, inverse: (1.0 / eta) as f32, rough: None }
    }

    /// The same interface with this roughness.
    pub fn behind(&self, rough: &RoughEntry) -> EntryRefraction {
        EntryRefraction { rough: Some(rough.clone()), ..*self }
    }

    /// What the light of sixteen samples gains in each channel below a rough interface, if it gains anything.
    pub fn gains(&self, normal: &Directions, direction: &Directions) -> Option<[Lane; 3]> {
        let rough = self.rough.as_ref()?;
        let (m, normal2, direction2) = (dot(normal, direction), dot(normal, normal), dot(direction, direction));
        let mut gains = [[1.0; LANES]; 3];
        for i in (0..LANES).filter(|i| m[*i] > 0) {
            let cosine = m[i] as f32 / ((normal2[i] as f32) * (direction2[i] as f32)).sqrt();
            let of_sample = rough.gains(cosine)?;
            (0..3).for_each(|c| gains[c][i] = of_sample[c]);
        }
        Some(gains)
    }

    /// Unit normals, refracted directions and transmittances of sixteen samples; `direction` points towards the light.
    /// `T12 = 0` where nothing enters: light from behind, or totally reflected.
    #[inline(always)]
    pub fn enter(&self, normal: &Directions, direction: &Directions) -> Entered {
        let m = dot(normal, direction); // N·D
        let (normal2, direction2) = (dot(normal, normal), dot(direction, direction)); // N², D²
        let w = self.root(&m, &normal2, &direction2);
        let mut transmittance = each(|i| self.transmittance(m[i] as f32, w[i]));
        if let Some(rough) = &self.rough {
            for (i, t) in transmittance.iter_mut().enumerate().filter(|(_, t)| **t > 0.0) {
                *t = rough.at(m[i] as f32 / ((normal2[i] as f32) * (direction2[i] as f32)).sqrt());
            }
        }
        let mut entered = Entered { normal: [[0.0; LANES]; 3], refracted: [[0.0; LANES]; 3], transmittance };
        for i in 0..LANES {
            let inverse = 1.0 / (normal2[i] as f32).sqrt();
            let outer = self.inverse / (direction2[i] as f32).sqrt();
            let along = (m[i] as f32 - w[i]) * (inverse * inverse);
            for c in 0..3 {
                entered.normal[c][i] = normal[c][i] as f32 * inverse;
                entered.refracted[c][i] = (along * normal[c][i] as f32 - direction[c][i] as f32) * outer;
            }
        }
        entered
    }

    /// `w` of `m`, `N²` and `D²`; 0 for total reflection. The sum is in float64, for its terms cancel at the critical
    /// angle.
    #[inline(always)]
    fn root(&self, m: &Integers, normal2: &Integers, direction2: &Integers) -> Lane {
        let squared = each(|i| {
            let m = f64::from(m[i]);
            (m * m + self.excess * (f64::from(normal2[i]) * f64::from(direction2[i]))) as f32
        });
        each(|i| if squared[i] > 0.0 { squared[i].sqrt() } else { 0.0 })
    }

    /// `T12` of `m` and `w`.
    #[inline(always)]
    fn transmittance(&self, m: f32, w: f32) -> f32 {
        let (perpendicular, parallel) = (m + w, self.squared * m + w);
        // One division for both, in two steps: the square of the product can leave the range of float32.
        let inverse = 1.0 / (perpendicular * parallel);
        let sum = parallel * parallel + self.squared * perpendicular * perpendicular;
        let value = (2.0 * m * w * inverse) * (sum * inverse);
        if m > 0.0 { value } else { 0.0 }
    }
}

#[inline(always)]
fn dot(a: &Directions, b: &Directions) -> Integers {
    let mut sum = [0; LANES];
    for i in 0..LANES {
        sum[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use bsdf::fresnel;
    use glam::{DVec3, IVec3};

    /// Linear congruential, high half: test data only.
    fn next(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 32) as f64 + 0.5) / 4_294_967_296.0
    }

    /// The vector of integers next to a direction.
    fn integers(v: DVec3) -> IVec3 {
        (v * (32767.0 / v.abs().element_sum())).round().as_ivec3()
    }

    fn anywhere(state: &mut u64) -> IVec3 {
        let z = 2.0 * next(state) - 1.0;
        let (sine, cosine) = (std::f64::consts::TAU * next(state)).sin_cos();
        integers(DVec3::new(sine, cosine, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z)
    }

    fn unit(v: IVec3) -> DVec3 {
        v.as_dvec3().normalize()
    }

    /// A direction at a cosine of about `cosine` from `normal`.
    fn direction(state: &mut u64, normal: DVec3, cosine: f64) -> IVec3 {
        let across = normal.cross(unit(anywhere(state))).normalize();
        integers(across * (1.0 - cosine * cosine).sqrt() + normal * cosine)
    }

    fn lanes(vectors: [IVec3; LANES]) -> Directions {
        [0, 1, 2].map(|c| vectors.map(|v| v[c]))
    }

    const INDICES: [f64; 8] = [0.41, 0.7, 0.999, 1.0, 1.0 + 1e-7, 1.3, 1.9, 2.5];

    #[test]
    fn as_close_to_float64_as_float32_can_be() {
        let mut state = 2;
        let mut grazing = 0;
        for k in 0..40_000 {
            let eta = INDICES[k % INDICES.len()];
            let critical = (1.0 - eta * eta).max(0.0).sqrt();
            let normal = [0; LANES].map(|_| anywhere(&mut state));
            let mut towards = normal;
            for i in 0..LANES {
                // Any angle, grazing, and close to the critical one.
                let cosine = [next(&mut state), 0.0, critical][i % 3];
                towards[i] = direction(&mut state, unit(normal[i]), cosine);
            }
            let entered = EntryRefraction::new(eta).enter(&lanes(normal), &lanes(towards));
            for i in 0..LANES {
                let error = DVec3::from_array(entered.normal.map(|lane| f64::from(lane[i]))) - unit(normal[i]);
                assert!(error.abs().max_element() < 1.5e-7, "{}", normal[i]);
                grazing += usize::from(agrees(&entered, i, [unit(normal[i]), unit(towards[i])], eta));
            }
        }
        assert!(grazing > 100, "{grazing} cosines of 1e-7 or less");
    }

    /// Compares one sample with the float64 interface; true if light entered at a cosine below 1e-7.
    fn agrees(entered: &Entered, i: usize, [normal, towards]: [DVec3; 2], eta: f64) -> bool {
        let transmittance = f64::from(entered.transmittance[i]);
        let refracted = DVec3::from_array(entered.refracted.map(|lane| f64::from(lane[i])));
        assert!(refracted.is_finite());
        let cosine = normal.dot(towards);
        // The reference's own rounding decides here.
        let beyond = cosine * cosine + (eta - 1.0) * (eta + 1.0);
        if cosine.abs() < 1e-11 || beyond.abs() < 1e-10 && eta != 1.0 {
            return false;
        }
        let Some(exact) = fresnel::enter(normal, towards, eta) else {
            assert_eq!(transmittance, 0.0, "eta {eta} cosine {cosine}");
            return false;
        };
        let error = (transmittance / exact.transmittance - 1.0).abs();
        assert!(error < 6e-7, "eta {eta} cosine {cosine}: {error}");
        // Into a thinner medium everything across the normal is stretched by 1/η, rounding as well. The worst of these
        // vectors is off by 4.1e-7, less than four roundings of float32 (2⁻²³ each).
        let error = (refracted - exact.direction).abs().max_element() * eta.min(1.0);
        assert!(error < 4.5e-7, "eta {eta} cosine {cosine}: {error}");
        cosine < 1e-7
    }

    #[test]
    fn light_from_behind_and_total_reflection_enter_nowhere() {
        let up = lanes([integers(DVec3::Z); LANES]);
        let slanted = |cosine: f64| lanes([integers(DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)); LANES]);
        for (eta, cosine) in [(1.3, -0.5), (1.0, -0.5), (1.0, 0.0), (1.3, 0.0), (0.7, 0.0), (0.7, 0.7), (0.7, -0.9)] {
            let entered = EntryRefraction::new(eta).enter(&up, &slanted(cosine));
            assert_eq!(entered.transmittance, [0.0; LANES], "eta {eta} cosine {cosine}");
            assert!(entered.refracted.iter().flatten().all(|v| v.is_finite()));
        }
        assert_eq!(EntryRefraction::new(1.0).enter(&up, &slanted(0.5)).transmittance, [1.0; LANES]);
    }
}
