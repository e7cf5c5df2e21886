//! note: [choice] Which triangle, and with what density.

use crate::{
    hilbert,
    ribbon::{Link, Part, ribbons},
};
pub use formats::cloud::Choice;
use scene::{Mesh, random::BELOW_ONE, warp};

/// A triangle that was chosen.
pub struct Chosen {
    pub triangle: u32,
    /// note: [pdf] Density `pdf(x)` of a uniform point on it per area of the whole surface, 1/m² (method.md 6.3):
    /// `1/(N A_j)` for the note's rule, `1/A` by area.
    pub pdf_area: f64,
}

/// The triangles to choose from, on ribbons that follow a curve that fills space.
pub struct TriangleChoice {
    rule: Choice,
    links: Vec<Link>,
    /// m².
    areas: Vec<f64>,
    /// For each triangle, what a share of its material multiplies its own by; none without such shares.
    factors: Vec<f64>,
    /// Sum of [`Self::share`] of each triangle and all before it.
    shares_so_far: Vec<f64>,
}

impl TriangleChoice {
    /// The triangles of `mesh` that `wanted` accepts by their material.
    pub fn new(mesh: &Mesh, rule: Choice, wanted: impl Fn(u16) -> bool) -> Self {
        TriangleChoice::with_shares(mesh, rule, wanted, &[])
    }

    /// The same; triangles of the materials in `shares` are chosen with these probabilities in all, those of the others
    /// with what is left.
    pub fn with_shares(mesh: &Mesh, rule: Choice, wanted: impl Fn(u16) -> bool, shares: &[(u16, f64)]) -> Self {
        let mut triangles: Vec<u32> =
            (0..mesh.triangles.len()).filter(|k| wanted(mesh.triangles[*k].material)).map(|k| k as u32).collect();
        hilbert::sort(mesh, &mut triangles);
        let links = ribbons(mesh, &triangles);
        let areas: Vec<f64> = links.iter().map(|link| mesh.area(link.triangle as usize)).collect();
        let mut choice = TriangleChoice { rule, links, areas, factors: Vec::new(), shares_so_far: Vec::new() };
        choice.factors = choice.factors(mesh, shares);
        let mut total = 0.0;
        for k in 0..choice.links.len() {
            total += choice.share(k);
            choice.shares_so_far.push(total);
        }
        choice
    }

    /// Area of all triangles, m².
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// [`Self::factors`] that give each of these materials its share.
    fn factors(&self, mesh: &Mesh, shares: &[(u16, f64)]) -> Vec<f64> {
        if shares.is_empty() {
            return Vec::new();
        }
        let group = |link: &Link| {
            let material = mesh.triangles[link.triangle as usize].material;
            shares.iter().position(|(m, _)| *m == material).unwrap_or(shares.len())
        };
        let mut totals = vec![0.0; shares.len() + 1];
        self.links.iter().enumerate().for_each(|(k, link)| totals[group(link)] += self.share(k));
        let rest = 1.0 - shares.iter().map(|(_, share)| share).sum::<f64>();
        let share = |k: usize| shares.get(k).map_or(rest, |(_, share)| *share);
        self.links.iter().map(group).map(|k| share(k) / totals[k]).collect()
    }

    /// What the probability of a triangle is proportional to.
    fn share(&self, place: usize) -> f64 {
        let own = match self.rule {
            Choice::Area => self.areas[place],
            Choice::Uniform => 1.0,
        };
        own * self.factor(place)
    }

    fn factor(&self, place: usize) -> f64 {
        self.factors.get(place).copied().unwrap_or(1.0)
    }

    /// Place of the triangle that the uniform number `xi` chooses, and the share up to there that it stands for.
    fn find(&self, xi: f64) -> (usize, f64) {
        let target = xi * self.shares_so_far.last().copied().unwrap_or(0.0);
        let place = self.shares_so_far.partition_point(|share| *share <= target);
        (place.min(self.links.len() - 1), target)
    }

    fn chosen(&self, place: usize) -> Chosen {
        let total = self.shares_so_far.last().copied().unwrap_or(0.0);
        let pdf_area = match self.rule {
            Choice::Area => 1.0 / total,
            Choice::Uniform => 1.0 / (total * self.areas[place]),
        };
        let pdf_area = pdf_area * self.factor(place);
        Chosen { triangle: self.links[place].triangle, pdf_area }
    }

    /// The triangle that the uniform number `xi` chooses.
    pub fn choose(&self, xi: f64) -> Chosen {
        self.chosen(self.find(xi).0)
    }

    /// The point at `along` of the ribbons and at `across` of their width, both in [0, 1): triangle and barycentric
    /// weights. Uniform numbers make uniform points of triangles that the rule chose; what is near in both is near on
    /// the surface.
    pub fn on_ribbon(&self, along: f64, across: f64) -> (Chosen, [f64; 3]) {
        let (place, target) = self.find(along);
        let first = place - usize::from(self.links[place].part == Part::Second);
        let second = match self.links[first].part {
            Part::First => self.share(first + 1),
            _ => 0.0,
        };
        let shares = [self.share(first), second];
        let before = if first == 0 { 0.0 } else { self.shares_so_far[first - 1] };
        let within = ((target - before) / (shares[0] + shares[1])).clamp(0.0, BELOW_ONE);
        let across = if self.links[first].mirrored { BELOW_ONE - across } else { across };
        let ([x, y], beyond) = warp::halved_square([within, across], shares);
        let place = first + usize::from(beyond);
        let own = if beyond { [x + y - 1.0, 1.0 - y, 1.0 - x] } else { [1.0 - x - y, x, y] };
        let mut weights = [0.0; 3];
        for (corner, weight) in self.links[place].corners.into_iter().zip(own) {
            weights[corner as usize] = weight.max(0.0);
        }
        (self.chosen(place), weights)
    }
}
