//! Beams of parallel light that the boundary reflects inside, before they are scattered.

use crate::{
    cells::{Cells, Prism},
    facet::{Facet, Parallel, mirrored},
    solid::Solid,
};
use bsdf::fresnel;
use glam::DVec3;
use rayon::prelude::*;
use scene::NormalKind;

/// Reflections of one beam that are followed.
pub const MAX_REFLECTIONS: usize = 4;

/// A reflected beam is left out if it carries less than this share of the typical fluence.
const NEGLIGIBLE: f64 = 1e-3;

/// Beams in all: each takes 300 bytes.
const MAX_BEAMS: usize = 1 << 20;

/// Beams whose reflections are sought before their number is looked at.
const PORTION: usize = 4096;

/// What reflections depend on.
pub struct Medium {
    pub eta: f64,
    /// Least extinction of the channels, 1/m.
    pub extinction: f64,
    /// How far beams are followed, m.
    pub reach: f64,
    /// Sum of the channels of the typical fluence, W/m².
    pub typical: f64,
}

/// Adds the reflections of beams to them; false if some were left out.
pub fn add(solid: &Solid, medium: &Medium, facets: &mut Vec<Facet>) -> bool {
    let mesh = solid.mesh();
    let triangles: Vec<u32> = solid.triangles().collect();
    let area: f64 = triangles.iter().map(|k| mesh.area(*k as usize)).sum();
    let edge = (area / triangles.len() as f64).sqrt().max(medium.reach / 64.0);
    let [low, high] = solid.bounds();
    let thickness = 1e-9 * (high - low).length();
    let flat = |k: usize| {
        let at = mesh.point(triangles[k], [1.0, 0.0, 0.0], NormalKind::Geometric);
        let corners = mesh.corners(triangles[k] as usize);
        Prism { corners, normal: at.normal, depth: at.normal * thickness, margin: thickness }
    };
    let nearby = Cells::new([low, high], edge, triangles.len(), flat);
    let mut start = 0;
    for _ in 0..MAX_REFLECTIONS {
        let end = facets.len();
        let reflected = |k: usize| {
            let facet = &facets[k];
            let prism = prism(solid, facet, medium.reach);
            let mut found: Vec<u32> = Vec::new();
            nearby.within(&prism, |index| found.push(triangles[index as usize]));
            found.sort_unstable();
            found.dedup();
            found.into_iter().filter_map(move |t| reflection(solid, medium, facet, k as u32, t)).collect::<Vec<_>>()
        };
        let mut new: Vec<Facet> = Vec::new();
        for first in (start..end).step_by(PORTION) {
            let portion = (first..end.min(first + PORTION)).into_par_iter();
            new.par_extend(portion.flat_map_iter(reflected));
            if end + new.len() > MAX_BEAMS {
                return false;
            }
        }
        facets.extend(new);
        start = end;
    }
    true
}

/// The space that the beam of a facet may reach.
pub fn prism(solid: &Solid, facet: &Facet, reach: f64) -> Prism {
    let corners = solid.mesh().corners(facet.triangle as usize);
    let normal = solid.mesh().point(facet.triangle, [1.0, 0.0, 0.0], NormalKind::Geometric).normal;
    Prism { corners, normal, depth: facet.direction * reach, margin: reach * facet.turn }
}

/// The beam of a facet after its reflection by a triangle; none if they do not meet, or hardly any light is left.
fn reflection(solid: &Solid, medium: &Medium, facet: &Facet, index: u32, triangle: u32) -> Option<Facet> {
    if triangle == facet.triangle {
        return None;
    }
    let mesh = solid.mesh();
    let normal = mesh.point(triangle, [1.0, 0.0, 0.0], NormalKind::Geometric).normal;
    let cosine = facet.direction.dot(normal);
    let (from, to) = (mesh.corners(facet.triangle as usize), mesh.corners(triangle as usize));
    if cosine <= 0.0 || !overlap(&from, &to, facet.direction) {
        return None;
    }
    let distances = to.map(|corner| facet.parallel.distance(corner));
    if distances.iter().all(|distance| *distance <= 0.0) {
        return None;
    }
    let depth = facet.depth + distances.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
    let fluence = facet.fluence * (1.0 - fresnel::transmittance(cosine, 1.0 / medium.eta));
    let left = fluence.element_sum() * (-medium.extinction * depth).exp();
    if depth > medium.reach || left < NEGLIGIBLE * medium.typical {
        return None;
    }
    let direction = mirrored(facet.direction, normal).normalize();
    let parallel = Parallel::new(to, direction);
    Some(Facet { triangle, direction, turn: 0.0, fluence, depth, parent: Some(index), parallel })
}

/// Whether two triangles overlap by more than rounding, as seen along a direction.
fn overlap(one: &[DVec3; 3], two: &[DVec3; 3], direction: DVec3) -> bool {
    let separates = |k: usize, triangle: &[DVec3; 3]| {
        let axis = (triangle[(k + 1) % 3] - triangle[k]).cross(direction).normalize_or_zero();
        let range = |t: &[DVec3; 3]| {
            let along = t.map(|p| axis.dot(p - triangle[k]));
            (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]))
        };
        let ((a, b), (c, d)) = (range(one), range(two));
        let rounding = 1e-9 * (b - a + d - c);
        c > b - rounding || a > d - rounding
    };
    !(0..3).any(|k| separates(k, one) || separates(k, two))
}
