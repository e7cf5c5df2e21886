//! The boundary of a medium, as walks meet it.

use crate::random::Sequence;
use bsdf::{Lobe, RoughDielectric, Side, View, fresnel};
use glam::DVec3;

/// A point of the boundary that light meets.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// m.
    pub position: DVec3,
    pub face: u32,
    /// Unit, out of the medium.
    pub normal: DVec3,
    /// Unit, along which the light flies.
    pub direction: DVec3,
}

impl Meeting {
    /// The point as a viewer inside sees it, to whom the walk leads back.
    pub fn view(&self) -> View {
        View { normal: -self.normal, direction: -self.direction, side: Side::Inside }
    }
}

/// Where light goes on that met the boundary from inside: a unit direction.
#[derive(Clone, Copy, Debug)]
pub enum Passage {
    Out(DVec3),
    Back(DVec3),
}

/// What a boundary does with light. It absorbs nothing, and walks have no weights of it.
pub trait Boundary {
    /// Light from inside.
    fn pass(&self, meeting: &Meeting, random: &mut Sequence) -> Passage;

    /// The unit direction of light that enters from outside, by the normal of the meeting; none if none does.
    fn enter(&self, meeting: &Meeting, random: &mut Sequence) -> Option<DVec3>;
}

/// A smooth boundary: Fresnel's equations.
#[derive(Clone, Copy, Debug)]
pub struct Smooth {
    /// Relative index, inside over outside.
    pub eta: f64,
}

impl Boundary for Smooth {
    #[inline(always)]
    fn pass(&self, meeting: &Meeting, random: &mut Sequence) -> Passage {
        let Meeting { direction, normal, .. } = *meeting;
        let transmittance = fresnel::transmittance(direction.dot(normal), 1.0 / self.eta);
        let mirrored = || (direction - 2.0 * direction.dot(normal) * normal).normalize();
        if random.uniform() >= transmittance {
            return Passage::Back(mirrored());
        }
        match fresnel::enter(-normal, -direction, 1.0 / self.eta) {
            Some(left) => Passage::Out(left.direction),
            None => Passage::Back(mirrored()),
        }
    }

    fn enter(&self, meeting: &Meeting, _: &mut Sequence) -> Option<DVec3> {
        fresnel::enter(meeting.normal, -meeting.direction, self.eta).map(|entry| entry.direction)
    }
}

/// A rough boundary, whose surface at a point a function gives.
#[derive(Clone, Copy, Debug)]
pub struct Rough<F>(pub F);

impl<'a, F: Fn(&Meeting) -> RoughDielectric<'a>> Boundary for Rough<F> {
    #[inline(always)]
    fn pass(&self, meeting: &Meeting, random: &mut Sequence) -> Passage {
        match self.0(meeting).scatter(&meeting.view(), || random.uniform()) {
            (Lobe::Transmission, direction) => Passage::Out(direction),
            (Lobe::Reflection, direction) => Passage::Back(direction),
        }
    }

    fn enter(&self, meeting: &Meeting, random: &mut Sequence) -> Option<DVec3> {
        let view = View { normal: meeting.normal, direction: -meeting.direction, side: Side::Outside };
        let is_lit = view.normal.dot(view.direction) > 0.0;
        is_lit.then(|| self.0(meeting).cross(&view, || random.uniform())).flatten()
    }
}
