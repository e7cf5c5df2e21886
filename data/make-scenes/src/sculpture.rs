//! Figures that are built of smooth shapes, one operation after another.

use glam::DVec3;

use crate::field::{Shape, smooth_max, smooth_min};

/// One operation: a shape is joined to the figure so far, or cut out of it.
pub struct Stroke {
    effect: Effect,
    shape: Shape,
    /// Width of the fillet, in the unit of the shape.
    blend: f64,
}

#[derive(Clone, Copy)]
enum Effect {
    Join,
    Carve,
}

/// The implicit function of all operations.
pub fn sculpt(strokes: &[Stroke], p: DVec3) -> f64 {
    strokes.iter().fold(f64::INFINITY, |field, stroke| {
        let shape = stroke.shape.distance(p);
        match stroke.effect {
            Effect::Join => smooth_min(field, shape, stroke.blend),
            Effect::Carve => smooth_max(field, -shape, stroke.blend),
        }
    })
}

/// Adds the mirror image of the right half.
pub fn mirrored(p: DVec3) -> DVec3 {
    DVec3::new(p.x.abs(), p.y, p.z)
}

pub const fn join(shape: Shape, blend: f64) -> Stroke {
    Stroke { effect: Effect::Join, shape, blend }
}

pub const fn carve(shape: Shape, blend: f64) -> Stroke {
    Stroke { effect: Effect::Carve, shape, blend }
}

pub const fn blob(center: [f64; 3], radii: [f64; 3]) -> Shape {
    Shape::Ellipsoid { center: DVec3::from_array(center), radii: DVec3::from_array(radii) }
}

pub const fn limb(from: [f64; 3], to: [f64; 3], radii: [f64; 2]) -> Shape {
    Shape::Limb { ends: [DVec3::from_array(from), DVec3::from_array(to)], radii }
}
