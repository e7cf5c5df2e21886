//! Surfaces of revolution about the Y axis.

use glam::{DVec2, DVec3};

use crate::mesh::Mesh;

/// Vertices around the axis: 4 · 2^DOUBLINGS.
const DOUBLINGS: usize = 4;
/// Rings along each arc of the profile.
const RINGS: usize = 3;

/// Turns a profile of (radius, height), m, that goes from the axis to the axis with the outside on its right: upwards
/// on the outer side. It is rounded off: a quadratic B-spline of which these are the control points.
pub fn turn(profile: &[[f64; 2]]) -> Mesh {
    let around = circle();
    let rings = spline(&profile.iter().copied().map(DVec2::from_array).collect::<Vec<_>>());
    let mut mesh = Mesh::default();
    let mut before: Vec<u32> = Vec::new();
    for (k, (point, normal)) in rings.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let on_axis = k == 0 || k + 1 == rings.len();
        let count = if on_axis { 1 } else { around.len() };
        for spoke in &around[..count] {
            let out = |v: &DVec2| DVec3::new(v.x * spoke.x, v.y, v.x * spoke.y);
            mesh.positions.push(out(&if on_axis { DVec2::new(0.0, point.y) } else { *point }).as_vec3());
            mesh.normals.push(if on_axis { DVec3::Y * normal.y.signum() } else { out(normal) }.as_vec3());
        }
        let ring: Vec<u32> = (0..around.len() as u32).map(|j| first + j % count as u32).collect();
        for j in (0..around.len()).filter(|_| k > 0) {
            let next = (j + 1) % around.len();
            let quad = [before[j], ring[j], ring[next], before[next]];
            let sides = [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]];
            let whole = |t: &&[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
            mesh.triangles.extend(sides.iter().filter(whole));
        }
        before = ring;
    }
    mesh
}

/// Points and unit normals along a quadratic B-spline that begins and ends with its first and last control point.
fn spline(control: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let last = control.len() - 1;
    let mut points = Vec::new();
    for k in 1..last {
        let from = if k == 1 { control[0] } else { control[k - 1].midpoint(control[k]) };
        let to = if k + 1 == last { control[last] } else { control[k].midpoint(control[k + 1]) };
        let steps = if k + 1 == last { 0..=RINGS } else { 0..=RINGS - 1 };
        for step in steps {
            let t = step as f64 / RINGS as f64;
            let (a, b) = (from.lerp(control[k], t), control[k].lerp(to, t));
            let along = (b - a).normalize();
            points.push((a.lerp(b, t), DVec2::new(along.y, -along.x)));
        }
    }
    points
}

/// Unit vectors around the circle, by halving angles: square roots are the same on every machine, sines are not.
pub fn circle() -> Vec<DVec2> {
    let mut around = vec![DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
    for _ in 0..DOUBLINGS {
        let next = |k: usize| around[(k + 1) % around.len()];
        around = (0..around.len()).flat_map(|k| [around[k], (around[k] + next(k)).normalize()]).collect();
    }
    around
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed and outward: its volume is that of the cylinder less what the spline rounds off.
    #[test]
    fn a_turned_cylinder_has_its_volume() {
        let mesh = turn(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.001], [1.0, 1.999], [1.0, 2.0], [0.0, 2.0]]);
        let tetrahedron = |[a, b, c]: [DVec3; 3]| a.dot(b.cross(c)) / 6.0;
        let volume: f64 = mesh.triangles.iter().map(|t| tetrahedron(mesh.corners(*t))).sum();
        assert!((5.0..std::f64::consts::TAU).contains(&volume), "{volume}");
    }
}
