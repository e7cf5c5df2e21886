//! The rough boundary between two dielectrics: microfacets that reflect and refract (Walter et al. 2007).
//!
//! What light loses that would meet several microfacets is given back (Kulla and Conty 2017): reflected and transmitted
//! light add up to 1 (docs/method.md 18.4).

use crate::{
    Bsdf, Lobe, Sample, Side, View,
    frame::{Frame, UNIFORM_DENSITY, uniform_direction},
    fresnel,
    ggx::{Ggx, SMOOTH_BELOW, at_cosine, mean_over_visible},
    grid::{Row, around, lerp},
};
use glam::DVec3;
use std::f64::consts::PI;

mod analog;

/// Intervals of roughness in the tables of a surface whose roughness varies.
const ROUGHNESSES: usize = 16;

/// What one side of a boundary does with light, for one roughness.
#[derive(Clone, Debug)]
struct OneSide {
    /// The share that is reflected once.
    reflected: Row,
    /// The share that meets several microfacets.
    lost: Row,
    /// The cosine beyond the boundary of what is transmitted once, on the mean.
    beyond: Row,
    /// The mean of what is lost over directions of diffuse light, and its mean cosine.
    mean_lost: f64,
    lost_cosine: f64,
    /// The share of what meets several microfacets that is reflected in the end.
    returned: f64,
}

/// The albedos of a boundary, of one roughness or of all.
#[derive(Clone, Debug)]
pub struct RoughBoundary {
    /// Relative index, inside over outside.
    eta: f64,
    /// From outside and from inside, for each roughness.
    sides: Vec<[OneSide; 2]>,
}

impl RoughBoundary {
    /// The boundary of a medium of relative index `eta`, inside over outside, for one `roughness`, whose square is `α`.
    pub fn new(eta: f64, roughness: f64) -> RoughBoundary {
        RoughBoundary { eta, sides: vec![both_sides(eta, roughness)] }
    }

    /// The same for any roughness.
    pub fn of_any_roughness(eta: f64) -> RoughBoundary {
        let of = |k: usize| both_sides(eta, k as f64 / ROUGHNESSES as f64);
        RoughBoundary { eta, sides: (0..=ROUGHNESSES).map(of).collect() }
    }

    /// Relative index, inside over outside.
    pub fn eta(&self) -> f64 {
        self.eta
    }

    /// The two entries that a roughness lies between, and the weight of the second.
    fn around(&self, roughness: f64) -> ([usize; 2], f64) {
        if self.sides.len() == 1 {
            return ([0; 2], 0.0);
        }
        let (k, along) = around(roughness, ROUGHNESSES);
        ([k, k + 1], along)
    }

    /// `T(μ)` of light from outside at this cosine: the share that enters, or of the light towards a viewer outside that
    /// comes from inside.
    pub fn transmittance(&self, cosine: f64, roughness: f64) -> f64 {
        if cosine <= 0.0 {
            return 0.0;
        }
        if roughness * roughness < SMOOTH_BELOW {
            return fresnel::transmittance(cosine, self.eta);
        }
        self.surface(roughness).transmitted(Side::Outside, cosine)
    }

    /// The mean cosine below the boundary of the light that enters from outside at this cosine.
    pub fn refracted_cosine(&self, cosine: f64, roughness: f64) -> f64 {
        let surface = self.surface(roughness);
        let beyond = surface.between(Side::Outside, |one| one.beyond.at(cosine));
        let several = surface.between(Side::Outside, |one| one.lost.at(cosine) * (1.0 - one.returned));
        let several = several / surface.transmitted(Side::Outside, cosine).max(1e-9);
        lerp(beyond, surface.between(Side::Inside, |one| one.lost_cosine), several.clamp(0.0, 1.0))
    }

    /// What happens at a point of this roughness.
    pub fn surface(&self, roughness: f64) -> RoughDielectric<'_> {
        let alpha = (roughness * roughness).max(SMOOTH_BELOW);
        let (entries, along) = self.around(roughness);
        RoughDielectric { ggx: Ggx::new(alpha), boundary: self, entries, along }
    }
}

