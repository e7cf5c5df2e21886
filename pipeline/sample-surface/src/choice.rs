//! note: [choice] Which triangle, and with what density.

use crate::curve;
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

/// A triangle that was chosen.
pub struct Chosen {
    pub triangle: u32,
    /// note: [pdf] Density `pdf(x)` of a uniform point on it per area of the whole surface, 1/m² (method.md 6.3):
    /// `1/(N A_j)` for the note's rule, `1/A` by area.
    pub pdf_area: f64,
    pub probability: f64,
    /// Probability of all triangles before it in the order.
    pub before: f64,
    /// Where in its interval the number lay that chose it: uniform in [0, 1).
    pub rest: f64,
}

/// The triangles to choose from, in the order of a curve that fills space.
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
        let mut triangles: Vec<u32> =
            (0..mesh.triangles.len()).filter(|k| wanted(mesh.triangles[*k].material)).map(|k| k as u32).collect();
        curve::sort(mesh, &mut triangles);
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

    /// The triangle that the uniform number `xi` chooses.
    pub fn choose(&self, xi: f64) -> Chosen {
        let last = self.triangles.len() - 1;
        match self.rule {
            Choice::Uniform => {
                let n = self.triangles.len() as f64;
                let j = ((xi * n) as usize).min(last);
                let rest = (xi * n - j as f64).clamp(0.0, BELOW_ONE);
                let pdf_area = 1.0 / (n * self.areas[j]);
                Chosen { triangle: self.triangles[j], pdf_area, probability: 1.0 / n, before: j as f64 / n, rest }
            }
            Choice::Area => {
                let area = self.area();
                let target = xi * area;
                let j = self.area_so_far.partition_point(|a| *a <= target).min(last);
                let before = if j == 0 { 0.0 } else { self.area_so_far[j - 1] };
                let own = self.area_so_far[j] - before;
                let rest = if own > 0.0 { ((target - before) / own).clamp(0.0, BELOW_ONE) } else { 0.0 };
                let (probability, before) = (own / area, before / area);
                Chosen { triangle: self.triangles[j], pdf_area: 1.0 / area, probability, before, rest }
            }
        }
    }
}

/// The largest number below 1.
pub const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
