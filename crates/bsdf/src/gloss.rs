//! The metallic-roughness model of glTF 2.0 (appendix B): a layer of microfacets that mirror, over a diffuse base.
//!
//! What light loses that would meet several microfacets is given back (Kulla and Conty 2017), and the base gets the
//! light that the layer lets through, both ways: a white surface reflects all light (docs/method.md 18.2, 18.3).

use crate::{
    Bsdf, Lobe, Sample, View,
    frame::{Frame, UNIFORM_DENSITY, uniform_direction},
    fresnel,
    ggx::{Ggx, SMOOTH_BELOW, at_cosine, mean_over_visible},
    grid::{Row, around, lerp},
};
use glam::DVec3;
use std::{f64::consts::PI, sync::LazyLock};

/// Intervals of roughness in the tables.
const ROUGHNESSES: usize = 64;

/// The albedo of single reflections for one roughness.
struct Albedo {
    /// `E(μ)` of microfacets that reflect everything.
    all: Row,
    /// The same of microfacets that reflect `(1 − h·ω)⁵`, the slanted part of Schlick's reflectance.
    slanted: Row,
    means: [f64; 2],
}

/// Albedos by roughness; made when the first rough surface needs them.
static ALBEDOS: LazyLock<Vec<Albedo>> = LazyLock::new(|| (0..=ROUGHNESSES).map(albedo).collect());

fn albedo(index: usize) -> Albedo {
    let roughness = index as f64 / ROUGHNESSES as f64;
    let ggx = Ggx::new((roughness * roughness).max(1e-7));
    let [all, slanted] = Row::of(|cosine| {
        let view = at_cosine(cosine);
        let seen = 1.0 + ggx.lambda(view.z);
        mean_over_visible(&ggx, view, |normal| {
            let cosine = view.dot(normal);
            let light = 2.0 * cosine * normal - view;
            let share = if light.z > 0.0 { seen / (seen + ggx.lambda(light.z)) } else { 0.0 };
            [share, share * (1.0 - cosine).powi(5)]
        })
    });
    let means = [all.mean(), slanted.mean()];
    Albedo { all, slanted, means }
}

/// Where one roughness lies in the table.
#[derive(Clone, Copy, Debug)]
struct Albedos {
    index: usize,
    along: f64,
}

impl Albedos {
    fn new(alpha: f64) -> Albedos {
        let (index, along) = around(alpha.sqrt(), ROUGHNESSES);
        Albedos { index, along }
    }

    fn between(&self, value: impl Fn(&Albedo) -> [f64; 2]) -> [f64; 2] {
        let [a, b] = [self.index, self.index + 1].map(|k| value(&ALBEDOS[k]));
        [lerp(a[0], b[0], self.along), lerp(a[1], b[1], self.along)]
    }

    /// `E` and its slanted part.
    fn at(&self, cosine: f64) -> [f64; 2] {
        self.between(|albedo| [albedo.all.at(cosine), albedo.slanted.at(cosine)])
    }

    /// The means of both over directions of diffuse light.
    fn means(&self) -> [f64; 2] {
        self.between(|albedo| albedo.means)
    }
}

/// Schlick's reflectance `f₀ + (f₉₀ − f₀)(1 − h·ω)⁵`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schlick {
    pub normal: DVec3,
    pub grazing: DVec3,
}

impl Schlick {
    fn at(&self, cosine: f64) -> DVec3 {
        self.normal + (self.grazing - self.normal) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
    }

    /// The mean over directions of diffuse light.
    fn mean(&self) -> DVec3 {
        self.normal + (self.grazing - self.normal) / 21.0
    }

    /// The albedo of single reflections whose albedos are these.
    fn single(&self, [all, slanted]: [f64; 2]) -> DVec3 {
        self.normal * (all - slanted) + self.grazing * slanted
    }

