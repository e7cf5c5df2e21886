//! Emitting triangles whose emission varies with a texture, cut into parts by how bright it is there.

use super::texel_sums::TexelSums;
use crate::{
    mesh::{Mesh, area},
    texture::Texture,
};
use glam::{DVec2, DVec3};

/// Cells of the texture's sums that a part extends over, about.
const CELLS_OF_PART: f64 = 1.0;

/// Most parts of all triangles together, unless there are more triangles, and most along the edge of one.
const MAX_PARTS: usize = 1 << 18;
const MAX_ALONG_EDGE: usize = 64;

/// A part of a triangle.
pub(super) struct Part {
    pub corners: [DVec3; 3],
    /// Texture coordinates at the corners.
    pub coordinates: [DVec2; 3],
    /// Its area, m².
    pub area: f64,
    /// An estimate of the mean channel sum of its radiance, above zero, W/(m² sr).
    pub brightness: f64,
}

/// The parts of these triangles that are not black, where `radiance` is multiplied by the texture.
pub(super) fn parts(mesh: &Mesh, triangles: &[usize], radiance: DVec3, texture: &Texture) -> Vec<Part> {
    let sums = TexelSums::new(texture, radiance);
    let limit = (MAX_PARTS / triangles.len().max(1)).isqrt().clamp(1, MAX_ALONG_EDGE);
    let mut parts = Vec::new();
    for k in triangles {
        let corners = mesh.corners(*k);
        let coordinates = mesh.triangles[*k].vertices.map(|i| mesh.emission_coordinate(i));
        let extent = (coordinates[0] - coordinates[1])
            .abs()
            .max((coordinates[1] - coordinates[2]).abs())
            .max((coordinates[2] - coordinates[0]).abs());
        let across = (extent * sums.cells()).max_element() / CELLS_OF_PART;
        // A cast of a number that is not one gives 0.
        let count = (across.ceil() as usize).clamp(1, limit);
        for weights in division(count) {
            let corners = weights.map(|w| corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]);
            let at = |w: [f64; 3]| coordinates[0] * w[0] + coordinates[1] * w[1] + coordinates[2] * w[2];
            let coordinates = weights.map(at);
            let [a, b, c] = coordinates;
            let brightness = sums.mean(a.min(b).min(c), a.max(b).max(c));
            let area = area(corners);
            if brightness > 0.0 && area > 0.0 {
                parts.push(Part { corners, coordinates, area, brightness });
            }
        }
    }
    parts
}

/// Barycentric weights of the corners of `count²` equal parts of a triangle, wound as it is.
fn division(count: usize) -> impl Iterator<Item = [[f64; 3]; 3]> {
    let corner = move |i: usize, j: usize| {
        let [u, v] = [i, j].map(|k| k as f64 / count as f64);
        [(count - i - j) as f64 / count as f64, u, v]
    };
    let cells = (0..count).flat_map(move |i| (0..count - i).map(move |j| (i, j)));
    cells.flat_map(move |(i, j)| {
        let upright = [corner(i, j), corner(i + 1, j), corner(i, j + 1)];
        let turned = (i + j + 1 < count).then(|| [corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
        [Some(upright), turned].into_iter().flatten()
    })
}

#[cfg(test)]
mod tests {
    use super::division;

    /// Seen to catch: the turned parts left out.
    #[test]
    fn the_parts_cover_the_triangle() {
        for count in [1, 2, 5] {
            let parts: Vec<_> = division(count).collect();
            assert_eq!(parts.len(), count * count);
            let cross = |[a, b, c]: [[f64; 3]; 3]| (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
            let area = 1.0 / (count * count) as f64;
            assert!(parts.iter().all(|part| (cross(*part) - area).abs() < 1e-12), "{parts:?}");
        }
    }
}
