//! What the three channels of the directional dipole share, lengths in m.
//!
//! Each part is one loop: the compiler makes worse vector code of several short ones.

use super::super::{Block, LANES, Lane, cross, dot};

/// Below this a projected unit vector has lost its direction to rounding; squared.
const NULL_DIRECTION_2: f32 = 1e-12;

/// Below this, m², squares of distances lose digits, for they come near the end of the range of float32.
const NULL_DISTANCE_2: f32 = 1e-30;

/// What the depth of the real source depends on.
pub(super) struct SourceGeometry {
    /// `r²`.
    pub r2: Lane,
    /// `‖x × ω12‖²`.
    pub across2: Lane,
    pub mu0: Lane,
}

/// The projections of method.md 5.7 and 5.8, some of them with `k = C_E/(3C_φ)`.
pub(super) struct Projections {
    /// `x·ω12`.
    pub x: Lane,
    /// `x·n_o`.
    pub n: Lane,
    /// `n*·ω12` and `n*·n_o`; no numbers where `n*` has no direction.
    pub a: Lane,
    pub b: Lane,
    /// `k μ0`, and `k (μ0 + 2ab)`: the same of the virtual source.
    pub k_mu: Lane,
    pub k_mu_virtual: Lane,
}

impl SourceGeometry {
    #[inline(always)]
    pub fn new(block: &Block, normal_out: [f32; 3]) -> SourceGeometry {
        let zero = [0.0; LANES];
        let mut light = SourceGeometry { r2: zero, across2: zero, mu0: zero };
        for i in 0..LANES {
            let (x, refracted) = (lane(&block.offset, i), lane(&block.refracted, i));
            let across = cross(x, refracted);
            light.r2[i] = dot(x, x);
            light.across2[i] = dot(across, across);
            light.mu0[i] = -dot(refracted, normal_out);
        }
        light
    }
}

impl Projections {
    #[inline(always)]
    pub fn new(block: &Block, normal_out: [f32; 3], light: &SourceGeometry, k: f32) -> Projections {
        let zero = [0.0; LANES];
        let mut p = Projections { x: zero, n: zero, a: zero, b: zero, k_mu: zero, k_mu_virtual: zero };
        for i in 0..LANES {
            let (x, refracted, normal_in) =
                (lane(&block.offset, i), lane(&block.refracted, i), lane(&block.normal_in, i));
            // n* = unit(n_i − (n_i·x̂) x̂) (5.5).
            let along = dot(normal_in, x) / light.r2[i];
            let normal = [normal_in[0] - along * x[0], normal_in[1] - along * x[1], normal_in[2] - along * x[2]];
            let squared = dot(normal, normal);
            let good = squared > NULL_DIRECTION_2 && light.r2[i] > NULL_DISTANCE_2;
            let inverse = if good { 1.0 / squared.sqrt() } else { f32::NAN };
            let (a, b) = (dot(normal, refracted) * inverse, dot(normal, normal_out) * inverse);
            p.x[i] = dot(x, refracted);
            p.n[i] = dot(x, normal_out);
            (p.a[i], p.b[i]) = (a, b);
            p.k_mu[i] = k * light.mu0[i];
            p.k_mu_virtual[i] = k * (light.mu0[i] + 2.0 * a * b);
        }
        p
    }
}

/// The vector of one sample.
#[inline(always)]
fn lane(vectors: &[Lane; 3], i: usize) -> [f32; 3] {
    [vectors[0][i], vectors[1][i], vectors[2][i]]
}
