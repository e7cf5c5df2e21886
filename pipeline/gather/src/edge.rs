//! A control variate for pixels at silhouettes, where the share of scattered light that a path sees varies more than
//! that light does.
//!
//! A path's scattered light is `f = Σ g s`: `g` is the share of light that arrives from below a surface, the
//! transmittance of the first interface or what that mirrors times the transmittance of the surface that is mirrored,
//! and 0 where the path meets something else; `s` is the light below. Without a gather a ray tells `g`, and `ŝ`, the light
//! that is known nearby. With the mean `K` of `k = Σ g ŝ` over many rays, `f − k + K` has the expectation of `f` for any
//! `ŝ` that does not depend on the path (docs/method.md 13.2). A pixel may become slightly negative; clamping it would
//! bias the mean.

use crate::path_state::Layer;

/// A pixel is at an edge if a share differs by more than this between its corners.
const MIN_SPREAD: f64 = 0.1;

/// Number of rays for each path.
pub const RAYS: u32 = 16;

/// The layer of the light that is seen each way.
pub const LAYER_OF: [Layer; 2] = [Layer::Subsurface, Layer::Specular];

/// The least and the largest share that arrives at the corner of a pixel, for each way.
pub type Corner = [[f64; 2]; 2];

/// Whether a pixel is at an edge, by its corners.
pub fn is_between(corners: [Corner; 4]) -> bool {
    let spread = |way: usize| {
        let range = |[low, high]: [f64; 2], corner: &Corner| [low.min(corner[way][0]), high.max(corner[way][1])];
        let [low, high] = corners.iter().fold([1.0, 0.0], range);
        high - low
    };
    (0..2).any(|way| spread(way) > MIN_SPREAD)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: the first way alone; the least share of one corner over the largest of the same; one corner left out.
    #[test]
    fn a_pixel_is_at_an_edge_if_a_share_differs_between_its_corners() {
        let alike = |share: f64| [[share; 2]; 2];
        assert!(!is_between([alike(0.9), alike(0.85), alike(0.9), alike(0.9)]));
        for way in 0..2 {
            for corner in 0..4 {
                let mut corners = [alike(0.5); 4];
                corners[corner][way] = [0.35; 2];
                assert!(is_between(corners), "{way} {corner}");
                corners[corner][way] = [0.45, 0.56];
                assert!(is_between(corners), "{way} {corner}");
            }
        }
    }
}
