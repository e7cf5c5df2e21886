//! The zero surface of a field as a mesh, by surface nets: one vertex in each grid cell the surface crosses, one quad
//! across each grid edge it crosses. Neighboring quads share vertices, so the mesh is closed by construction.
//! Vertices are then spread evenly and put back on the surface, which the plain method only meets approximately.

use glam::DVec3;

use crate::field::gradient;
use crate::mesh::Mesh;

/// The grid in which the surface is found. The surface must lie inside it.
pub struct Grid {
    pub low: DVec3,
    pub cell: f64,
    pub cells: [usize; 3],
}

/// Positions on the surface with the direction of the gradient there; triangles counter-clockwise from outside.
pub struct Net {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Net {
    /// The mesh in metres, with its lowest point at height 0.
    pub fn seated(self, metres_per_unit: f64) -> Mesh {
        let lowest = self.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        self.lowered(lowest, metres_per_unit)
    }

    /// The mesh in metres, moved so that `height` becomes 0.
    pub fn lowered(self, height: f64, metres_per_unit: f64) -> Mesh {
        let position = |&p: &DVec3| (metres_per_unit * (p - height * DVec3::Y)).as_vec3();
        Mesh {
            positions: self.positions.iter().map(position).collect(),
            normals: self.normals.iter().map(|n| n.as_vec3()).collect(),
            triangles: self.triangles,
        }
    }
}

/// Rounds of averaging with the neighbors: enough to remove the slivers that the grid leaves.
const SMOOTHING_ROUNDS: usize = 4;
const NEWTON_STEPS: usize = 4;
const SETTLING_ROUNDS: usize = 16;

const NO_VERTEX: u32 = u32::MAX;

pub fn polygonise(field: &impl Fn(DVec3) -> f64, grid: &Grid) -> Net {
    let mut values = grid.sample(field);
    grid.settle(&mut values);
    let (mut positions, vertex_of) = grid.place_vertices(&values);
    let quads = grid.quads(&values, &vertex_of);
    // The step of the finite differences is far below a cell and far above rounding.
    let step = 1e-4 * grid.cell;
    for round in 0..=SMOOTHING_ROUNDS {
        if round > 0 {
            positions = average_with_neighbors(&positions, &quads);
        }
        for p in &mut positions {
            *p = onto_surface(field, *p, step);
        }
    }
    let normals = positions.iter().map(|&p| gradient(field, p, step).normalize()).collect();
    let triangles = quads.iter().flat_map(|quad| split(quad, &positions)).collect();
    Net { positions, normals, triangles }
}

impl Grid {
    /// Grid points of the axis, cells plus one.
    fn points(&self, axis: usize) -> usize {
        self.cells[axis] + 1
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.points(1) + y) * self.points(0) + x
    }

    fn position(&self, point: [usize; 3]) -> DVec3 {
        let [x, y, z] = point.map(|i| i as f64);
        self.low + self.cell * DVec3::new(x, y, z)
    }

