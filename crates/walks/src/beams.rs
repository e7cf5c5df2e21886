//! The light of one delta distribution below a mesh, unscattered: what walks are connected to.
//!
//! A smooth boundary sends delta light to a point in its medium along a finite number of ways: through a triangle, or
//! through one and then reflected by others. A path tracer's walk never meets them; here every one is found
//! (docs/method.md 14.8 to 14.10).

use crate::{
    cells::Cells,
    domain::Leg,
    facet::{Facet, Parallel, Shadow, meets},
    reflections::{self, MAX_REFLECTIONS, Medium},
    refraction::{Plane, crossing, gain},
    solid::Solid,
};
use bsdf::fresnel;
use glam::DVec3;
use scene::{
    Mesh, NormalKind,
    light::{Delta, Light},
};

/// Mean free paths within which light is followed: of what enters, e⁻¹² = 6·10⁻⁶ goes farther without a collision.
const REACH: f64 = 12.0;

/// The light of a point or a direction, below the triangles that it reaches.
pub struct Beams<'a> {
    light: &'a dyn Light,
    delta: Delta,
    eta: f64,
    facets: Vec<Facet>,
    /// One of each facet.
    shadows: Vec<Shadow>,
    cells: Cells,
    /// The mean of the fluence just below the lit triangles, by area, W/m²: what connections are measured by.
    pub typical: DVec3,
    /// Whether it contains the beams that the boundary reflects inside. It does not if there are too many, nor for the
    /// light of a point, whose reflections are not followed.
    pub complete: bool,
}

/// Light that arrives at a point inside.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    legs: [Leg; MAX_REFLECTIONS + 1],
    count: usize,
    /// The length of all legs, m.
    pub distance: f64,
    /// Fluence, W/m², without extinction and without shadows.
    pub fluence: DVec3,
    /// Where it crosses the boundary.
    pub triangle: u32,
    pub weights: [f64; 3],
    /// Unit direction towards the light, outside, and the distance of the light, m.
    pub outside: (DVec3, f64),
}

impl Arrival {
    /// The way inside, from the point to the boundary.
    pub fn legs(&self) -> &[Leg] {
        &self.legs[..self.count]
    }
}

