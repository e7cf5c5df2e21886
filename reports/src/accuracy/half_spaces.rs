//! Reflectances of half-spaces by the models: media of chosen albedos, and all built-in media.

use crate::{accuracy::Effort, markdown::table};
use bssrdf::{Coefficients, Medium, Model, built_in, built_in_names, fresnel};
use rayon::prelude::*;
use test_support::{
    half_space::{medium, reflectance_of},
    pipeline::gray,
    transfer::scattered_reflectance,
    walk::{Matter, slab},
};

const ALBEDOS: [f64; 12] = [0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999, 1.0];
const ANGLES: [f64; 3] = [0.0, 45.0, 75.0];
const ETAS: [f64; 2] = [1.3, 1.5];

/// Below this reduced albedo few walks come back, and none is long.
const LOW: f64 = 0.5;

/// The models in the order of the columns.
pub const COLUMNS: [Model; 4] =
    [Model::HalfSpace, Model::DirectionalDipole, Model::BetterDipole, Model::StandardDipole];

/// The tables.
pub fn document(effort: Effort) -> String {
    let mut text = String::new();
    for eta in ETAS {
        text += &reflectances(eta);
    }
    text += &all_media(effort);
    text
}

fn reflectances(eta: f64) -> String {
    let mut rows = Vec::new();
    for albedo in ALBEDOS {
        for angle in ANGLES {
            let cosine = angle.to_radians().cos();
            let exact = exact_reflectance(albedo, eta, cosine);
            let cell = |model: Model| {
                let value = reflectance_of(model, &medium(albedo, eta), cosine);
                format!("{value:.4} ({})", percent(value / exact - 1.0))
            };
            let own = [albedo.to_string(), angle.to_string(), format!("{exact:.4}")];
            rows.push(own.into_iter().chain(COLUMNS.map(cell)).collect());
        }
    }
    let header = ["reduced albedo", "angle", "exact", "half-space", "directional", "better", "standard"];
    format!(
        "## Half-space, index {eta}\n\nShare of the light that isotropic scatterers scatter back, exactly (Chandrasekhar \
         1950, with a boundary); in brackets, the\nrelative difference of a model.\n\n{}\n",
        table(&header, &rows)
    )
}

/// The share of light of this cosine that comes back scattered, of isotropic scatterers.
fn exact_reflectance(albedo: f64, eta: f64, cosine: f64) -> f64 {
    // Without absorption all light that enters leaves again.
    if albedo == 1.0 { fresnel::transmittance(cosine, eta) } else { scattered_reflectance(albedo, eta, cosine) }
}

/// Errors of the models on one medium.
struct OfMedium {
    name: &'static str,
    /// The smallest and largest exact reflectance.
    range: [f64; 2],
    /// Relative errors by model, of all channels and angles.
    errors: [Vec<f64>; COLUMNS.len()],
    /// The largest error of the half-space model, as a share of the light.
    share: f64,
    /// The largest relative standard error of the exact values.
    noise: f64,
}

fn all_media(effort: Effort) -> String {
    let names: Vec<&'static str> = built_in_names().collect();
    let media: Vec<OfMedium> = names.par_iter().filter_map(|name| of_medium(name, effort)).collect();
    let row = |m: &OfMedium| {
        let [low, high] = m.range.map(|x| format!("{x:.1e}"));
        let own = [m.name.to_owned(), format!("{low} to {high}"), percent(worst(&m.errors[0]))];
        let noise = format!("{:.1} %", 100.0 * m.noise);
        let more = [fine(median(&m.errors[0])), format!("{:.1e}", m.share), noise];
        own.into_iter().chain(more).chain((1..COLUMNS.len()).map(|k| percent(worst(&m.errors[k])))).collect()
    };
    let rows: Vec<Vec<String>> = media.iter().map(row).collect();
    let errors: Vec<f64> = media.iter().flat_map(|m| &m.errors[0]).copied().collect();
    let within = |limit: f64| 100.0 * errors.iter().filter(|e| e.abs() < limit).count() as f64 / errors.len() as f64;
    let share = media.iter().fold(0.0, |most, m| f64::max(most, m.share));
    let text = format!(
        "## All media\n\nRelative errors of the reflectance of a half-space of each built-in medium, of three channels at 0, \
         45 and 75 degrees. The\nhalf-space model's median is {}; {:.0} % are within 1 %, {:.0} % within 2 %, and all within \
         {share:.1e} of the light, which says more\nwhere hardly any is scattered back. Exact values are those of the tables \
         above where g = 0, else of random walks with the\nmedium's own phase function; *noise* is the largest relative \
         standard error of these. Channels that do not scatter are left\nout.\n\n",
        fine(median(&errors)),
        within(0.01),
        within(0.02),
    );
    let header = [
        "medium",
        "scattered back",
        "half-space, worst",
        "median",
        "worst, of the light",
        "noise",
        "directional, worst",
        "better, worst",
        "standard, worst",
    ];
    text + &table(&header, &rows) + "\n"
}

/// None if no channel scatters.
fn of_medium(name: &'static str, effort: Effort) -> Option<OfMedium> {
    let medium = built_in(name).expect("it is one of the built-in names");
    let (mut range, mut share, mut noise) = ([f64::INFINITY, 0.0f64], 0.0f64, 0.0f64);
    let mut errors = [const { Vec::new() }; COLUMNS.len()];
    for (k, c) in medium.channels.iter().enumerate().filter(|(_, c)| c.scatters()) {
        let unit = in_mean_free_paths(c, &medium);
        for cosine in ANGLES.map(|angle| angle.to_radians().cos()) {
            let (exact, error) = match c.asymmetry {
                0.0 => (exact_reflectance(c.reduced_albedo(), medium.eta, cosine), 0.0),
                _ => {
                    let matter = Matter { albedo: c.sigma_s / c.extinction(), asymmetry: c.asymmetry, eta: medium.eta };
                    let walks = effort.of(10_000, if c.reduced_albedo() < LOW { 10_000_000 } else { 400_000 });
                    let walked = slab(&matter, f64::INFINITY, cosine, walks, 6000 + k as u64).reflected;
                    (walked.mean, walked.error)
                }
            };
            range = [range[0].min(exact), range[1].max(exact)];
            noise = noise.max(error / exact);
            for (errors, model) in errors.iter_mut().zip(COLUMNS) {
                errors.push(reflectance_of(model, &unit, cosine) / exact - 1.0);
            }
            share = share.max(errors[0].last().map_or(0.0, |e| (e * exact).abs()));
        }
    }
    errors.iter().all(|e| !e.is_empty()).then_some(OfMedium { name, range, errors, share, noise })
}

/// A channel as a gray medium whose reduced mean free path is 1.
fn in_mean_free_paths(c: &Coefficients, medium: &Medium) -> Medium {
    let path = 1.0 / c.reduced_extinction();
    gray(c.sigma_a * path, c.sigma_s * path, c.asymmetry, medium.eta)
}

/// The error that is largest, with its sign.
fn worst(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, |a, b| if b.abs() > f64::abs(a) { b } else { a })
}

/// The median of the errors without their signs.
fn median(errors: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// A small relative difference without its sign.
fn fine(x: f64) -> String {
    format!("{:.2} %", 100.0 * x)
}

/// A relative difference with its sign, large ones as a factor.
pub fn percent(x: f64) -> String {
    match 100.0 * x {
        p if p.abs() < 9.95 => format!("{p:+.1} %"),
        p if p.abs() < 1000.0 => format!("{p:+.0} %"),
        _ => format!("x {:.0}", x + 1.0),
    }
}
