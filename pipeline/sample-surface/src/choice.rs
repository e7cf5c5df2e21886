//! The choice of a triangle, and its density.
// note: [choice]

use crate::{
    hilbert,
    ribbon::{Link, Part, ribbons},
};
pub use formats::cloud::Choice;
use scene::{Mesh, random::BELOW_ONE, warp};

/// A triangle that was chosen.
pub struct Chosen {
    pub triangle: u32,
    /// Density `pdf(x)` of a uniform point on it per area of the whole surface, 1/m² (docs/method.md 6.3):
    /// `1/(N A_j)` for the note's rule, `1/A` by area.
    // note: [pdf]
    pub pdf_area: f64,
}

/// The triangles to choose from, on ribbons that follow a space-filling curve.
pub struct TriangleChoice {
    rule: Choice,
    links: Vec<Link>,
    /// Area of each triangle, m².
    areas: Vec<f64>,
    /// For each triangle, the factor of its weight that gives its material the wanted share; empty if no material has
    /// one.
    factors: Vec<f64>,
    /// Sum of [`Self::weight`] of each triangle and all before it.
    weights_so_far: Vec<f64>,
}

impl TriangleChoice {
    /// The triangles of `mesh` that `wanted` accepts by their material. Those of each material in `shares` are chosen
    /// with that probability in total, and those of the other materials with what is left.
    pub fn new(mesh: &Mesh, rule: Choice, wanted: impl Fn(u16) -> bool, shares: &[(u16, f64)]) -> Self {
        let mut triangles: Vec<u32> =
            (0..mesh.triangles.len()).filter(|k| wanted(mesh.triangles[*k].material)).map(|k| k as u32).collect();
        hilbert::sort(mesh, &mut triangles);
        let links = ribbons(mesh, &triangles);
        let areas: Vec<f64> = links.iter().map(|link| mesh.area(link.triangle as usize)).collect();
        let mut choice = TriangleChoice { rule, links, areas, factors: Vec::new(), weights_so_far: Vec::new() };
        choice.factors = choice.factors(mesh, shares);
        let mut total = 0.0;
        for k in 0..choice.links.len() {
            total += choice.weight(k);
            choice.weights_so_far.push(total);
        }
        choice
    }

    /// Area of all triangles, m².
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// The factors that give each of these materials its share.
    fn factors(&self, mesh: &Mesh, shares: &[(u16, f64)]) -> Vec<f64> {
        if shares.is_empty() {
            return Vec::new();
        }
        let group = |link: &Link| {
            let material = mesh.triangles[link.triangle as usize].material;
            shares.iter().position(|(m, _)| *m == material).unwrap_or(shares.len())
        };
        let mut totals = vec![0.0; shares.len() + 1];
        self.links.iter().enumerate().for_each(|(k, link)| totals[group(link)] += self.weight(k));
        let rest = 1.0 - shares.iter().map(|(_, share)| share).sum::<f64>();
        let share = |k: usize| shares.get(k).map_or(rest, |(_, share)| *share);
        self.links.iter().map(group).map(|k| share(k) / totals[k]).collect()
    }

    /// What the probability of the triangle at an index of the links is proportional to.
    fn weight(&self, index: usize) -> f64 {
        let own = match self.rule {
            Choice::Area => self.areas[index],
            Choice::Uniform => 1.0,
        };
        own * self.factor(index)
    }

    fn factor(&self, index: usize) -> f64 {
        self.factors.get(index).copied().unwrap_or(1.0)
    }

    /// Index of the triangle that the uniform number `xi` chooses, and `xi` times the sum of all weights.
    fn find(&self, xi: f64) -> (usize, f64) {
        let target = xi * self.weights_so_far.last().copied().unwrap_or(0.0);
        let index = self.weights_so_far.partition_point(|weight| *weight <= target);
        (index.min(self.links.len() - 1), target)
    }

    fn chosen(&self, index: usize) -> Chosen {
        let total = self.weights_so_far.last().copied().unwrap_or(0.0);
        let pdf_area = match self.rule {
            Choice::Area => 1.0 / total,
            Choice::Uniform => 1.0 / (total * self.areas[index]),
        };
        let pdf_area = pdf_area * self.factor(index);
        Chosen { triangle: self.links[index].triangle, pdf_area }
    }

    /// The triangle that the uniform number `xi` chooses.
    pub fn choose(&self, xi: f64) -> Chosen {
        self.chosen(self.find(xi).0)
    }

    /// The point at `along` of the length of the ribbons and at `across` of their width, both in [0, 1): triangle and
    /// barycentric weights. Uniform numbers make uniform points on triangles that the rule chose; points that are close
    /// in both numbers are close on the surface.
    pub fn on_ribbon(&self, along: f64, across: f64) -> (Chosen, [f64; 3]) {
        let (index, target) = self.find(along);
        let first = index - usize::from(self.links[index].part == Part::Second);
        let second = match self.links[first].part {
            Part::First => self.weight(first + 1),
            _ => 0.0,
        };
        let halves = [self.weight(first), second];
        let before = if first == 0 { 0.0 } else { self.weights_so_far[first - 1] };
        let within = ((target - before) / (halves[0] + halves[1])).clamp(0.0, BELOW_ONE);
        let across = if self.links[first].mirrored { BELOW_ONE - across } else { across };
        let ([x, y], beyond) = warp::halved_square([within, across], halves);
        let index = first + usize::from(beyond);
        let own = if beyond { [x + y - 1.0, 1.0 - y, 1.0 - x] } else { [1.0 - x - y, x, y] };
        let mut weights = [0.0; 3];
        for (corner, weight) in self.links[index].corners.into_iter().zip(own) {
            weights[corner as usize] = weight.max(0.0);
        }
        (self.chosen(index), weights)
    }
}
