//! How light enters, for sixteen samples as a cloud stores them: unit vectors decoded, then refracted (method.md 2.1 to
//! 2.3; `fresnel::enter` is the float64 reference).
//!
//! An octahedral code is a vector `N` of integers with `|N_x| + |N_y| + |N_z| = 32767`, and the cosine is
//! `m/√(N² D²)` with integers `m = N·D`, `N²` and `D²` below 2³⁰. So nothing is lost at grazing angles, where a dot product
//! of unit vectors in float32 has no digits left. With `w = √(m² + (η² − 1) N² D²)`, which is `η t √(N² D²)`:
//!
//! ```text
//! T12 = 2 m w [1/(m + w)² + η²/(η² m + w)²]        ω12 = [(m − w) N/N² − D] / (η √D²)
//! ```

use super::{LANES, Lane, each};

/// The code of 1.
const STEPS: i32 = i16::MAX as i32;

/// Integers, one for each sample.
type Whole = [i32; LANES];

/// The interface that light enters by, from outside; no units.
#[derive(Clone, Copy, Debug)]
pub struct EntryRefraction {
    /// `η² − 1`: float64, because beyond it there is total reflection if `η < 1`.
    excess: f64,
    /// `η²`.
    squared: f32,
    /// `1/η`.
    inverse: f32,
}

/// What enters of sixteen samples; no units.
#[derive(Clone, Copy, Debug)]
pub struct Entered {
    /// `n_i`, unit.
    pub normal: [Lane; 3],
    /// `ω12`, unit, into the medium; finite but of no meaning where nothing enters.
    pub refracted: [Lane; 3],
    /// `T12`; 0 where nothing enters.
    pub transmittance: Lane,
}

/// The products of sixteen pairs of vectors: all below 2³⁰, as no component exceeds 32767 and their sum neither.
struct Products {
    /// `m = N·D`.
    cosine: Whole,
    /// `N²`.
    normal: Whole,
    /// `D²`.
    direction: Whole,
}

impl EntryRefraction {
    /// The interface of relative index `eta`, inside over outside.
    pub fn new(eta: f64) -> EntryRefraction {
        EntryRefraction { excess: (eta - 1.0) * (eta + 1.0), squared: (eta * eta) as f32, inverse: (1.0 / eta) as f32 }
    }

    /// Unit normals, refracted directions and transmittances of sixteen samples, given as octahedral codes: int16 x in
    /// the low half, y in the high half. `direction` points towards the light. `T12 = 0` where nothing enters: light
    /// from behind, or totally reflected.
    #[inline(always)]
    pub fn enter(&self, normal: &[u32; LANES], direction: &[u32; LANES]) -> Entered {
        let (normal, direction) = (decode(normal), decode(direction));
        let products = Products::of(&normal, &direction);
        let root = self.root(&products);
        let transmittance = each(|i| self.transmittance(products.cosine[i] as f32, root[i]));
        let mut entered = Entered { normal: [[0.0; LANES]; 3], refracted: [[0.0; LANES]; 3], transmittance };
        for i in 0..LANES {
            let inverse = 1.0 / (products.normal[i] as f32).sqrt();
            let outer = self.inverse / (products.direction[i] as f32).sqrt();
            let along = (products.cosine[i] as f32 - root[i]) * (inverse * inverse);
            for c in 0..3 {
                entered.normal[c][i] = normal[c][i] as f32 * inverse;
                entered.refracted[c][i] = (along * normal[c][i] as f32 - direction[c][i] as f32) * outer;
            }
        }
        entered
    }

    /// `w`; 0 for total reflection. The sum cancels at the critical angle, so it is done in float64.
    #[inline(always)]
    fn root(&self, products: &Products) -> Lane {
        let squared = each(|i| {
            let cosine = f64::from(products.cosine[i]);
            let lengths = f64::from(products.normal[i]) * f64::from(products.direction[i]);
            (cosine * cosine + self.excess * lengths) as f32
        });
        each(|i| if squared[i] > 0.0 { squared[i].sqrt() } else { 0.0 })
    }

    /// `T12` of `m` and `w`.
    #[inline(always)]
    fn transmittance(&self, m: f32, w: f32) -> f32 {
        let (perpendicular, parallel) = (m + w, self.squared * m + w);
        // One division for both, done in two steps: the square of the product can leave the range of float32.
        let inverse = 1.0 / (perpendicular * parallel);
        let sum = parallel * parallel + self.squared * perpendicular * perpendicular;
        let value = (2.0 * m * w * inverse) * (sum * inverse);
        if m > 0.0 { value } else { 0.0 }
    }
}

impl Products {
    #[inline(always)]
    fn of(normal: &[Whole; 3], direction: &[Whole; 3]) -> Products {
        Products { cosine: dot(normal, direction), normal: dot(normal, normal), direction: dot(direction, direction) }
    }
}