impl<'a> Beams<'a> {
    /// The light below a solid's boundary; none if it is no delta distribution, or reaches no triangle. `extinction` is
    /// the least of the channels, 1/m.
    pub fn new(solid: &Solid, light: &'a dyn Light, eta: f64, extinction: f64) -> Option<Beams<'a>> {
        let delta = light.delta()?;
        let mesh = solid.mesh();
        let mut facets: Vec<Facet> = solid.triangles().filter_map(|k| facet(mesh, light, k, eta)).collect();
        if facets.is_empty() {
            return None;
        }
        let [low, high] = solid.bounds();
        let extent = (high - low).length();
        let reach = (REACH / extinction).min(extent);
        let area = |f: &Facet| mesh.area(f.triangle as usize);
        let total: f64 = facets.iter().map(area).sum();
        let typical = facets.iter().map(|f| f.fluence * area(f)).sum::<DVec3>() / total;
        // Cells about as large as the triangles hold few beams, and there are few of them.
        let edge = (total / facets.len() as f64).sqrt().max(reach / 64.0);
        let medium = Medium { eta, extinction, reach, typical: typical.element_sum() };
        let parallel = matches!(delta, Delta::Direction(_));
        let complete = parallel && reflections::add(solid, &medium, &mut facets);
        let shadows = facets.iter().map(|f| Shadow::new(&f.parallel, extent, reach * f.turn)).collect();
        let prism = |k: usize| reflections::prism(solid, &facets[k], reach);
        let cells = Cells::new([low, high], edge, facets.len(), prism);
        Some(Beams { light, delta, eta, facets, shadows, cells, typical, complete })
    }

    /// Whether the light comes from one direction.
    pub fn is_parallel(&self) -> bool {
        matches!(self.delta, Delta::Direction(_))
    }

    /// Calls `found` with every way in which the light may arrive at a point inside, shadows aside.
    #[inline(always)]
    pub fn each_at(&self, mesh: &Mesh, position: DVec3, mut found: impl FnMut(&Arrival)) {
        for k in self.cells.at(position) {
            if self.shadows[*k as usize].misses(position) {
                continue;
            }
            if let Some(arrival) = self.through(mesh, &self.facets[*k as usize], position) {
                found(&arrival);
            }
        }
    }

    fn through(&self, mesh: &Mesh, facet: &Facet, position: DVec3) -> Option<Arrival> {
        match self.delta {
            Delta::Direction(towards) => {
                let mut way = Way::default();
                let (mut facet, mut at, fluence) = (facet, position, facet.fluence);
                loop {
                    let (length, weights) = facet.parallel.meets(at)?;
                    way.push(at, -facet.direction, length, facet.triangle);
                    at -= facet.direction * length;
                    match facet.parent {
                        Some(parent) => facet = &self.facets[parent as usize],
                        None => return Some(way.arrival(fluence, weights, (towards, f64::INFINITY))),
                    }
                }
            }
            Delta::Point(point) => self.of_point(mesh, facet, position, point),
        }
    }

    /// The way of a point's light through one triangle.
    fn of_point(&self, mesh: &Mesh, facet: &Facet, position: DVec3, point: DVec3) -> Option<Arrival> {
        let corners = mesh.corners(facet.triangle as usize);
        let normal = mesh.point(facet.triangle, [1.0, 0.0, 0.0], NormalKind::Geometric).geometric_normal;
        let crossing = crossing(Plane { point: corners[0], normal }, point, position, self.eta)?;
        let direction = (crossing - position).try_normalize()?;
        let (length, weights) = meets(position, direction, corners)?;
        let at = mesh.point(facet.triangle, weights, NormalKind::Geometric);
        let light = self.light.illuminate(&at, [0.0; 2])?;
        let gain = gain(normal.dot(light.direction), normal.dot(direction), light.distance, length, self.eta);
        let mut way = Way::default();
        way.push(position, direction, length, facet.triangle);
        Some(way.arrival(light.irradiance * gain, weights, (light.direction, light.distance)))
    }
}

/// The legs of a way, as they are found from the target to the light.
#[derive(Default)]
struct Way {
    legs: [Leg; MAX_REFLECTIONS + 1],
    count: usize,
    distance: f64,
    /// The triangle that the last leg ends on.
    triangle: Option<u32>,
}

impl Way {
    #[inline(always)]
    fn push(&mut self, start: DVec3, direction: DVec3, length: f64, triangle: u32) {
        self.legs[self.count] = Leg { start, from: self.triangle, direction, length };
        (self.count, self.triangle) = (self.count + 1, Some(triangle));
        self.distance += length;
    }

    #[inline(always)]
    fn arrival(self, fluence: DVec3, weights: [f64; 3], outside: (DVec3, f64)) -> Arrival {
        let Way { legs, count, distance, triangle } = self;
        Arrival { legs, count, distance, fluence, triangle: triangle.unwrap_or_default(), weights, outside }
    }
}

/// A triangle with the light below it; none if the light does not enter it.
fn facet(mesh: &Mesh, light: &dyn Light, triangle: u32, eta: f64) -> Option<Facet> {
    let middle = mesh.point(triangle, [1.0 / 3.0; 3], NormalKind::Geometric);
    let normal = middle.geometric_normal;
    let corners = mesh.corners(triangle as usize);
    let (towards, turn) = match light.delta()? {
        Delta::Direction(towards) => (towards, 0.0),
        Delta::Point(point) => {
            let radius = corners.iter().map(|c| c.distance(middle.position)).fold(0.0, f64::max);
            let distance = point.distance(middle.position);
            // Between the middle and any other point, the direction of the light turns by at most this angle; and
            // refraction into a denser medium turns it less.
            let turn = radius / (distance - radius).max(0.5 * radius);
            ((point - middle.position).try_normalize()?, if eta >= 1.0 { turn.min(2.0) } else { 2.0 })
        }
    };
    if normal.dot(towards) <= 0.0 {
        return None;
    }
    // An index below 1 may reflect all light in the middle, and a spot miss it, but not all of the triangle.
    let direction = fresnel::enter(normal, towards, eta).map_or(-normal, |entry| entry.direction);
    let fluence = light.illuminate(&middle, [0.0; 2]).map_or(DVec3::ZERO, |light| {
        light.irradiance * gain(normal.dot(towards), -normal.dot(direction), f64::INFINITY, 0.0, eta)
    });
    let parallel = Parallel::new(corners, direction);
    Some(Facet { triangle, direction, turn, fluence, depth: 0.0, parent: None, parallel })
}
