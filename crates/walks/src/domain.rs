//! The space that a medium fills, as walks see it; half-spaces and slabs.

use glam::DVec3;

/// A walk between two events.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// m.
    pub position: DVec3,
    /// Unit.
    pub direction: DVec3,
    /// The face that the walk starts on.
    pub from: Option<u32>,
    /// How many more surfaces of the same medium were crossed inwards than outwards since the walk began: where closed
    /// surfaces overlap, the medium fills their union.
    pub nesting: u32,
}

/// A straight part of the way to the light, inside.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leg {
    /// Where it begins, m, and the triangle there.
    pub start: DVec3,
    pub from: Option<u32>,
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// m.
    pub length: f64,
}

/// What a walk meets next.
#[derive(Clone, Copy, Debug)]
pub enum Crossing {
    /// No boundary within the distance that was asked for.
    Free,
    /// The boundary of the medium.
    Boundary {
        /// m, from the start of the flight.
        distance: f64,
        face: u32,
        /// Unit, pointing out of the medium.
        normal: DVec3,
    },
    /// An opaque surface inside the medium.
    Opaque,
    /// The walk is outside without having met the boundary: the surface has holes.
    Hole,
}

/// A medium's space.
pub trait Domain {
    /// No surface is nearer to `position` than this, m; 0 where nothing is known.
    fn clearance(&self, position: DVec3) -> f64;

    /// What lies along the flight within `limit`, m. Surfaces that are not its boundary may be crossed.
    fn crossing(&self, flight: &mut Flight, limit: f64) -> Crossing;
}

/// A slab `0 ≤ z ≤ thickness` without sides, or a half-space.
#[derive(Clone, Copy, Debug)]
pub struct Slab {
    /// m, may be infinite.
    pub thickness: f64,
}

impl Slab {
    /// The face at `z = 0`, whose normal is −z.
    pub const FRONT: u32 = 0;
    /// The face at `z = thickness`.
    pub const BACK: u32 = 1;
}

impl Domain for Slab {
    #[inline(always)]
    fn clearance(&self, position: DVec3) -> f64 {
        position.z.min(self.thickness - position.z)
    }

    #[inline(always)]
    fn crossing(&self, flight: &mut Flight, limit: f64) -> Crossing {
        let (z, slope) = (flight.position.z, flight.direction.z);
        let (face, depth, normal) =
            if slope < 0.0 { (Slab::FRONT, z, DVec3::NEG_Z) } else { (Slab::BACK, self.thickness - z, DVec3::Z) };
        let distance = depth.max(0.0) / slope.abs();
        // A walk along the faces has a slope of 0 and never meets one.
        if distance < limit { Crossing::Boundary { distance, face, normal } } else { Crossing::Free }
    }
}
