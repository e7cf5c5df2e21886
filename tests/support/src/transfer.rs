//! Half-spaces of isotropic scatterers, solved without random numbers: what random walks are checked against.

use bsdf::fresnel;

/// Cosines at which the angular distributions are known: midpoints.
const NODES: usize = 400;

fn node(k: usize) -> f64 {
    (k as f64 + 0.5) / NODES as f64
}

/// Chandrasekhar's H function of isotropic scattering, from its integral equation by iteration.
struct H {
    albedo: f64,
    nodes: Vec<f64>,
}

impl H {
    fn new(albedo: f64) -> H {
        let mut h = H { albedo, nodes: vec![1.0; NODES] };
        loop {
            let next: Vec<f64> = (0..NODES).map(|k| 0.5 * (h.nodes[k] + h.at(node(k)))).collect();
            let change = (next[NODES - 1] - h.nodes[NODES - 1]).abs();
            h.nodes = next;
            if change < 1e-9 {
                return h;
            }
        }
    }

    fn at(&self, mu: f64) -> f64 {
        let integral: f64 = (0..NODES).map(|k| node(k) * self.nodes[k] / (mu + node(k))).sum::<f64>() / NODES as f64;
        1.0 / ((1.0 - self.albedo).sqrt() + 0.5 * self.albedo * integral)
    }
}

/// Reflectance of a half-space of isotropic scatterers without a boundary, `1 − H(μ)√(1−ϖ)` (Chandrasekhar 1950).
pub fn chandrasekhar(albedo: f64, cosine: f64) -> f64 {
    1.0 - H::new(albedo).at(cosine) * (1.0 - albedo).sqrt()
}

/// Share of the light of incidence cosine `cosine` that a half-space of isotropic scatterers behind a smooth boundary
/// of relative index `eta` scatters back. Light that leaves the half-space with cosine `μ`, of which the share `R(μ)`
/// is sent back by the boundary, has by Chandrasekhar's law of reflection the density `(ϖ/2) μ H(μ)H(μ₀)/(μ + μ₀)`.
pub fn scattered_reflectance(albedo: f64, eta: f64, cosine: f64) -> f64 {
    let h = H::new(albedo);
    let entry = ((1.0 - cosine * cosine) / (eta * eta)).mul_add(-1.0, 1.0).sqrt();
    let law = |h0: f64, mu0: f64, k: usize| 0.5 * albedo * node(k) * h.nodes[k] * h0 / (node(k) + mu0);
    let leaves: Vec<f64> = (0..NODES).map(|k| fresnel::transmittance(node(k), 1.0 / eta)).collect();
    let mut density: Vec<f64> = (0..NODES).map(|k| law(h.at(entry), entry, k)).collect();
    let (mut sum, mut more) = (0.0, 1.0);
    while more > 1e-7 {
        more = (0..NODES).map(|k| density[k] * leaves[k]).sum::<f64>() / NODES as f64;
        sum += more;
        let sent_back: Vec<f64> = (0..NODES).map(|k| density[k] * (1.0 - leaves[k]) / NODES as f64).collect();
        density = (0..NODES).map(|k| (0..NODES).map(|j| sent_back[j] * law(h.nodes[j], node(j), k)).sum()).collect();
    }
    fresnel::transmittance(cosine, eta) * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// H(1) of an albedo of 0.9 is 1.8501 (Chandrasekhar 1950, table XI; the reflectance is 0.4150), and with a boundary of
    /// index 1 nothing is sent back.
    #[test]
    fn published_values_and_no_boundary() {
        assert!((chandrasekhar(0.9, 1.0) - 0.4150).abs() < 2e-4);
        for (albedo, cosine) in [(0.5, 1.0), (0.9, 0.3)] {
            let difference = scattered_reflectance(albedo, 1.0, cosine) - chandrasekhar(albedo, cosine);
            assert!(difference.abs() < 2e-4, "{difference}");
        }
    }
}
