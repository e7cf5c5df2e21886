//! Compares the lengths of each medium with those of its object, and warns where they do not fit each other.

use crate::settings::Request;
use bssrdf::{Medium, Model};
use cli::{LitScene, count_up};
use formats::cloud::{Cloud, shards};

/// Samples that are farther apart than this many reduced mean free paths show as grain.
const SPARSE: f64 = 3.0;

/// Rounding of positions by more than this share of a reduced mean free path is visible.
const ROUGH: f64 = 0.01;

/// An object looks opaque if light travels less far in it than this share of its diagonal: a fraction of a pixel.
const OPAQUE: f64 = 1e-3;

/// Light that is not absorbed travels about so many reduced mean free paths before it leaves.
const UNABSORBED: f64 = 30.0;

/// An object whose diagonal is so many times as long as light travels shows both its shape and its translucence.
const SHOWN: f64 = 12.0;

/// Larger sizes are not recommended: a medium that needs them is clear.
const LARGEST_M: f64 = 10.0;

/// Measures of the surface of a material, m.
struct Object<'a> {
    material: &'a str,
    /// Diagonal of the box around it.
    diagonal: f64,
    /// Largest extent of all translucent surfaces along an axis, which `--size` gives.
    extent: f64,
    /// Mean distance of its samples that carry light; infinite if none does.
    spacing: f64,
    /// Whether no sample of any material carries light, of which `sample-surface` warned.
    is_known_dark: bool,
    /// Samples drawn for the clouds, over all surfaces and with the unlit ones.
    drawn: u64,
    /// Largest rounding of its positions in float32.
    rounding: f64,
}

/// Prints the lengths of each medium and its object, and warns where they do not fit each other: in three lines a
/// material, unless all are asked for.
pub fn show(request: &Request, inputs: &LitScene, model: Model) {
    let (common, clouds) = (&request.common, inputs.clouds());
    let extent = inputs.framing().size().max_element();
    for (slot, (material, medium)) in shards::materials(clouds).iter().zip(&inputs.media).enumerate() {
        let (low, high) = inputs.scene.bounds_of(|index| index == material.index);
        let object = Object {
            material: &material.name,
            diagonal: (high - low).length(),
            extent,
            spacing: (material.area_m2 / shards::count(clouds, slot) as f64).sqrt(),
            is_known_dark: clouds.iter().all(Cloud::is_empty) && !request.verbose,
            drawn: shards::drawn(clouds),
            rounding: 0.5 * f64::from(f32::EPSILON) * low.abs().max(high.abs()).max_element(),
        };
        let reflects = model.poor_reflectance(medium).filter(|_| !request.reference).map(|errors| {
            let [r, g, b] = errors.map(|e| format!("{:+.0}", 100.0 * e));
            let (model, medium) = (model.name(), &medium.name);
            format!(
                "  {model} reflects {r} {g} {b} % more than {medium} does (red, green, blue; docs/reports/accuracy.md)"
            )
        });
        let transport = model.of(medium).transport();
        let warnings = warnings(&object, medium, transport, request);
        if request.verbose {
            lines(&object, medium, transport).iter().for_each(|line| common.say(line));
        } else {
            common.say(line(&object, medium));
        }
        warnings.iter().for_each(|warning| common.warn(warning));
        if let Some(reflects) = reflects.filter(|_| request.verbose || warnings.len() < LINES - 1) {
            common.say(reflects);
        }
    }
}

/// Lines that a material has at most, its warnings included, unless all of them are asked for.
const LINES: usize = 3;

/// The medium and the lengths that matter most, in one line.
fn line(object: &Object, medium: &Medium) -> String {
    let [path, size, apart] = [three(medium.mean_free_path()), length(object.diagonal), length(object.spacing)];
    format!(
        "material `{}`: {} (eta {}), mean free path {path}; object {size}, samples {apart} apart",
        object.material, medium.name, medium.eta
    )
}

fn three(lengths: [f64; 3]) -> String {
    lengths.map(length).join(" ")
}