    /// The share of the light that meets several microfacets which leaves in the end, `e` being the mean of `E`.
    fn returned(&self, e: f64) -> DVec3 {
        let f = self.mean();
        f * f * e / (DVec3::ONE - f * (1.0 - e))
    }
}

/// The appearance of an opaque point in the terms of glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    pub base_color: DVec3,
    /// 0 to 1.
    pub metallic: f64,
    /// 0 to 1; `α` is its square.
    pub roughness: f64,
    /// Reflectance of the part that is no metal.
    pub dielectric: Schlick,
}

impl Stated {
    /// The share of light that a dielectric of relative index `ior` reflects, by KHR_materials_ior and
    /// KHR_materials_specular: `factor` and `color` of the latter are 1 where it is absent.
    pub fn dielectric(ior: f64, factor: f64, color: DVec3) -> Schlick {
        let root = (ior - 1.0) / (ior + 1.0);
        Schlick { normal: (color * (root * root)).min(DVec3::ONE) * factor, grazing: DVec3::splat(factor) }
    }
}

/// A layer of microfacets that mirror, over a diffuse base.
///
/// As a [`Bsdf`] it is the layer alone: a path follows what it mirrors, and the base, [`Gloss::base`], is lit directly.
#[derive(Clone, Copy, Debug)]
pub struct Gloss {
    ggx: Ggx,
    is_smooth: bool,
    albedos: Albedos,
    reflectance: Schlick,
    /// The share of the light of several reflections that leaves in the end.
    returned: DVec3,
    /// The mean share of diffuse light that meets several microfacets.
    lost: f64,
    base: Base,
}

/// The diffuse base below a dielectric layer of one channel.
#[derive(Clone, Copy, Debug)]
struct Base {
    albedo: DVec3,
    /// `[f₀, f₉₀]` of the layer.
    layer: [f64; 2],
    returned: f64,
    /// The share of diffuse light that the layer lets through.
    passed: f64,
}

impl Gloss {
    pub fn new(stated: &Stated) -> Gloss {
        let metal = Schlick { normal: stated.base_color, grazing: DVec3::ONE };
        let [dielectric, metallic] = [&stated.dielectric, &metal];
        let mix = |a: DVec3, b: DVec3| a.lerp(b, stated.metallic);
        let alpha = stated.roughness * stated.roughness;
        let albedos = Albedos::new(alpha);
        let is_smooth = alpha < SMOOTH_BELOW;
        let means = if is_smooth { [1.0, 1.0 / 21.0] } else { albedos.means() };
        let returned = mix(dielectric.returned(means[0]), metallic.returned(means[0]));
        let layer = [dielectric.normal.max_element(), dielectric.grazing.max_element()];
        let whole = Schlick { normal: DVec3::splat(layer[0]), grazing: DVec3::splat(layer[1]) };
        let base = Base {
            albedo: stated.base_color * (1.0 - stated.metallic),
            layer,
            returned: whole.returned(means[0]).x,
            passed: 1.0 - (whole.single(means).x + (1.0 - means[0]) * whole.returned(means[0]).x),
        };
        Gloss {
            ggx: Ggx::new(alpha),
            is_smooth,
            albedos,
            reflectance: Schlick {
                normal: mix(dielectric.normal, metal.normal),
                grazing: mix(dielectric.grazing, metal.grazing),
            },
            returned,
            lost: (1.0 - means[0]).max(1e-12),
            base,
        }
    }

    /// `E` of a direction and its slanted part.
    fn albedos(&self, cosine: f64) -> [f64; 2] {
        if self.is_smooth { [1.0, (1.0 - cosine).clamp(0.0, 1.0).powi(5)] } else { self.albedos.at(cosine) }
    }

    /// The share of light from everywhere that the layer sends towards a viewer at this cosine: at most 1.
    pub fn albedo(&self, cosine: f64) -> DVec3 {
        let [single, several] = self.parts(cosine);
        single + several
    }