    fn all(sizes: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = sizes;
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    fn sample(&self, field: &impl Fn(DVec3) -> f64) -> Vec<f64> {
        let sizes = [self.points(0), self.points(1), self.points(2)];
        Self::all(sizes).map(|point| field(self.position(point))).collect()
    }

    /// Where inside and outside alternate around a face of a cell, four quads would meet in one edge: the nearest of
    /// the corners to the surface is taken to its other side, until there is no such face.
    fn settle(&self, values: &mut [f64]) {
        for _ in 0..SETTLING_ROUNDS {
            let mut settled = true;
            for (cell, axis) in Self::all(self.cells).flat_map(|cell| (0..3).map(move |axis| (cell, axis))) {
                let face = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| {
                    let mut corner = cell;
                    corner[(axis + 1) % 3] += u;
                    corner[(axis + 2) % 3] += v;
                    self.index(corner)
                });
                let inside = face.map(|k| values[k] < 0.0);
                if inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1] {
                    let nearest = |a: usize, b: usize| if values[a].abs() <= values[b].abs() { a } else { b };
                    let corner = face.into_iter().reduce(nearest).unwrap_or(face[0]);
                    values[corner] = if values[corner] < 0.0 { 1e-6 } else { -1e-6 } * self.cell;
                    settled = false;
                }
            }
            if settled {
                break;
            }
        }
    }

    /// The mean of the crossings on the edges of each cell, and the vertex of each cell.
    fn place_vertices(&self, values: &[f64]) -> (Vec<DVec3>, Vec<u32>) {
        let mut positions = Vec::new();
        let mut vertex_of = vec![NO_VERTEX; values.len()];
        for cell in Self::all(self.cells) {
            let (mut sum, mut count) = (DVec3::ZERO, 0);
            for axis in 0..3 {
                for side in 0..4 {
                    let mut from = cell;
                    from[(axis + 1) % 3] += side & 1;
                    from[(axis + 2) % 3] += side >> 1;
                    if let Some(crossing) = self.crossing(values, from, axis) {
                        sum += crossing;
                        count += 1;
                    }
                }
            }
            if count > 0 {
                vertex_of[self.index(cell)] = positions.len() as u32;
                positions.push(sum / f64::from(count));
            }
        }
        (positions, vertex_of)
    }

    /// The point where the surface crosses the grid edge that starts at `from`, if it does.
    fn crossing(&self, values: &[f64], from: [usize; 3], axis: usize) -> Option<DVec3> {
        let mut to = from;
        to[axis] += 1;
        let (a, b) = (values[self.index(from)], values[self.index(to)]);
        let along = a / (a - b);
        ((a < 0.0) != (b < 0.0)).then(|| self.position(from).lerp(self.position(to), along))
    }

    /// One quad for each grid edge that the surface crosses, through the four cells around that edge.
    fn quads(&self, values: &[f64], vertex_of: &[u32]) -> Vec<[u32; 4]> {
        let mut quads = Vec::new();
        for point in Self::all(self.cells) {
            for axis in 0..3 {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                if self.crossing(values, point, axis).is_none() {
                    continue;
                }
                debug_assert!(point[u] > 0 && point[v] > 0, "the surface leaves the grid");
                let mut quad = [(1, 1), (0, 1), (0, 0), (1, 0)].map(|(back_u, back_v)| {
                    let mut cell = point;
                    cell[u] -= back_u;
                    cell[v] -= back_v;
                    vertex_of[self.index(cell)]
                });
                // Outside lies toward +axis when the edge starts inside.
                if values[self.index(point)] >= 0.0 {
                    quad.reverse();
                }
                quads.push(quad);
            }
        }
        quads
    }
}

fn average_with_neighbors(positions: &[DVec3], quads: &[[u32; 4]]) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); positions.len()];
    for quad in quads {
        for corner in 0..4 {
            // Next corner only: the previous one is the next one in the quad across that edge.
            let (sum, count) = &mut sums[quad[corner] as usize];
            *sum += positions[quad[(corner + 1) % 4] as usize];
            *count += 1.0;
        }
    }
    let halfway = |(&p, &(sum, count)): (&DVec3, &(DVec3, f64))| 0.5 * (p + sum / count);
    positions.iter().zip(&sums).map(halfway).collect()
}

/// Moves a point onto the surface by Newton's method along the gradient.
fn onto_surface(field: &impl Fn(DVec3) -> f64, start: DVec3, step: f64) -> DVec3 {
    (0..NEWTON_STEPS).fold(start, |p, _| {
        let slope = gradient(field, p, step);
        p - slope * (field(p) / slope.length_squared())
    })
}

/// Splits a quad along its shorter diagonal, which follows creases better.
fn split(&[a, b, c, d]: &[u32; 4], positions: &[DVec3]) -> [[u32; 3]; 2] {
    let length = |from: u32, to: u32| positions[from as usize].distance(positions[to as usize]);
    if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_lie_on_the_surface() {
        let sphere = |p: DVec3| p.length() - 1.0;
        let grid = Grid { low: DVec3::splat(-1.23), cell: 0.17, cells: [15; 3] };
        let net = polygonise(&sphere, &grid);
        assert!(net.triangles.len() > 300);
        for (p, n) in net.positions.iter().zip(&net.normals) {
            assert!(sphere(*p).abs() < 1e-9, "{p} is off the sphere");
            assert!(n.distance(*p) < 1e-6, "normal {n} at {p}");
        }
    }

    /// Two balls around opposite corners of a face. Seen to catch: a grid that is not settled.
    #[test]
    fn no_edge_joins_four_triangles() {
        let centers = [DVec3::splat(5.0), DVec3::new(6.0, 6.0, 5.0)];
        let balls = |p: DVec3| centers.map(|c| p.distance(c) - 0.6).into_iter().fold(f64::INFINITY, f64::min);
        let grid = Grid { low: DVec3::ZERO, cell: 1.0, cells: [11; 3] };
        let mut values = grid.sample(&balls);
        grid.settle(&mut values);
        let (_, vertex_of) = grid.place_vertices(&values);
        let quads = grid.quads(&values, &vertex_of);
        let edges = quads.iter().flat_map(|quad| (0..4).map(move |k| (quad[k], quad[(k + 1) % 4])));
        let mut seen = std::collections::BTreeSet::new();
        assert!(edges.into_iter().all(|edge| seen.insert(edge)) && !quads.is_empty());
    }
}