fn both_sides(eta: f64, roughness: f64) -> [OneSide; 2] {
    let ggx = Ggx::new((roughness * roughness).max(1e-7));
    let of = |ratio: f64| {
        let [reflected, lost, beyond] = Row::of(|cosine| {
            let view = at_cosine(cosine);
            let seen = 1.0 + ggx.lambda(view.z);
            let [reflected, transmitted, along] = mean_over_visible(&ggx, view, |normal| {
                let cosine = view.dot(normal);
                let transmitted = fresnel::transmittance(cosine, ratio);
                let mirrored = 2.0 * cosine * normal - view;
                let kept = if mirrored.z > 0.0 { seen / (seen + ggx.lambda(mirrored.z)) } else { 0.0 };
                let refracted = fresnel::enter(normal, view, ratio).map_or(0.0, |entry| -entry.direction.z);
                let passed = if refracted > 0.0 { ggx.masking(refracted) } else { 0.0 };
                [(1.0 - transmitted) * kept, transmitted * passed, transmitted * passed * refracted]
            });
            [reflected, (1.0 - reflected - transmitted).max(0.0), along / transmitted.max(1e-300)]
        });
        let mean_lost = lost.mean();
        (reflected, lost, mean_lost, beyond)
    };
    let [outer, inner] = [of(eta), of(1.0 / eta)];
    // Both sides pass on the same share of the smaller loss, as much as a smooth boundary of diffuse light: the light
    // from one side to the other is then that of the way back.
    let [smooth] = Row::of(|cosine| [fresnel::transmittance(cosine, eta)]);
    let passed = [smooth.mean(), smooth.mean() / (eta * eta)];
    let least = outer.2.min(inner.2);
    let mut passed = passed.into_iter();
    [outer, inner].map(|(reflected, lost, mean_lost, beyond)| {
        let share = passed.next().unwrap_or_default() * least / mean_lost.max(1e-300);
        let [along] = Row::of(|cosine| [lost.at(cosine) * cosine]);
        let lost_cosine = along.mean() / mean_lost.max(1e-300);
        OneSide { reflected, lost, beyond, mean_lost, lost_cosine, returned: 1.0 - share.min(1.0) }
    })
}

/// A point of a rough boundary. It absorbs nothing.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<'a> {
    ggx: Ggx,
    boundary: &'a RoughBoundary,
    entries: [usize; 2],
    along: f64,
}

impl RoughDielectric<'_> {
    fn between(&self, side: Side, value: impl Fn(&OneSide) -> f64) -> f64 {
        let [a, b] = self.entries.map(|k| value(&self.boundary.sides[k][side as usize]));
        lerp(a, b, self.along)
    }

    /// Index beyond the boundary over the index on this side.
    fn ratio(&self, side: Side) -> f64 {
        if side == Side::Outside { self.boundary.eta } else { 1.0 / self.boundary.eta }
    }

    /// The share of the light towards a viewer that is reflected by one and by several microfacets.
    fn reflected(&self, side: Side, cosine: f64) -> [f64; 2] {
        [
            self.between(side, |one| one.reflected.at(cosine)),
            self.between(side, |one| one.lost.at(cosine)) * self.between(side, |one| one.returned),
        ]
    }

    fn transmitted(&self, side: Side, cosine: f64) -> f64 {
        let [single, several] = self.reflected(side, cosine);
        (1.0 - single - several).clamp(0.0, 1.0)
    }

    /// The share of a lobe, and the share of that which meets one microfacet alone.
    fn shares(&self, view: &View, lobe: Lobe) -> [f64; 2] {
        let cosine = view.normal.dot(view.direction);
        let [single, several] = self.reflected(view.side, cosine);
        let [of_lobe, several] = match lobe {
            Lobe::Reflection => [single + several, several],
            Lobe::Transmission => {
                let lost = self.between(view.side, |one| one.lost.at(cosine));
                [(1.0 - single - several).max(0.0), lost - several]
            }
        };
        [of_lobe, if of_lobe > 0.0 { (1.0 - several / of_lobe).clamp(0.0, 1.0) } else { 1.0 }]
    }

    /// The microfacet that leads from the view to the light, on the viewer's side; none if there is none.
    fn microfacet(&self, view: &View, towards_light: DVec3, lobe: Lobe) -> Option<DVec3> {
        let sum = match lobe {
            Lobe::Reflection => view.direction + towards_light,
            Lobe::Transmission => view.direction + towards_light * self.ratio(view.side),
        };
        let normal = sum.try_normalize()?;
        let normal = if normal.dot(view.normal) < 0.0 { -normal } else { normal };
        let [to_view, to_light] = [view.direction, towards_light].map(|d| normal.dot(d));
        (to_view > 0.0 && (to_light > 0.0) == (lobe == Lobe::Reflection)).then_some(normal)
    }

    /// Density of a direction among those that one visible microfacet leads to, 1/sr.
    fn single_density(&self, view: &View, towards_light: DVec3, normal: DVec3, lobe: Lobe) -> f64 {
        let [to_view, to_light] = [view.direction, towards_light].map(|d| normal.dot(d));
        let cosine = view.normal.dot(view.direction);
        let facing = self.ggx.masking(cosine) * self.ggx.distribution(view.normal.dot(normal)) / cosine;
        match lobe {
            Lobe::Reflection => 0.25 * facing,
            Lobe::Transmission => {
                let ratio = self.ratio(view.side);
                let root = to_view + ratio * to_light;
                facing * to_view * ratio * ratio * -to_light / (root * root)
            }
        }
    }
}