    /// The albedo by single and by several reflections.
    fn parts(&self, cosine: f64) -> [DVec3; 2] {
        let albedos = self.albedos(cosine);
        [self.reflectance.single(albedos), self.returned * (1.0 - albedos[0])]
    }

    /// `f` of the base for light of one direction, 1/sr, or 0 for light from behind.
    pub fn base(&self, view: &View, towards_light: DVec3) -> DVec3 {
        let cosines = [view.direction, towards_light].map(|d| view.normal.dot(d));
        if cosines[1] <= 0.0 || self.base.albedo == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let passed = cosines.map(|cosine| {
            let [all, slanted] = self.albedos(cosine);
            let [normal, grazing] = self.base.layer;
            1.0 - (normal * (all - slanted) + grazing * slanted + (1.0 - all) * self.base.returned)
        });
        self.base.albedo * (passed[0] * passed[1] / (PI * self.base.passed.max(1e-9)))
    }

    /// The share of samples that are drawn as one reflection.
    fn single_share(&self, cosine: f64) -> f64 {
        let [single, several] = self.parts(cosine).map(DVec3::element_sum);
        if several > 0.0 { single / (single + several) } else { 1.0 }
    }
}

impl Bsdf for Gloss {
    fn transmittance(&self, _view: &View) -> f64 {
        0.0
    }

    fn is_specular(&self) -> bool {
        self.is_smooth
    }

    /// `F D G₂/(4 μ_o μ_i)`, and what several microfacets reflect.
    fn evaluate(&self, view: &View, towards_light: DVec3) -> DVec3 {
        let cosines = [view.direction, towards_light].map(|d| view.normal.dot(d));
        if self.is_smooth || cosines[1] <= 0.0 || cosines[0] <= 0.0 {
            return DVec3::ZERO;
        }
        let half = (view.direction + towards_light).normalize();
        let mirrored = self.ggx.distribution(view.normal.dot(half)) * self.ggx.shadowing(cosines);
        let single = self.reflectance.at(view.direction.dot(half)) * (mirrored / (4.0 * cosines[0] * cosines[1]));
        let [out, back] = cosines.map(|cosine| 1.0 - self.albedos(cosine)[0]);
        single + self.returned * (out * back / (PI * self.lost))
    }

    fn density(&self, view: &View, towards_light: DVec3) -> f64 {
        let cosines = [view.direction, towards_light].map(|d| view.normal.dot(d));
        if self.is_smooth || cosines[1] <= 0.0 || cosines[0] <= 0.0 {
            return 0.0;
        }
        let half = (view.direction + towards_light).normalize();
        let share = self.single_share(cosines[0]);
        let visible = self.ggx.masking(cosines[0]) * self.ggx.distribution(view.normal.dot(half)) / (4.0 * cosines[0]);
        share * visible + (1.0 - share) * UNIFORM_DENSITY
    }

    fn sample(&self, view: &View, lobe: Lobe, mut xi: impl FnMut() -> [f64; 2]) -> Option<Sample> {
        if lobe == Lobe::Transmission {
            return None;
        }
        let cosine = view.normal.dot(view.direction);
        if self.is_smooth {
            let direction = fresnel::reflect(view.normal, view.direction);
            return Some(Sample { direction, weight: self.reflectance.at(cosine) });
        }
        let frame = Frame::new(view.normal);
        let share = self.single_share(cosine);
        let (xi, [choice, _]) = (xi(), xi());
        let direction = if choice < share {
            let local = frame.local(view.direction);
            let normal = self.ggx.sample_visible(local, xi);
            frame.world(2.0 * local.dot(normal) * normal - local)
        } else {
            frame.world(uniform_direction(xi))
        }
        .normalize();
        let (density, light) = (self.density(view, direction), view.normal.dot(direction));
        (density > 0.0).then(|| Sample { direction, weight: self.evaluate(view, direction) * (light / density) })
    }
}
