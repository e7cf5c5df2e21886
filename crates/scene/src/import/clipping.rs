//! Whether the near and far planes of a camera, which are not honoured, would cut anything off.

use crate::{
    mesh::Mesh,
    view::{Camera, Projection},
};
use glam::DVec3;

/// Most triangles that are tested for all cameras together. Planes that are left after that count as cutting.
pub(super) const MAX_TESTS: usize = 1 << 26;

/// Cost of clipping a triangle, in tests of depth.
const COST_OF_CLIPPING: usize = 4;

/// Whether the camera sees anything nearer than the first plane, and farther than the second, m. `bounds` are those of
/// the mesh, and `room` is the number of tests that are left.
pub(super) fn cuts(
    (mesh, bounds): (&Mesh, (DVec3, DVec3)),
    origin: DVec3,
    camera: &Camera,
    planes: [f64; 2],
    room: &mut usize,
) -> [bool; 2] {
    let eye = camera.position - origin;
    let depth = |p: DVec3| (p - eye).dot(camera.forward);
    let (low, high) = bounds;
    let corners = (0..8).map(|k| depth(DVec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), high, low)));
    let (nearest, farthest) = corners.fold((f64::INFINITY, 0.0f64), |(n, f), d| (n.min(d), f.max(d)));
    let mut open = [nearest < planes[0] && planes[0] > 0.0, farthest > planes[1]];
    let mut cut = [false; 2];
    for k in 0..mesh.triangles.len() {
        if open == [false; 2] {
            return cut;
        }
        let Some(left) = room.checked_sub(1) else { return [cut[0] || open[0], cut[1] || open[1]] };
        *room = left;
        let corners = mesh.corners(k);
        let depths = corners.map(depth);
        for side in 0..2 {
            let beyond = |d: f64| if side == 0 { d > 0.0 && d < planes[0] } else { d > planes[1] };
            let spans = side == 0 && depths.iter().any(|d| *d < planes[0]) && depths.iter().any(|d| *d > 0.0);
            if !(open[side] && (spans || depths.into_iter().any(beyond))) {
                continue;
            }
            *room = room.saturating_sub(COST_OF_CLIPPING);
            if is_seen(camera, corners.map(|p| p - eye), planes, side) {
                (open[side], cut[side]) = (false, true);
            }
        }
    }
    cut
}

/// True if a part of the triangle lies in the frame, and before the near plane (`side` 0) or behind the far plane.
fn is_seen(camera: &Camera, corners: [DVec3; 3], [near, far]: [f64; 2], side: usize) -> bool {
    let local = |p: DVec3| DVec3::new(p.dot(camera.right), p.dot(camera.up), p.dot(camera.forward));
    let corners = corners.map(local);
    // Half the height of the frame: at depth 0, and its increase with depth.
    let (fixed, slope) = match camera.projection {
        Projection::Perspective { tangent } => (0.0, tangent),
        Projection::Orthographic { half_height } => (half_height, 0.0),
    };
    // A camera without an aspect ratio has that of the image, which is taken as square.
    let aspect = camera.aspect.unwrap_or(1.0);
    let edge = |axis: DVec3, scale: f64| (DVec3::Z * (slope * scale) - axis, fixed * scale);
    let frame = [edge(DVec3::X, aspect), edge(-DVec3::X, aspect), edge(DVec3::Y, 1.0), edge(-DVec3::Y, 1.0)];
    let depth = if side == 0 { [(DVec3::Z, 0.0), (-DVec3::Z, near)] } else { [(DVec3::Z, -far), (DVec3::Z, 0.0)] };
    let bounds = || frame.into_iter().chain(depth);
    // Most triangles lie outside one of the planes.
    if bounds().any(|(normal, offset)| corners.iter().all(|p| normal.dot(*p) + offset < 0.0)) {
        return false;
    }
    let polygon =
        bounds().fold(corners.to_vec(), |polygon, (normal, offset)| clip(&polygon, |p| normal.dot(p) + offset));
    // A polygon that touches the plane is not cut.
    let margin = 1e-6;
    polygon
        .iter()
        .any(|p| if side == 0 { p.z > 0.0 && p.z < near * (1.0 - margin) } else { p.z > far * (1.0 + margin) })
}

/// The part of a convex polygon in which a linear function is not negative.
fn clip(polygon: &[DVec3], height: impl Fn(DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (above, next) = (height(*a), height(b));
        if above >= 0.0 {
            kept.push(*a);
        }
        if (above < 0.0) != (next < 0.0) {
            kept.push(*a + (b - *a) * (above / (above - next)));
        }
    }
    kept
}
