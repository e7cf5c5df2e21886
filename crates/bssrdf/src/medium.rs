//! Optical coefficients of a medium and every quantity derived from them.

use crate::medium_file::{MediumError, MediumFile, Unit, check};
use bsdf::fresnel;

/// Smallest relative index the Fresnel fits hold for (exclusive): 1/η ≤ 2.5.
pub const ETA_MIN: f64 = 0.4;
/// Largest relative index the Fresnel fits hold for: beyond it `A_C` turns negative (docs/method.md section 2).
pub const ETA_MAX: f64 = 2.5;

/// Coefficients of one color channel, 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Absorption, 1/m.
    pub sigma_a: f64,
    /// Scattering, 1/m.
    pub sigma_s: f64,
    /// Mean cosine `g` of the phase function.
    pub asymmetry: f64,
}

impl Coefficients {
    /// `σ_t = σ_a + σ_s`, 1/m.
    pub fn extinction(&self) -> f64 {
        self.sigma_a + self.sigma_s
    }

    /// `σ_s' = (1 − g) σ_s`, 1/m.
    pub fn reduced_scattering(&self) -> f64 {
        (1.0 - self.asymmetry) * self.sigma_s
    }

    /// False where nothing scatters, so that `S = 0` (docs/method.md section 8). The limit of once in 10⁶⁰ m keeps
    /// squares and cubes of all lengths finite.
    pub fn scatters(&self) -> bool {
        self.reduced_scattering() > 1e-60
    }

    /// `σ_t' = σ_s' + σ_a`, 1/m.
    pub fn reduced_extinction(&self) -> f64 {
        self.reduced_scattering() + self.sigma_a
    }

    /// `α' = σ_s'/σ_t'`; 0 where nothing scatters, also in a vacuum.
    pub fn reduced_albedo(&self) -> f64 {
        if self.scatters() { self.reduced_scattering() / self.reduced_extinction() } else { 0.0 }
    }

    /// `D = 1/(3σ_t')` of the standard and the directional dipole, m (docs/method.md 3.2, 5.1).
    pub fn diffusion(&self) -> f64 {
        1.0 / (3.0 * self.reduced_extinction())
    }

    /// `σ_tr = √(3 σ_a (σ_a + (1−g) σ_s))`, 1/m (docs/method.md 5.1).
    pub fn transport(&self) -> f64 {
        // note: [transport]
        (3.0 * self.sigma_a * self.reduced_extinction()).sqrt()
    }

    /// Grosjean's `D = (2σ_a + σ_s')/(3σ_t'²)` of the better dipole, m (docs/method.md 4.1).
    pub fn grosjean_diffusion(&self) -> f64 {
        let reduced = self.reduced_extinction();
        (2.0 * self.sigma_a + self.reduced_scattering()) / (3.0 * reduced * reduced)
    }

    /// `σ_tr = √(σ_a/D)` with Grosjean's `D`, 1/m (docs/method.md 4.1); 0 in a vacuum.
    pub fn grosjean_transport(&self) -> f64 {
        if self.sigma_a == 0.0 { 0.0 } else { (self.sigma_a / self.grosjean_diffusion()).sqrt() }
    }
}

/// The constants of the boundary in the models, from the fits of [`fresnel`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// `C_φ(η)` (docs/method.md 2.6).
    pub c_phi: f64,
    /// `C_E(η)` (docs/method.md 2.6).
    pub c_e: f64,
    /// `4 C_φ(1/η)`, which normalizes the exit lobe (docs/method.md 4.5, 5.10).
    pub exit_norm: f64,
    /// `A_C = (1 − C_E)/(2C_φ)` (docs/method.md 2.7).
    pub reflection: f64,
    /// `A_F = (1 + F_dr)/(1 − F_dr)` (docs/method.md 3.2).
    pub reflection_egan: f64,
}

/// A checked medium; coefficients in 1/m.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    pub name: String,
    pub source: String,
    /// Red, green, blue.
    pub channels: [Coefficients; 3],
    /// Relative index, inside over outside.
    pub eta: f64,
    pub interface: Interface,
}

impl Medium {
    /// Parses and checks a medium file.
    pub fn from_json(text: &str) -> Result<Medium, MediumError> {
        Medium::new(serde_json::from_str(text)?)
    }

    /// Checks ranges and converts to 1/m.
    pub fn new(file: MediumFile) -> Result<Medium, MediumError> {
        let scale = match file.unit {
            Unit::Millimetre => 1000.0,
            Unit::Metre => 1.0,
        };
        file.g.iter().try_for_each(|g| check("g", *g, *g > -1.0 && *g < 1.0, "outside (-1, 1)"))?;
        check("eta", file.eta, file.eta > ETA_MIN && file.eta <= ETA_MAX, "outside (0.4, 2.5], where the models hold")?;
        let (sigma_a, sigma_s) = file.coefficients()?;
        let channel =
            |c: usize| Coefficients { sigma_a: sigma_a[c] * scale, sigma_s: sigma_s[c] * scale, asymmetry: file.g[c] };
        let interface = Interface::new(file.eta);
        let channels = [0, 1, 2].map(channel);
        Ok(Medium { name: file.name, source: file.source, channels, eta: file.eta, interface })
    }

    /// A function of the coefficients of every channel.
    pub fn map(&self, f: impl Fn(&Coefficients) -> f64) -> [f64; 3] {
        [f(&self.channels[0]), f(&self.channels[1]), f(&self.channels[2])]
    }

    /// `1/σ_t`, the mean free path of each channel, m; infinite in a vacuum.
    pub fn mean_free_path(&self) -> [f64; 3] {
        self.map(|c| 1.0 / c.extinction())
    }

    /// The medium between this one and another of the same index: of the other's coefficients this share, by volume. The
    /// mean cosine is that of all scattering.
    pub fn mixed(&self, other: &Medium, share: f64) -> Medium {
        let mean = |a: f64, b: f64| a * (1.0 - share) + b * share;
        let channel = |c: usize| {
            let (a, b) = (self.channels[c], other.channels[c]);
            let sigma_s = mean(a.sigma_s, b.sigma_s);
            let along = mean(a.sigma_s * a.asymmetry, b.sigma_s * b.asymmetry);
            let asymmetry = match share {
                0.0 => a.asymmetry,
                1.0 => b.asymmetry,
                _ if sigma_s > 0.0 => along / sigma_s,
                _ => 0.0,
            };
            Coefficients { sigma_a: mean(a.sigma_a, b.sigma_a), sigma_s, asymmetry }
        };
        Medium {
            name: format!("{} and {}", self.name, other.name),
            source: format!("{}; {}", self.source, other.source),
            channels: [0, 1, 2].map(channel),
            eta: self.eta,
            interface: self.interface,
        }
    }

    /// True if no channel scatters: then no light leaves by subsurface scattering.
    pub fn is_clear(&self) -> bool {
        !self.channels.iter().any(Coefficients::scatters)
    }
}

impl Interface {
    /// The constants of relative index `eta`, inside over outside.
    pub fn new(eta: f64) -> Interface {
        let (c_phi, c_e) = (fresnel::c_phi(eta), fresnel::c_e(eta));
        let diffuse = fresnel::diffuse_reflectance(eta);
        Interface {
            c_phi,
            c_e,
            exit_norm: 4.0 * fresnel::c_phi(1.0 / eta),
            reflection: (1.0 - c_e) / (2.0 * c_phi),
            reflection_egan: (1.0 + diffuse) / (1.0 - diffuse),
        }
    }
}
