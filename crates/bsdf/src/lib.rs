//! What happens to light at a surface: which share of it is reflected and which transmitted, and where it goes.
//!
//! [`Bsdf`] is the contract between a surface and a path tracer. [`SmoothDielectric`], [`RoughDielectric`],
//! [`Lambertian`], [`Gloss`] and [`ThinWall`] implement it, and [`Surface`] is one of them, as the scene decides. The BSSRDF describes
//! what happens *below* the surface; this crate does not depend on it. The crate has no I/O and no random numbers, and
//! allocates nothing but the tables of rough surfaces, before they are asked.
//!
//! ```
//! use bsdf::{Bsdf, DVec3, Lobe, Side, Surface, View};
//!
//! let glass = Surface::dielectric(1.5);
//! let view = View { normal: DVec3::Z, direction: DVec3::new(0.6, 0.0, 0.8), side: Side::Outside };
//! let transmitted = glass.transmittance(&view);
//! assert!((transmitted - 0.9561).abs() < 1e-4);
//!
//! // A smooth dielectric has one direction in each lobe, for which no random number is needed.
//! let refracted = glass.sample(&view, Lobe::Transmission, || unreachable!()).expect("no total reflection");
//! assert!((refracted.direction.x + 0.6 / 1.5).abs() < 1e-12);
//! ```

mod dielectric;
mod frame;
pub mod fresnel;
mod ggx;
mod gloss;
mod grid;
mod lambertian;
mod rough;
mod thin_wall;

pub use dielectric::SmoothDielectric;
pub use ggx::SMOOTH_BELOW;
pub use glam::DVec3;
pub use gloss::{Gloss, Schlick, Stated};
pub use lambertian::Lambertian;
pub use rough::{RoughBoundary, RoughDielectric};
pub use thin_wall::ThinWall;

/// A side of a surface. Normals of closed meshes point outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Outside,
    Inside,
}

/// A surface point as it is seen.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Unit normal on the side that the point is seen from.
    pub normal: DVec3,
    /// `ω_o`: unit direction towards the viewer, at a cosine above 0 from the normal.
    pub direction: DVec3,
    /// The side that the point is seen from.
    pub side: Side,
}

/// The part of the light towards the viewer that comes from one side of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// The light comes from the viewer's side.
    Reflection,
    /// The light comes from the other side.
    Transmission,
}

/// A direction that a path goes on in.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// `ω_i`: unit direction towards the light, away from the surface.
    pub direction: DVec3,
    /// `f |cos θ_i| / pdf` for each color channel, divided by the share of the lobe; no unit. `pdf` is the density
    /// within the lobe: the caller chooses the lobe and accounts for that choice.
    pub weight: DVec3,
}

/// How a surface scatters light towards a viewer.
///
/// All directions point away from the surface, and all shares are those of the light towards the viewer. A path chooses
/// a lobe with the probability of its share, [`Bsdf::transmittance`] or one minus that, or follows both with the shares
/// as weights; then it asks [`Bsdf::sample`] for a direction.
///
/// *Adjoint factors:* radiance changes by the square of the relative index wherever it crosses a dielectric. As light
/// and viewer are both outside, the factors of a path cancel, and implementations leave them out (docs/method.md 6.9):
/// flux that falls in and radiance that is seen have the same weights. Nor is there a correction for interpolated
/// normals.
pub trait Bsdf {
    /// `T(ω_o)`: the share of the transmission lobe, from 0 to 1; the transmittance `T21` if the view is from outside.
    /// The light that a BSSRDF sends to the surface from below is seen with this weight.
    fn transmittance(&self, view: &View) -> f64;

    /// True if each lobe is a delta distribution, whose one direction only [`Bsdf::sample`] returns.
    fn is_specular(&self) -> bool;

    /// `f(ω_i, ω_o)` for light from `towards_light` and each color channel, without the cosine, 1/sr; 0 for specular
    /// surfaces.
    fn evaluate(&self, view: &View, towards_light: DVec3) -> DVec3;

    /// Density with which [`Bsdf::sample`] draws this direction, given the lobe on whose side it lies, 1/sr; 0 for
    /// specular surfaces.
    fn density(&self, view: &View, towards_light: DVec3) -> f64;

    /// Samples a direction of one lobe; none if the lobe is empty. Each call of `xi` returns two uniform numbers in
    /// [0, 1); those of the first call choose the direction, and are best spread evenly.
    fn sample(&self, view: &View, lobe: Lobe, xi: impl FnMut() -> [f64; 2]) -> Option<Sample>;
}

/// The BSDFs that a scene may ask for.
#[derive(Clone, Copy, Debug)]
pub enum Surface<'a> {
    SmoothDielectric(SmoothDielectric),
    RoughDielectric(RoughDielectric<'a>),
    Lambertian(Lambertian),
    Gloss(Gloss),
    ThinWall(ThinWall),
}

impl Surface<'_> {
    /// The surface of a translucent material whose medium has the relative index `eta`, inside over outside.
    pub fn dielectric(eta: f64) -> Surface<'static> {
        Surface::SmoothDielectric(SmoothDielectric::new(eta))
    }

    /// The surface of an opaque material that reflects the share `albedo` of each color channel.
    pub fn opaque(albedo: DVec3) -> Surface<'static> {
        Surface::Lambertian(Lambertian { albedo })
    }
}

/// Calls a method of the BSDF that a [`Surface`] holds.
macro_rules! ask {
    ($surface:expr, $method:ident($($argument:expr),*)) => {
        match $surface {
            Surface::SmoothDielectric(bsdf) => bsdf.$method($($argument),*),
            Surface::RoughDielectric(bsdf) => bsdf.$method($($argument),*),
            Surface::Lambertian(bsdf) => bsdf.$method($($argument),*),
            Surface::Gloss(bsdf) => bsdf.$method($($argument),*),
            Surface::ThinWall(bsdf) => bsdf.$method($($argument),*),
        }
    };
}

impl Bsdf for Surface<'_> {
    fn transmittance(&self, view: &View) -> f64 {
        ask!(self, transmittance(view))
    }

    fn is_specular(&self) -> bool {
        ask!(self, is_specular())
    }

    fn evaluate(&self, view: &View, towards_light: DVec3) -> DVec3 {
        ask!(self, evaluate(view, towards_light))
    }

    fn density(&self, view: &View, towards_light: DVec3) -> f64 {
        ask!(self, density(view, towards_light))
    }

    fn sample(&self, view: &View, lobe: Lobe, xi: impl FnMut() -> [f64; 2]) -> Option<Sample> {
        ask!(self, sample(view, lobe, xi))
    }
}