/// The lobe that light of this direction belongs to.
fn lobe_of(view: &View, towards_light: DVec3) -> Lobe {
    if view.normal.dot(towards_light) > 0.0 { Lobe::Reflection } else { Lobe::Transmission }
}

impl Bsdf for RoughDielectric<'_> {
    fn transmittance(&self, view: &View) -> f64 {
        self.transmitted(view.side, view.normal.dot(view.direction))
    }

    fn is_specular(&self) -> bool {
        false
    }

    fn evaluate(&self, view: &View, towards_light: DVec3) -> DVec3 {
        let lobe = lobe_of(view, towards_light);
        let cosines = [view.normal.dot(view.direction), view.normal.dot(towards_light).abs()];
        if cosines[0] <= 0.0 || cosines[1] <= 0.0 {
            return DVec3::ZERO;
        }
        let single = self.microfacet(view, towards_light, lobe).map_or(0.0, |normal| {
            let transmitted = fresnel::transmittance(view.direction.dot(normal), self.ratio(view.side));
            let seen = 1.0 + self.ggx.lambda(cosines[0]);
            let kept = match lobe {
                Lobe::Reflection => (1.0 - transmitted) * seen / (seen + self.ggx.lambda(cosines[1])),
                Lobe::Transmission => transmitted * self.ggx.masking(cosines[1]),
            };
            kept * self.single_density(view, towards_light, normal, lobe) / cosines[1]
        });
        let lost = |side: Side, cosine: f64| self.between(side, |one| one.lost.at(cosine));
        let returned = self.between(view.side, |one| one.returned);
        let (other, share) = match (lobe, view.side) {
            (Lobe::Reflection, side) => (side, returned),
            (Lobe::Transmission, Side::Outside) => (Side::Inside, 1.0 - returned),
            (Lobe::Transmission, Side::Inside) => (Side::Outside, 1.0 - returned),
        };
        let mean = self.between(other, |one| one.mean_lost).max(1e-300);
        let several = share * lost(view.side, cosines[0]) * lost(other, cosines[1]) / (PI * mean);
        DVec3::splat(single + several)
    }

    fn density(&self, view: &View, towards_light: DVec3) -> f64 {
        let lobe = lobe_of(view, towards_light);
        let light = view.normal.dot(towards_light).abs();
        if view.normal.dot(view.direction) <= 0.0 || light <= 0.0 {
            return 0.0;
        }
        let [_, share] = self.shares(view, lobe);
        let facet = self.microfacet(view, towards_light, lobe);
        let single = facet.map_or(0.0, |normal| self.single_density(view, towards_light, normal, lobe));
        share * single + (1.0 - share) * UNIFORM_DENSITY
    }

    fn sample(&self, view: &View, lobe: Lobe, mut xi: impl FnMut() -> [f64; 2]) -> Option<Sample> {
        let [of_lobe, single] = self.shares(view, lobe);
        let frame = Frame::new(view.normal);
        let (xi, [choice, _]) = (xi(), xi());
        let direction = if choice < single {
            let normal = frame.world(self.ggx.sample_visible(frame.local(view.direction), xi)).normalize();
            match lobe {
                Lobe::Reflection => fresnel::reflect(normal, view.direction),
                Lobe::Transmission => fresnel::enter(normal, view.direction, self.ratio(view.side))?.direction,
            }
        } else {
            let direction = frame.world(uniform_direction(xi)).normalize();
            if lobe == Lobe::Reflection { direction } else { -direction }
        };
        if lobe_of(view, direction) != lobe {
            return None;
        }
        let (density, light) = (self.density(view, direction), view.normal.dot(direction).abs());
        let weight = self.evaluate(view, direction) * (light / (density * of_lobe));
        (density > 0.0 && of_lobe > 0.0).then_some(Sample { direction, weight })
    }
}