#[inline(always)]
fn dot(a: &[Whole; 3], b: &[Whole; 3]) -> Whole {
    let mut sum = [0; LANES];
    for i in 0..LANES {
        sum[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
    }
    sum
}

/// The integer vectors of octahedral codes (Meyer et al. 2010); −32768 reads as −32767. The corners of the square are the
/// lower half: there both coordinates move towards zero by how far `z` is below it. No choices, which would become masked
/// stores that the next loop has to wait for.
#[inline(always)]
fn decode(codes: &[u32; LANES]) -> [Whole; 3] {
    let mut vectors = [[0; LANES]; 3];
    for i in 0..LANES {
        let x = (((codes[i] << 16) as i32) >> 16).max(-STEPS);
        let y = ((codes[i] as i32) >> 16).max(-STEPS);
        let z = STEPS - x.abs() - y.abs();
        let below = (-z).max(0);
        vectors[0][i] = x - with_sign(below, x);
        vectors[1][i] = y - with_sign(below, y);
        vectors[2][i] = z;
    }
    vectors
}

/// `magnitude`, or its negative where `sign < 0`.
#[inline(always)]
fn with_sign(magnitude: i32, sign: i32) -> i32 {
    let ones = sign >> 31;
    (magnitude ^ ones) - ones
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel;
    use glam::DVec3;

    /// Linear congruential, high half: test data only.
    fn next(state: &mut u64) -> u32 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 32) as u32
    }

    /// As the map is defined: a point of the square, its corners folded under the octahedron.
    fn unit(code: u32) -> DVec3 {
        let part = |bits: u16| (f64::from(bits as i16) / 32767.0).max(-1.0);
        let (x, y) = (part(code as u16), part((code >> 16) as u16));
        let z = 1.0 - x.abs() - y.abs();
        let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
        let (x, y) = if z < 0.0 { ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)) } else { (x, y) };
        DVec3::new(x, y, z).normalize()
    }

    /// The code next to `v`, by rounding.
    fn code(v: DVec3) -> u32 {
        let flat = v / (v.x.abs() + v.y.abs() + v.z.abs());
        let over = (-flat.z).max(0.0);
        let part = |v: f64| ((v + if v < 0.0 { -over } else { over }) * 32767.0).round() as i16 as u16;
        u32::from(part(flat.x)) | u32::from(part(flat.y)) << 16
    }

    /// A direction at a cosine of about `cosine` from `normal`.
    fn direction(state: &mut u64, normal: DVec3, cosine: f64) -> u32 {
        let across = normal.cross(unit(next(state))).normalize();
        code(across * (1.0 - cosine * cosine).sqrt() + normal * cosine)
    }

    const INDICES: [f64; 8] = [0.41, 0.7, 0.999, 1.0, 1.0 + 1e-7, 1.3, 1.9, 2.5];

    #[test]
    fn every_code_gives_its_unit_vector() {
        let entry = EntryRefraction::new(1.3);
        let mut state = 1;
        let corners = [0u32, 0x7FFF, 0x8000, 0x8001, 0xFFFF];
        for k in 0..20_000usize {
            let codes = [0; LANES].map(|_| match k {
                0..5 => corners[k] | corners[next(&mut state) as usize % 5] << 16,
                _ => next(&mut state),
            });
            let entered = entry.enter(&codes, &codes);
            for i in 0..LANES {
                let normal = DVec3::from_array(entered.normal.map(|lane| f64::from(lane[i])));
                let error = (normal - unit(codes[i])).abs().max_element();
                assert!(error < 1.5e-7, "{:x} {error}", codes[i]);
            }
        }
    }

    #[test]
    fn as_close_to_float64_as_float32_can_be() {
        let mut state = 2;
        let mut grazing = 0;
        for k in 0..40_000 {
            let eta = INDICES[k % INDICES.len()];
            let critical = (1.0 - eta * eta).max(0.0).sqrt();
            let normal = [0; LANES].map(|_| next(&mut state));
            let mut towards = [0; LANES];
            for i in 0..LANES {
                // Any angle, grazing, and close to the critical one.
                let cosine = [f64::from(next(&mut state)) / 4.3e9, 0.0, critical][i % 3];
                towards[i] = direction(&mut state, unit(normal[i]), cosine);
            }
            let entered = EntryRefraction::new(eta).enter(&normal, &towards);
            for i in 0..LANES {
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
        // Into a thinner medium everything across the normal is stretched by 1/η, rounding as well.
        let error = (refracted - exact.direction).abs().max_element() * eta.min(1.0);
        assert!(error < 4e-7, "eta {eta} cosine {cosine}: {error}");
        cosine < 1e-7
    }

    #[test]
    fn light_from_behind_and_total_reflection_enter_nowhere() {
        let up = [code(DVec3::Z); LANES];
        let slanted = |cosine: f64| [code(DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)); LANES];
        for (eta, cosine) in [(1.3, -0.5), (1.0, -0.5), (1.0, 0.0), (1.3, 0.0), (0.7, 0.0), (0.7, 0.7), (0.7, -0.9)] {
            let entered = EntryRefraction::new(eta).enter(&up, &slanted(cosine));
            assert_eq!(entered.transmittance, [0.0; LANES], "eta {eta} cosine {cosine}");
            assert!(entered.refracted.iter().flatten().all(|v| v.is_finite()));
        }
        assert_eq!(EntryRefraction::new(1.0).enter(&up, &slanted(0.5)).transmittance, [1.0; LANES]);
    }
}
