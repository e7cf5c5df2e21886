//! note: [choice] Which triangle, and with what density.

use clap::ValueEnum;
use scene::Mesh;

/// The rule that triangles are chosen by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Choice {
    /// In proportion to area.
    Area,
    /// Every triangle alike, as in the note.
    Uniform,
}

impl Choice {
    pub fn name(self) -> &'static str {
        match self {
            Choice::Area => "area",
            Choice::Uniform => "uniform",
        }
    }
}

/// The triangles to choose from.
pub struct TriangleChoice {
    rule: Choice,
    triangles: Vec<u32>,
    /// m².
    areas: Vec<f64>,
    /// Area of each triangle and all before it, m².
    area_so_far: Vec<f64>,
}

impl TriangleChoice {
    /// The triangles of `mesh` that `wanted` accepts by their material.
    pub fn new(mesh: &Mesh, rule: Choice, wanted: impl Fn(u16) -> bool) -> Self {
        let triangles: Vec<u32> =
            (0..mesh.triangles.len()).filter(|k| wanted(mesh.triangles[*k].material)).map(|k| k as u32).collect();
        let areas: Vec<f64> = triangles.iter().map(|k| mesh.area(*k as usize)).collect();
        let mut total = 0.0;
        let add = |area: &f64| {
            total += area;
            total
        };
        let area_so_far = areas.iter().map(add).collect();
        TriangleChoice { rule, triangles, areas, area_so_far }
    }

    /// Area of all triangles, m².
    pub fn area(&self) -> f64 {
        self.area_so_far.last().copied().unwrap_or(0.0)
    }

    /// The triangle that the uniform number `xi` chooses, and note: [pdf] the density `pdf(x)` of a uniform point on it
    /// per area of the whole surface, 1/m² (method.md 6.3): `1/(N A_j)` for the note's rule, `1/A` by area.
    pub fn choose(&self, xi: f64) -> (u32, f64) {
        let last = self.triangles.len() - 1;
        match self.rule {
            Choice::Uniform => {
                let j = ((xi * self.triangles.len() as f64) as usize).min(last);
                (self.triangles[j], 1.0 / (self.triangles.len() as f64 * self.areas[j]))
            }
            Choice::Area => {
                let j = self.area_so_far.partition_point(|a| *a <= xi * self.area()).min(last);
                (self.triangles[j], 1.0 / self.area())
            }
        }
    }
}
