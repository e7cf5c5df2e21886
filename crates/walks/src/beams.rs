//! The light of one delta distribution below a mesh, unscattered: what walks are connected to.
//!
//! A smooth boundary sends delta light to a point in its medium along a finite number of directions, one through each
//! triangle that can. A path tracer's walk never meets them; here every one is found (docs/method.md 14.8 to 14.10).

use crate::{
    cells::{Cells, Prism},
    refraction::{Plane, crossing, gain},
    solid::Solid,
};
use bsdf::fresnel;
use glam::DVec3;
use scene::{
    Mesh, NormalKind, SurfacePoint,
    light::{Delta, Light},
};

/// Mean free paths within which light is followed: of what enters, e⁻¹⁶ = 10⁻⁷ goes farther without a collision.
const REACH: f64 = 16.0;

/// The light of a point or a direction, below the triangles that it reaches.
pub struct Beams<'a> {
    light: &'a dyn Light,
    delta: Delta,
    eta: f64,
    facets: Vec<Facet>,
    cells: Cells,
    /// The mean of the fluence just below the facets, by area, W/m²: what connections are measured by.
    pub typical: DVec3,
}

/// A triangle that faces the light.
struct Facet {
    triangle: u32,
    /// Unit direction of the light below it, from its middle for a point.
    direction: DVec3,
    /// The fluence just below it there, W/m².
    fluence: DVec3,
}

/// Light that arrives at a point inside.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Unit direction towards the light, inside.
    pub direction: DVec3,
    /// Distance to the boundary, m.
    pub distance: f64,
    /// Fluence, W/m², without extinction and without shadows.
    pub fluence: DVec3,
    /// Where it crosses the boundary.
    pub entry: SurfacePoint,
    /// Unit direction towards the light, outside, and the distance of the light, m.
    pub outside: (DVec3, f64),
}

impl<'a> Beams<'a> {
    /// The light below a solid's boundary; none if it is no delta distribution, or reaches no triangle. `extinction` is
    /// the least of the channels, 1/m.
    pub fn new(solid: &Solid, light: &'a dyn Light, eta: f64, extinction: f64) -> Option<Beams<'a>> {
        let delta = light.delta()?;
        let mesh = solid.mesh();
        let facets: Vec<Facet> = solid.triangles().filter_map(|k| facet(mesh, light, k, eta)).collect();
        if facets.is_empty() {
            return None;
        }
        let [low, high] = solid.bounds();
        let reach = (REACH / extinction).min((high - low).length());
        let area = |f: &Facet| mesh.area(f.triangle as usize);
        let total: f64 = facets.iter().map(area).sum();
        let typical = facets.iter().map(|f| f.fluence * area(f)).sum::<DVec3>() / total;
        // Cells about as large as the triangles hold few beams, and there are few of them.
        let edge = (total / facets.len() as f64).sqrt().max(reach / 64.0);
        let prism = |k: usize| prism(mesh, &facets[k], delta, eta, reach);
        let cells = Cells::new([low, high], edge, facets.len(), prism);
        Some(Beams { light, delta, eta, facets, cells, typical })
    }

    /// Calls `found` with every way in which the light may arrive at a point inside, shadows aside.
    #[inline(always)]
    pub fn each_at(&self, mesh: &Mesh, position: DVec3, mut found: impl FnMut(&Arrival)) {
        for k in self.cells.at(position) {
            if let Some(arrival) = self.through(mesh, &self.facets[*k as usize], position) {
                found(&arrival);
            }
        }
    }

    fn through(&self, mesh: &Mesh, facet: &Facet, position: DVec3) -> Option<Arrival> {
        let corners = mesh.corners(facet.triangle as usize);
        let point = match self.delta {
            Delta::Direction(towards) => {
                let (distance, weights) = meets(position, -facet.direction, corners)?;
                let entry = mesh.point(facet.triangle, weights, NormalKind::Geometric);
                let (direction, outside) = (-facet.direction, (towards, f64::INFINITY));
                return Some(Arrival { direction, distance, fluence: facet.fluence, entry, outside });
            }
            Delta::Point(point) => point,
        };
        let normal = mesh.point(facet.triangle, [1.0, 0.0, 0.0], NormalKind::Geometric).geometric_normal;
        let crossing = crossing(Plane { point: corners[0], normal }, point, position, self.eta)?;
        let direction = (crossing - position).try_normalize()?;
        let (distance, weights) = meets(position, direction, corners)?;
        let entry = mesh.point(facet.triangle, weights, NormalKind::Geometric);
        let light = self.light.illuminate(&entry, [0.0; 2])?;
        let gain = gain(normal.dot(light.direction), normal.dot(direction), light.distance, distance, self.eta);
        let outside = (light.direction, light.distance);
        Some(Arrival { direction, distance, fluence: light.irradiance * gain, entry, outside })
    }
}

/// A triangle with the light below it; none if the light does not enter it.
fn facet(mesh: &Mesh, light: &dyn Light, triangle: u32, eta: f64) -> Option<Facet> {
    let middle = mesh.point(triangle, [1.0 / 3.0; 3], NormalKind::Geometric);
    let normal = middle.geometric_normal;
    let towards = match light.delta()? {
        Delta::Direction(towards) => towards,
        Delta::Point(point) => (point - middle.position).try_normalize()?,
    };
    if normal.dot(towards) <= 0.0 {
        return None;
    }
    // An index below 1 may reflect all light in the middle, and a spot miss it, but not all of the triangle.
    let direction = fresnel::enter(normal, towards, eta).map_or(-normal, |entry| entry.direction);
    let fluence = light.illuminate(&middle, [0.0; 2]).map_or(DVec3::ZERO, |light| {
        light.irradiance * gain(normal.dot(towards), -normal.dot(direction), f64::INFINITY, 0.0, eta)
    });
    Some(Facet { triangle, direction, fluence })
}

/// The space that the light of a facet may reach.
fn prism(mesh: &Mesh, facet: &Facet, delta: Delta, eta: f64, reach: f64) -> Prism {
    let corners = mesh.corners(facet.triangle as usize);
    let middle = mesh.point(facet.triangle, [1.0 / 3.0; 3], NormalKind::Geometric);
    let radius = corners.iter().map(|c| c.distance(middle.position)).fold(0.0, f64::max);
    let turn = match delta {
        Delta::Direction(_) => 0.0,
        // Between the middle and any other point, the direction of the light turns by at most this angle; refraction
        // into a denser medium turns it less.
        Delta::Point(point) if eta >= 1.0 => radius / (point.distance(middle.position) - radius).max(0.5 * radius),
        Delta::Point(_) => 2.0,
    };
    let margin = reach * f64::min(turn, 2.0);
    Prism { corners, normal: middle.geometric_normal, depth: facet.direction * reach, margin }
}

/// Distance and barycentric weights at which a ray meets a triangle (Möller and Trumbore 1997).
#[inline(always)]
fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let (ab, ac, offset) = (b - a, c - a, origin - a);
    let across = direction.cross(ac);
    let inverse = 1.0 / ab.dot(across);
    let v = offset.dot(across) * inverse;
    let normal = offset.cross(ab);
    let w = direction.dot(normal) * inverse;
    let distance = ac.dot(normal) * inverse;
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance > 0.0).then_some((distance, [1.0 - v - w, v, w]))
}