/// The medium and its lengths; `transport` is `σ_tr`, 1/m.
fn lines(object: &Object, medium: &Medium, transport: [f64; 3]) -> [String; 6] {
    [
        format!("material `{}`: {} (eta {})", object.material, medium.name, medium.eta),
        format!("  sigma_a, 1/m     {}", coefficients(medium.map(|c| c.sigma_a))),
        format!("  sigma_s, 1/m     {}, g {}", coefficients(medium.map(|c| c.sigma_s)), mean_cosine(medium)),
        format!("  mean free path   {}", three(medium.mean_free_path())),
        format!("  1/sigma_tr       {}", three(transport.map(|s| 1.0 / s))),
        format!("  object diagonal  {}   sample spacing {}", length(object.diagonal), length(object.spacing)),
    ]
}

fn warnings(object: &Object, medium: &Medium, transport: [f64; 3], request: &Request) -> Vec<String> {
    let Object { material, diagonal, spacing, drawn, rounding, is_known_dark, .. } = *object;
    let shortest = |lengths: [f64; 3]| lengths.into_iter().fold(f64::INFINITY, f64::min);
    let free_path = shortest(medium.mean_free_path());
    let reduced = shortest(medium.map(|c| 1.0 / c.reduced_extinction()));
    let travels = travels(medium, transport);
    let [size, path, depth, apart, rounded] = [diagonal, free_path, reduced, spacing, rounding].map(length);
    let way_out = way_out(object, travels);
    let mut warnings = Vec::new();
    // Clear glass is meant so.
    if free_path > diagonal && free_path < f64::INFINITY {
        warnings.push(format!(
            "`{material}`: light crosses the object ({size}) without scattering (mean free path {path}); {way_out}"
        ));
    } else if travels < OPAQUE * diagonal {
        warnings.push(format!(
            "`{material}`: light travels {} in an object of {size}: it will look opaque; {way_out}",
            length(travels)
        ));
    } else if request.reference {
        // The samples do not count.
    } else if spacing == f64::INFINITY && is_known_dark {
        // It was said.
    } else if spacing == f64::INFINITY {
        warnings.push(format!("`{material}`: none of its samples carries light: it will show no scattered light"));
    } else if spacing > SPARSE * reduced && !request.estimator.is_hierarchical() {
        warnings.push(format!(
            "`{material}`: samples lie {apart} apart, light scatters within {depth}: expect grain; a cloud of about {} \
             samples would do",
            count_up(drawn as f64 * (spacing / reduced).powi(2))
        ));
    }
    if rounding > ROUGH * reduced {
        warnings.push(format!(
            "`{material}`: positions are rounded by up to {rounded}, light scatters within {depth}: the scene is too wide \
             for so dense a medium; leave out what is far away"
        ));
    }
    warnings
}

/// How far light travels in a medium before it leaves, in the channel in which it travels farthest, m.
fn travels(medium: &Medium, transport: [f64; 3]) -> f64 {
    let scattered = medium.map(|c| UNABSORBED / c.reduced_extinction());
    let channels = transport.iter().zip(scattered).map(|(sigma, scattered)| scattered.min(1.0 / sigma));
    channels.fold(0.0, f64::max)
}

/// What to do about an object of a size at which the medium makes no sense.
fn way_out(object: &Object, travels: f64) -> String {
    let size = object.extent * (SHOWN * travels / object.diagonal);
    let unit = 10f64.powf(size.log10().floor());
    if size > 0.0 && size <= LARGEST_M && unit > 0.0 {
        // One digit is typed: division by a power of ten gives the nearest number to it.
        let (digit, exponent) = ((size / unit).round(), unit.log10().round());
        let typed = digit * 10f64.powf(exponent.max(0.0)) / 10f64.powf((-exponent).max(0.0));
        format!("--size {typed} (m, its largest extent) would show it, unless the medium's unit is wrong")
    } else {
        "are the medium's unit and --metres-per-unit right?".into()
    }
}

fn coefficients(sigma: [f64; 3]) -> String {
    sigma.map(|s| format!("{s:.4e}")).join(" ")
}

/// The asymmetry of the channels; one number if they agree.
fn mean_cosine(medium: &Medium) -> String {
    let [r, g, b] = medium.map(|c| c.asymmetry);
    if r == g && g == b { r.to_string() } else { format!("{r} {g} {b}") }
}

/// A length with a unit that suits it.
fn length(metres: f64) -> String {
    match metres {
        m if !m.is_finite() => "infinite".into(),
        m if m >= 1.0 => format!("{m:.3} m"),
        m if m >= 1e-3 => format!("{:.3} mm", m * 1e3),
        m if m >= 1e-6 => format!("{:.3} um", m * 1e6),
        m => format!("{m:.3e} m"),
    }
}
