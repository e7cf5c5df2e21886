//! A medium as a JSON file gives it: by coefficients, by albedo and mean free path, or by color and radius.

use crate::albedo;
use bsdf::fresnel;
use serde::Deserialize;

/// A medium that cannot be used; the message names the field and the way out.
#[derive(Debug, thiserror::Error)]
pub enum MediumError {
    #[error(
        "not a medium: {0}; expected {{\"name\", \"unit\": \"1/mm\" or \"1/m\", \"sigma_a\": [r,g,b], \"sigma_s\": [r,g,b], \"g\", \"eta\", \"source\"}}, or \"unit\": \"mm\" or \"m\" with \"albedo\" and \"mean_free_path\", or with \"color\" and \"radius\""
    )]
    Json(#[from] serde_json::Error),
    #[error("field `{field}`: {value} is {fault}")]
    Field { field: &'static str, value: f64, fault: &'static str },
    #[error("no medium is called `{name}`; {hint}, `gather --list-media` prints all names, or give a FILE.json")]
    Unknown { name: String, hint: String },
}

/// A medium in the unit of its file.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "Fields")]
pub struct MediumFile {
    pub name: String,
    pub unit: Unit,
    pub optics: Optics,
    /// Mean cosine of the phase function.
    pub g: [f64; 3],
    /// Relative index, inside over outside.
    pub eta: f64,
    pub source: String,
}

/// The unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    Millimetre,
    Metre,
}

/// The three ways to give absorption and scattering: red, green, blue.
#[derive(Clone, Copy, Debug)]
pub enum Optics {
    /// Absorption and scattering, 1/unit.
    Coefficients { sigma_a: [f64; 3], sigma_s: [f64; 3] },
    /// `σ_s/σ_t` and `1/σ_t`, unit.
    Albedo { albedo: [f64; 3], mean_free_path: [f64; 3] },
    /// Reflectance of a half-space, as a share of the light that enters it, and `1/σ_tr`, unit.
    Color { color: [f64; 3], radius: [f64; 3] },
}

/// The fields of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    name: String,
    unit: String,
    sigma_a: Option<[f64; 3]>,
    sigma_s: Option<[f64; 3]>,
    albedo: Option<[f64; 3]>,
    mean_free_path: Option<[f64; 3]>,
    color: Option<[f64; 3]>,
    radius: Option<[f64; 3]>,
    #[serde(default = "isotropic")]
    g: Asymmetry,
    #[serde(default = "default_eta")]
    eta: f64,
    #[serde(default)]
    source: String,
}

fn default_eta() -> f64 {
    1.3
}

/// One number, or one per channel.
#[derive(Deserialize)]
#[serde(untagged)]
enum Asymmetry {
    Same(f64),
    PerChannel([f64; 3]),
}

fn isotropic() -> Asymmetry {
    Asymmetry::Same(0.0)
}

impl TryFrom<Fields> for MediumFile {
    type Error = String;

    fn try_from(f: Fields) -> Result<MediumFile, String> {
        let given = (f.sigma_a, f.sigma_s, f.albedo, f.mean_free_path, f.color, f.radius);
        let (optics, units) = match given {
            (Some(sigma_a), Some(sigma_s), None, None, None, None) => {
                (Optics::Coefficients { sigma_a, sigma_s }, ["1/mm", "1/m"])
            }
            (None, None, Some(albedo), Some(mean_free_path), None, None) => {
                (Optics::Albedo { albedo, mean_free_path }, ["mm", "m"])
            }
            (None, None, None, None, Some(color), Some(radius)) => (Optics::Color { color, radius }, ["mm", "m"]),
            _ => return Err("it needs one pair of fields and no field of another".into()),
        };
        let unit = match units.iter().position(|u| *u == f.unit) {
            Some(0) => Unit::Millimetre,
            Some(_) => Unit::Metre,
            None => return Err(format!("unit `{}` must be \"{}\" or \"{}\" here", f.unit, units[0], units[1])),
        };
        let g = match f.g {
            Asymmetry::Same(g) => [g; 3],
            Asymmetry::PerChannel(g) => g,
        };
        Ok(MediumFile { name: f.name, unit, optics, g, eta: f.eta, source: f.source })
    }
}

impl MediumFile {
    /// Checked `σ_a` and `σ_s`, 1/unit. `g` and `eta` are in range.
    pub(crate) fn coefficients(&self) -> Result<([f64; 3], [f64; 3]), MediumError> {
        let (mut sigma_a, mut sigma_s) = ([0.0; 3], [0.0; 3]);
        for c in 0..3 {
            (sigma_a[c], sigma_s[c]) = match &self.optics {
                Optics::Coefficients { sigma_a, sigma_s } => (sigma_a[c], sigma_s[c]),
                Optics::Albedo { albedo, mean_free_path } => of_albedo(albedo[c], mean_free_path[c])?,
                Optics::Color { color, radius } => self.of_color(color[c], radius[c], self.g[c])?,
            };
            check_coefficient("sigma_a", sigma_a[c])?;
            check_coefficient("sigma_s", sigma_s[c])?;
        }
        Ok((sigma_a, sigma_s))
    }

    /// Inverts the standard dipole as Jensen and Buhler 2002 do: the color gives `q = σ_tr/σ_t'`; then `σ_t' = σ_tr/q`,
    /// `σ_a = q σ_tr/3`, and `σ_s' = σ_t' − σ_a`.
    fn of_color(&self, color: f64, radius: f64, g: f64) -> Result<(f64, f64), MediumError> {
        let fault = "outside [0, 1); what reflects all light has no finite radius";
        check("color", color, (0.0..1.0).contains(&color), fault)?;
        check("radius", radius, radius > 0.0 && radius.is_finite(), "not a length above zero")?;
        let (transport, q) = (1.0 / radius, albedo::transport_ratio(color, fresnel::diffuse_reflectance(self.eta)));
        let (extinction, absorption) = (transport / q, q * transport / 3.0);
        Ok((absorption, (extinction - absorption).max(0.0) / (1.0 - g)))
    }
}

fn of_albedo(albedo: f64, mean_free_path: f64) -> Result<(f64, f64), MediumError> {
    check("albedo", albedo, (0.0..=1.0).contains(&albedo), "outside [0, 1]")?;
    let path = mean_free_path;
    check("mean_free_path", path, path > 0.0 && path.is_finite(), "not a length above zero")?;
    Ok(((1.0 - albedo) / path, albedo / path))
}

/// Largest coefficient accepted, in the file's unit: its square stays finite in float32.
const COEFFICIENT_MAX: f64 = 1e9;

fn check_coefficient(field: &'static str, value: f64) -> Result<(), MediumError> {
    check(field, value, value.is_finite(), "not a finite number")?;
    check(field, value, value >= 0.0, "negative; coefficients are zero or more")?;
    check(field, value, value <= COEFFICIENT_MAX, "above 1e9; is the unit right?")
}

pub(crate) fn check(field: &'static str, value: f64, good: bool, fault: &'static str) -> Result<(), MediumError> {
    if good { Ok(()) } else { Err(MediumError::Field { field, value, fault }) }
}
