//! Boxes whose faces are cut by planes at given coordinates: watertight without T-junctions, however uneven the cuts,
//! because neighboring faces share the cuts of their common edge.

use std::collections::BTreeMap;

use glam::DVec3;

/// Cut coordinates of x, y, z in metres, ascending; the first and last of each are the faces of the box.
pub struct Lattice {
    pub cuts_m: [Vec<f64>; 3],
}

/// Surface of a box, its vertices not yet rounded to f32 so that callers may reshape them.
#[derive(Default)]
pub struct BoxSurface {
    pub positions_m: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// A crossing of three cuts, by their indices in the lists.
type Crossing = [usize; 3];

impl Lattice {
    pub fn surface(&self) -> BoxSurface {
        let mut surface = BoxSurface::default();
        let mut vertices = BTreeMap::new();
        for quad in self.quads() {
            let [a, b, c, d] = quad.map(|crossing| {
                *vertices.entry(crossing).or_insert_with(|| {
                    surface.positions_m.push(self.position(crossing));
                    surface.positions_m.len() as u32 - 1
                })
            });
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
        surface
    }

    fn position(&self, [x, y, z]: Crossing) -> DVec3 {
        DVec3::new(self.cuts_m[0][x], self.cuts_m[1][y], self.cuts_m[2][z])
    }

    /// All cells of the six faces, counter-clockwise seen from outside.
    fn quads(&self) -> Vec<[Crossing; 4]> {
        let last = |axis: usize| self.cuts_m[axis].len() - 1;
        let mut quads = Vec::new();
        for axis in 0..3 {
            let (u_axis, v_axis) = ((axis + 1) % 3, (axis + 2) % 3);
            for u in 0..last(u_axis) {
                for v in 0..last(v_axis) {
                    let crossing = |at: usize, u: usize, v: usize| {
                        let mut crossing = [0; 3];
                        (crossing[axis], crossing[u_axis], crossing[v_axis]) = (at, u, v);
                        crossing
                    };
                    let around = [(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)];
                    quads.push(around.map(|(u, v)| crossing(last(axis), u, v)));
                    let mut near = around.map(|(u, v)| crossing(0, u, v));
                    near.reverse();
                    quads.push(near);
                }
            }
        }
        quads
    }
}

/// `count` equal steps from `from` to `to`, both included.
pub fn even_cuts(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
}
