//! The inside of a mesh.

use crate::{
    boundary::{Boundary, Meeting},
    clearance::Clearance,
    domain::{Crossing, Domain, Flight, Leg},
    random::Sequence,
    walk::Start,
};
use glam::DVec3;
use scene::{Mesh, NormalKind, Rays, SurfacePoint};

/// What the surface of a material is to the walks in a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// It bounds the medium.
    Boundary,
    /// It bounds another medium, and is passed straight.
    Other,
    Opaque,
}

/// The space inside the triangles of one material.
pub struct Solid<'a> {
    mesh: &'a Mesh,
    rays: &'a Rays<'a>,
    /// By material.
    kinds: Vec<Kind>,
    clearance: Clearance,
    /// The box around the triangles of the material, m.
    bounds: [DVec3; 2],
    /// A short distance beyond the rounding of positions, m.
    nudge: f64,
}

/// A walk goes on this share of the mesh's diagonal beyond a surface that it passes straight, and a triangle is looked
/// for this far from a sample. Positions are rounded to float32.
const NUDGE: f64 = 1e-6;

impl<'a> Solid<'a> {
    /// The inside of the surface of `material`; none if no triangle has it. Triangles of materials that are not
    /// `translucent` are opaque.
    pub fn new(
        mesh: &'a Mesh,
        rays: &'a Rays<'a>,
        material: u16,
        translucent: impl Fn(u16) -> bool,
    ) -> Option<Solid<'a>> {
        let own = |k: &usize| mesh.triangles[*k].material == material;
        let points = (0..mesh.triangles.len()).filter(own).flat_map(|k| mesh.corners(k));
        let bounds = points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[l, h], p| [l.min(p), h.max(p)]);
        if bounds[0].x > bounds[1].x {
            return None;
        }
        let materials = mesh.triangles.iter().map(|t| t.material).max().map_or(0, |last| last + 1);
        let kind = |index: u16| match index {
            _ if index == material => Kind::Boundary,
            _ if translucent(index) => Kind::Other,
            _ => Kind::Opaque,
        };
        let clearance = Clearance::new(bounds, mesh.triangles.len(), |k| mesh.corners(k));
        let kinds = (0..materials).map(kind).collect();
        Some(Solid { mesh, rays, kinds, clearance, bounds, nudge: NUDGE * mesh.diagonal() })
    }

    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The box around the boundary, m.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// The triangles of the boundary.
    pub fn triangles(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.mesh.triangles.len() as u32).filter(|k| self.kind(*k) == Kind::Boundary)
    }

    /// Whether light passes straight along a part of its way inside.
    pub(crate) fn is_clear(&self, leg: &Leg, nesting: u32) -> bool {
        let Leg { start: position, from, direction, length } = *leg;
        let mut flight = Flight { position, direction, from, nesting };
        self.rays.visible(position, direction, length, from)
            || matches!(self.crossing(&mut flight, length * (1.0 - 1e-9)), Crossing::Free)
    }

    /// Whether a light is visible from a point of the boundary.
    pub(crate) fn is_lit(&self, triangle: u32, weights: [f64; 3], direction: DVec3, distance: f64) -> bool {
        let [a, b, c] = self.mesh.corners(triangle as usize);
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        self.rays.visible(position, direction, distance, Some(triangle))
    }

    fn kind(&self, triangle: u32) -> Kind {
        self.kinds[usize::from(self.mesh.triangles[triangle as usize].material)]
    }

    /// The triangle of the boundary that a point lies on, whose normal is on the side of `normal`. The point may be
    /// rounded to float32; none if no such triangle is near.
    pub fn triangle_at(&self, position: DVec3, normal: DVec3) -> Option<u32> {
        // At an edge, rounding may put the point beside its triangle, so that rays beside it are tried too.
        let (x, y) = normal.any_orthonormal_pair();
        let beside = [DVec3::ZERO, x, -x, y, -y].map(|offset| position + offset * (0.25 * self.nudge));
        beside.into_iter().find_map(|point| self.triangle_below(point, normal))
    }

    fn triangle_below(&self, point: DVec3, normal: DVec3) -> Option<u32> {
        let (mut origin, mut from, mut left) = (point + normal * self.nudge, None, 2.0 * self.nudge);
        while let Some(hit) = self.rays.closest_within(origin, -normal, left, from) {
            let on_its_side = self.point(hit.triangle, hit.weights).geometric_normal.dot(normal) > 0.0;
            if on_its_side && self.kind(hit.triangle) == Kind::Boundary {
                return Some(hit.triangle);
            }
            // Each ray is shorter by a hundredth of the first at least, so that there are few.
            let step = hit.distance + 0.02 * self.nudge;
            (origin, from, left) = (origin - normal * step, Some(hit.triangle), left - step);
        }
        None
    }

    /// Whether a point of the boundary lies inside another closed part of it, where overlapping parts fill their union: no
    /// light leaves there. `normal` is that of the point's triangle.
    pub fn is_buried(&self, position: DVec3, normal: DVec3) -> bool {
        let (mut origin, mut left) = (position + normal * self.nudge, 0);
        while let Some(hit) = self.rays.closest(origin, normal, None) {
            if self.kind(hit.triangle) == Kind::Boundary {
                let leaves = self.point(hit.triangle, hit.weights).geometric_normal.dot(normal) > 0.0;
                left += if leaves { 1 } else { -1 };
            }
            origin += normal * (hit.distance + self.nudge);
        }
        left > 0
    }

    /// Where the walk begins of light that arrives at a point of the boundary from `towards_light` and is refracted by
    /// `normal`, which may be interpolated; by the triangle's own where that would lead out of the medium
    /// (docs/method.md 14.1). None if there is no triangle, or it faces away from the light.
    pub fn enter(
        &self,
        boundary: &impl Boundary,
        position: DVec3,
        [normal, towards_light]: [DVec3; 2],
        random: &mut Sequence,
    ) -> Option<Start> {
        let face = self.triangle_at(position, normal)?;
        let SurfacePoint { position: corner, geometric_normal, .. } = self.point(face, [1.0, 0.0, 0.0]);
        let height = (position - corner).dot(geometric_normal);
        let position = position - geometric_normal * height;
        let meeting = Meeting { position, face, normal, direction: -towards_light };
        let direction = entered(boundary, &meeting, geometric_normal, random)?;
        Some(Start { position, direction, face: Some(face) })
    }

    fn point(&self, triangle: u32, weights: [f64; 3]) -> SurfacePoint {
        self.mesh.point(triangle, weights, NormalKind::Geometric)
    }

    /// Whether a point is outside the box around the boundary, by more than rounding.
    fn is_outside(&self, position: DVec3) -> bool {
        let [low, high] = self.bounds;
        position.cmplt(low - self.nudge).any() || position.cmpgt(high + self.nudge).any()
    }
}

