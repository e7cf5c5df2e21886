//! The geometry that the three channels of the directional dipole share, with the equation of docs/method.md on each
//! line. Lengths are in m. Each part is one loop: the compiler makes worse vector code of several short ones.

use crate::lanes::block::{Block, LANES, Lane, cross, dot};

/// Square of the length below which rounding has taken the direction of a projected unit vector.
const NULL_DIRECTION2: f32 = 1e-12;

/// Square of the distance, m², below which squares lose digits: they come near the end of the range of float32.
const NULL_DISTANCE2: f32 = 1e-30;

/// The geometry on which the depth of the real source depends.
pub(super) struct SourceGeometry {
    /// `r²`.
    pub r2: Lane,
    /// `‖x × ω12‖²` (5.2).
    pub across2: Lane,
    /// `μ₀ = −n_o·ω12` (5.2).
    pub mu0: Lane,
}

/// The projections (5.7) and (5.8), some of them times `k = C_E/(3C_φ)`.
pub(super) struct Projections {
    /// `X_r = x·ω12` (5.8).
    pub x: Lane,
    /// `N_r = x·n_o` (5.8).
    pub n: Lane,
    /// `a = n*·ω12` and `b = n*·n_o` (5.7); NaN where `n*` has no direction.
    pub a: Lane,
    pub b: Lane,
    /// `−k W_r = k μ₀`, and `−k W_v = k (μ₀ + 2ab)` (5.8).
    pub k_mu: Lane,
    pub k_mu_virtual: Lane,
}

impl SourceGeometry {
    #[inline(always)]
    pub fn new(block: &Block, normal_out: [f32; 3]) -> SourceGeometry {
        let zero = [0.0; LANES];
        let mut source = SourceGeometry { r2: zero, across2: zero, mu0: zero };
        for i in 0..LANES {
            let (x, refracted) = (lane(&block.offset, i), lane(&block.refracted, i));
            let across = cross(x, refracted); // x × ω12 (5.2)
            source.r2[i] = dot(x, x);
            source.across2[i] = dot(across, across);
            source.mu0[i] = -dot(refracted, normal_out);
        }
        source
    }
}

impl Projections {
    #[inline(always)]
    pub fn new(block: &Block, normal_out: [f32; 3], source: &SourceGeometry, k: f32) -> Projections {
        let zero = [0.0; LANES];
        let mut p = Projections { x: zero, n: zero, a: zero, b: zero, k_mu: zero, k_mu_virtual: zero };
        for i in 0..LANES {
            let (x, refracted, normal_in) =
                (lane(&block.offset, i), lane(&block.refracted, i), lane(&block.normal_in, i));
            let along = dot(normal_in, x) / source.r2[i]; // (n_i·x̂)/r
            // n_i − (n_i·x̂) x̂ (5.5)
            let normal = [normal_in[0] - along * x[0], normal_in[1] - along * x[1], normal_in[2] - along * x[2]];
            let squared = dot(normal, normal);
            let good = squared > NULL_DIRECTION2 && source.r2[i] > NULL_DISTANCE2;
            let inverse = if good { 1.0 / squared.sqrt() } else { f32::NAN }; // n* = normal · inverse (5.5)
            let (a, b) = (dot(normal, refracted) * inverse, dot(normal, normal_out) * inverse); // (5.7)
            p.x[i] = dot(x, refracted);
            p.n[i] = dot(x, normal_out);
            (p.a[i], p.b[i]) = (a, b);
            p.k_mu[i] = k * source.mu0[i];
            p.k_mu_virtual[i] = k * (source.mu0[i] + 2.0 * a * b);
        }
        p
    }
}

/// The vector of one sample.
#[inline(always)]
fn lane(vectors: &[Lane; 3], i: usize) -> [f32; 3] {
    [vectors[0][i], vectors[1][i], vectors[2][i]]
}
