//! Light that enters and leaves through a rough interface.

use crate::{
    half_space::{exit_moment, lobe_of},
    medium::{Coefficients, Medium},
};
use bsdf::RoughBoundary;
use std::{f64::consts::PI, sync::Arc};

/// Intervals of the table, even in the root of the cosine. Between its entries the transmittance is off by less than
/// 0.002 at cosines above 0.05.
const INTERVALS: usize = 128;

type Table = [f32; INTERVALS + 1];

/// `T12` of a rough interface from outside, and what light gains that enters below it. Copies share the tables.
#[derive(Clone, Debug)]
pub struct RoughEntry {
    transmittance: Arc<Table>,
    /// For each channel, the light that a half-space scatters back of what enters through this interface, over that
    /// through a smooth one.
    gains: Option<Arc<[Table; 3]>>,
}

impl RoughEntry {
    /// That of an interface.
    pub fn new(interface: &RoughInterface) -> RoughEntry {
        let transmittance = table(|cosine| interface.boundary.transmittance(cosine, interface.roughness));
        RoughEntry { transmittance: Arc::new(transmittance), gains: None }
    }

    /// The same for a model whose light goes on in the direction in which a smooth interface sends it: the medium's light
    /// gains what the true directions scatter back (docs/method.md 18.7).
    pub fn gaining(self, medium: &Medium, interface: &RoughInterface) -> RoughEntry {
        let of_channel = |c: &Coefficients| table(|cosine| interface.gain(c, cosine));
        RoughEntry { gains: Some(Arc::new(medium.channels.each_ref().map(of_channel))), ..self }
    }

    /// `T12` at a cosine above 0.
    #[inline(always)]
    pub fn at(&self, cosine: f32) -> f32 {
        let (k, along) = place(cosine);
        between(&self.transmittance, k, along)
    }

    /// The gains of the channels at a cosine above 0, if there are any.
    #[inline(always)]
    pub fn gains(&self, cosine: f32) -> Option<[f32; 3]> {
        let (k, along) = place(cosine);
        let gains = self.gains.as_ref()?;
        Some([0, 1, 2].map(|c| between(&gains[c], k, along)))
    }
}

fn table(of: impl Fn(f64) -> f64) -> Table {
    std::array::from_fn(|k| {
        let root = (k as f64 / INTERVALS as f64).max(1e-3);
        of(root * root) as f32
    })
}

#[inline(always)]
fn place(cosine: f32) -> (usize, f32) {
    let x = cosine.clamp(0.0, 1.0).sqrt() * INTERVALS as f32;
    let k = (x as usize).min(INTERVALS - 1);
    (k, x - k as f32)
}

#[inline(always)]
fn between(table: &Table, k: usize, along: f32) -> f32 {
    table[k] + (table[k + 1] - table[k]) * along
}

/// A rough interface above a medium of relative index `eta`, inside over outside.
#[derive(Clone, Copy)]
pub struct RoughInterface<'a> {
    pub boundary: &'a RoughBoundary,
    /// Its square is `α`.
    pub roughness: f64,
    pub eta: f64,
}

/// Steps of integrals over the cosine.
const STEPS: usize = 512;

impl RoughInterface<'_> {
    /// `a` and `b` of the exit lobe `T21 (a + b μ)` behind this interface that carries the same power as a smooth one's
    /// `T21`, and has the mean cosine `mean_cosine` outside.
    pub fn exit_lobe(&self, mean_cosine: f64) -> [f64; 2] {
        lobe_of([0, 1, 2].map(|k| self.moment(|cosine| cosine.powi(k))), exit_moment(0, self.eta), mean_cosine)
    }

    /// The exit lobe of a channel of a half-space whose lobe behind a smooth interface is known (docs/method.md 18.7).
    pub fn lobe_below(&self, c: &Coefficients, [a, b]: [f64; 2]) -> [f64; 2] {
        let leaving = |cosine: f64| (a + b * cosine) * self.gain(c, cosine);
        let [power, along] = [self.moment(leaving), self.moment(|cosine| leaving(cosine) * cosine)];
        let smooth = exit_moment(0, self.eta);
        // What is reflected inside comes back after it is scattered, with the albedo of diffuse light.
        let back = diffuse_albedo(c.reduced_albedo());
        let [of_smooth, of_rough] = [smooth, power].map(|p| 1.0 - (1.0 - p / (PI * self.eta * self.eta)) * back);
        let [a, b] = self.exit_lobe(along / power);
        [a, b].map(|x| x * (power / smooth) * (of_smooth / of_rough))
    }

    /// `∫ T21 f μ dω` outside.
    fn moment(&self, f: impl Fn(f64) -> f64) -> f64 {
        let at = |k: usize| {
            let cosine = (k as f64 + 0.5) / STEPS as f64;
            self.boundary.transmittance(cosine, self.roughness) * f(cosine) * cosine
        };
        2.0 * PI * (0..STEPS).map(at).sum::<f64>() / STEPS as f64
    }

    /// What a half-space without a boundary scatters back of light that is refracted by this interface, over that of a
    /// smooth one, by the cosine outside.
    fn gain(&self, c: &Coefficients, cosine: f64) -> f64 {
        if !c.scatters() {
            return 1.0;
        }
        let smooth = (1.0 - (1.0 - cosine * cosine) / (self.eta * self.eta)).max(0.0).sqrt();
        let rough = self.boundary.refracted_cosine(cosine, self.roughness);
        let [rough, smooth] = [rough, smooth].map(|cosine| plane_albedo(c.reduced_albedo(), cosine));
        if smooth > 0.0 { rough / smooth } else { 1.0 }
    }
}

