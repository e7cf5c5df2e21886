//! The albedo of a medium from the color that it shows: the inverse of multiple scattering.

/// `q = σ_tr/σ_t' = √(3(1 − α'))` of the half-space whose standard dipole reflects the share `color` of the light that
/// enters it, by bisection of its total reflectance (docs/method.md 3.5), which falls as `q` grows. `α' = 1 − q²/3`,
/// and `diffuse_fresnel` is `F_dr`.
///
/// Jensen and Buhler 2002, A Rapid Hierarchical Rendering Technique for Translucent Materials.
pub(crate) fn transport_ratio(color: f64, diffuse_fresnel: f64) -> f64 {
    let reflection = (1.0 + diffuse_fresnel) / (1.0 - diffuse_fresnel);
    let reflectance = |q: f64| 0.5 * (1.0 - q * q / 3.0) * (1.0 + (-4.0 / 3.0 * reflection * q).exp()) * (-q).exp();
    let (mut low, mut high) = (0.0, 3f64.sqrt());
    // A float64 has 53 bits; colors near 1 need more halvings.
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if reflectance(middle) > color { low = middle } else { high = middle }
    }
    high
}

/// Single-scattering albedo of a half-space that reflects the share `multiple` of light from all around, for a boundary
/// without reflection and mean cosine `g`: `s = 4.09712 + 4.20863 ρ − √(9.59217 + 41.6808 ρ + 17.7126 ρ²)`,
/// `α = (1 − s²)/(1 − g s²)`.
///
/// The fit of Kulla and Conty 2017, Revisiting Physically Based Shading at Imageworks, as the glTF drafts
/// KHR_materials_volume_scatter (with `g = 0` here) and KHR_materials_scatter prescribe it.
pub fn single_scattering_albedo(multiple: f64, g: f64) -> f64 {
    let s = 4.09712 + 4.20863 * multiple - (9.59217 + 41.6808 * multiple + 17.7126 * multiple * multiple).sqrt();
    // The fit exceeds 0 and 1 by some 1e-6.
    ((1.0 - s * s) / (1.0 - g * s * s)).clamp(0.0, 1.0)
}