/// The direction of light that enters by the normal of the meeting, or by that of the triangle where this would lead out of
/// the medium.
pub fn entered(
    boundary: &impl Boundary,
    meeting: &Meeting,
    geometric_normal: DVec3,
    random: &mut Sequence,
) -> Option<DVec3> {
    let below = |direction: &DVec3| direction.dot(geometric_normal) < 0.0;
    let first = boundary.enter(meeting, random).filter(below);
    first.or_else(|| boundary.enter(&Meeting { normal: geometric_normal, ..*meeting }, random))
}

impl Domain for Solid<'_> {
    #[inline(always)]
    fn clearance(&self, position: DVec3) -> f64 {
        self.clearance.at(position)
    }

    fn crossing(&self, flight: &mut Flight, limit: f64) -> Crossing {
        let (mut passed, mut origin, mut from) = (0.0, flight.position, flight.from);
        while let Some(hit) = self.rays.closest_within(origin, flight.direction, limit - passed, from) {
            let normal = self.point(hit.triangle, hit.weights).geometric_normal;
            let inside = flight.direction.dot(normal) > 0.0;
            match self.kind(hit.triangle) {
                Kind::Opaque => return Crossing::Opaque,
                Kind::Other => {}
                Kind::Boundary if inside && flight.nesting == 0 => {
                    return Crossing::Boundary { distance: passed + hit.distance, face: hit.triangle, normal };
                }
                Kind::Boundary if inside => flight.nesting -= 1,
                Kind::Boundary => flight.nesting += 1,
            }
            // Two triangles at the same point of the ray would send it back and forth.
            passed += hit.distance + self.nudge;
            if passed >= limit {
                break;
            }
            (origin, from) = (flight.position + flight.direction * passed, None);
        }
        if self.is_outside(flight.position + flight.direction * limit) { Crossing::Hole } else { Crossing::Free }
    }
}