/// `1 − H(μ)√(1 − α)`: what a half-space without a boundary scatters back of light at this cosine, with Hapke's
/// approximation of Chandrasekhar's function (2002).
fn plane_albedo(albedo: f64, cosine: f64) -> f64 {
    let root = (1.0 - albedo).max(0.0).sqrt();
    let r = (1.0 - root) / (1.0 + root);
    let x = cosine.clamp(1e-6, 1.0);
    let h = 1.0 / (1.0 - albedo * x * (r + 0.5 * (1.0 - 2.0 * r * x) * (1.0 + 1.0 / x).ln()));
    1.0 - h * root
}

/// What it scatters back of diffuse light (Kulla and Conty 2017).
fn diffuse_albedo(albedo: f64) -> f64 {
    let s = (1.0 - albedo).max(0.0).sqrt();
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{EntryRefraction, LANES};

    fn channel(albedo: f64) -> Coefficients {
        Coefficients { sigma_a: 1.0 - albedo, sigma_s: albedo, asymmetry: 0.0 }
    }

    /// Without absorption all light leaves in the end, through any interface; with much of it, more through a rough one.
    ///
    /// Seen to catch: what is held back inside forgotten.
    #[test]
    fn the_lobe_of_a_rough_interface_has_its_power() {
        for (eta, roughness) in [(1.4, 0.55), (1.5, 0.9), (0.8, 0.6)] {
            let boundary = RoughBoundary::new(eta, roughness);
            let interface = RoughInterface { boundary: &boundary, roughness, eta };
            let power = |albedo: f64| {
                let [a, b] = interface.lobe_below(&channel(albedo), [1.0, 0.0]);
                interface.moment(|cosine| a + b * cosine) / exit_moment(0, eta)
            };
            assert!((power(1.0) - 1.0).abs() < 1e-9, "{eta} {roughness}: {}", power(1.0));
            assert!(eta < 1.0 || power(0.3) > 1.02, "{eta} {roughness}: {}", power(0.3));
        }
    }

    /// A slightly rough interface does what a smooth one does.
    ///
    /// Seen to catch: the smooth direction's cosine outside for that inside.
    #[test]
    fn without_roughness_nothing_is_gained() {
        let boundary = RoughBoundary::new(1.4, 0.03);
        let interface = RoughInterface { boundary: &boundary, roughness: 0.03, eta: 1.4 };
        for albedo in [0.0, 0.4, 0.95, 1.0] {
            for cosine in [0.1, 0.5, 1.0] {
                assert!((interface.gain(&channel(albedo), cosine) - 1.0).abs() < 2e-3, "{albedo} {cosine}");
            }
            let [a, b] = interface.lobe_below(&channel(albedo), [1.1, -0.15]);
            assert!((a - 1.1).abs() < 0.01 && (b + 0.15).abs() < 0.01, "{albedo}: {a} {b}");
        }
    }

    #[test]
    fn sixteen_samples_enter_as_the_boundary_says() {
        let boundary = RoughBoundary::new(1.4, 0.6);
        let entry = EntryRefraction::new(1.4).behind(&RoughEntry::new(&RoughInterface {
            boundary: &boundary,
            roughness: 0.6,
            eta: 1.4,
        }));
        let up = [[0; LANES], [0; LANES], [1000; LANES]];
        let slanted: [i32; LANES] = std::array::from_fn(|i| 2000 * i as i32 - 2000);
        let entered = entry.enter(&up, &[[9000; LANES], [0; LANES], slanted]);
        for (i, z) in slanted.into_iter().map(f64::from).enumerate() {
            let expected = boundary.transmittance(z / (z * z + 9000.0 * 9000.0).sqrt(), 0.6);
            assert!((f64::from(entered.transmittance[i]) - expected).abs() < 1e-3, "{z}: {expected}");
        }
        assert_eq!(entered.transmittance[..2], [0.0; 2]);
    }
}
