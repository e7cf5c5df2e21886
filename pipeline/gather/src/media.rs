//! Which medium fills which material.

use bssrdf::Medium;
use cli::{ReadMediumError, read_medium};
use formats::cloud::Meta;

/// Why media cannot be assigned.
#[derive(Debug, thiserror::Error)]
pub enum AssignError {
    #[error("--medium: which one? give a name (--list-media prints them) or a FILE.json")]
    Missing,
    #[error("--medium: material `{0}` of the cloud has no medium; add --medium {0}=NAME")]
    MissingFor(String),
    #[error("--medium: the cloud has no material `{name}`; it has {known}")]
    UnknownMaterial { name: String, known: String },
    #[error("--medium: given twice for the same material: `{0}` and `{1}`")]
    Twice(String, String),
    #[error("--medium: {0}")]
    Medium(#[from] ReadMediumError),
}

/// The medium of each sampled material from arguments `[MATERIAL=]NAME|FILE.json`.
pub fn assign(arguments: &[String], cloud: &Meta) -> Result<Vec<Medium>, AssignError> {
    let mut for_all: Option<&str> = None;
    let mut for_one: Vec<Option<&str>> = vec![None; cloud.materials.len()];
    for argument in arguments {
        let (slots, medium): (Vec<&mut Option<&str>>, &str) = match argument.split_once('=') {
            Some((name, medium)) => {
                let named = cloud.materials.iter().zip(&mut for_one).filter(|(m, _)| m.name == name);
                (named.map(|(_, slot)| slot).collect(), medium)
            }
            None => (vec![&mut for_all], argument),
        };
        if slots.is_empty() {
            let name = argument.split('=').next().unwrap_or_default().to_owned();
            let known = cloud.materials.iter().map(|m| format!("`{}`", m.name)).collect::<Vec<_>>().join(", ");
            return Err(AssignError::UnknownMaterial { name, known });
        }
        for slot in slots {
            if let Some(before) = slot.replace(medium) {
                return Err(AssignError::Twice(before.into(), medium.into()));
            }
        }
    }
    if arguments.is_empty() {
        return Err(AssignError::Missing);
    }
    let chosen = for_one.iter().zip(&cloud.materials).map(|(one, m)| {
        one.or(for_all).ok_or_else(|| AssignError::MissingFor(m.name.clone())).and_then(|name| Ok(read_medium(name)?))
    });
    chosen.collect()
}

/// Lengths of a medium beside the object's, and what is odd about them.
pub struct Scale {
    /// One line for each: medium, mean free path, 1/σ_tr, object, sample spacing.
    pub lines: Vec<String>,
    pub warnings: Vec<String>,
}

/// Compares a medium with the object that it fills. `diagonal` is the object's, `spacing` the mean distance of its
/// samples, m; `transport` is `σ_tr`, 1/m.
pub fn scale(material: &str, medium: &Medium, transport: [f64; 3], diagonal: f64, spacing: f64) -> Scale {
    let path = medium.mean_free_path();
    let diffuse = transport.map(|s| 1.0 / s);
    let three = |v: [f64; 3]| v.map(length).join(" ");
    let lines = vec![
        format!("material `{material}`: {} (eta {})", medium.name, medium.eta),
        format!("  mean free path   {}", three(path)),
        format!("  1/sigma_tr       {}", three(diffuse)),
        format!("  object diagonal  {}   sample spacing {}", length(diagonal), length(spacing)),
    ];
    let mut warnings = Vec::new();
    let shortest = path.into_iter().fold(f64::INFINITY, f64::min);
    let reduced = medium.map(|c| 1.0 / c.reduced_extinction()).into_iter().fold(f64::INFINITY, f64::min);
    if shortest > diagonal {
        warnings.push(format!(
            "`{material}`: light crosses the object ({}) without scattering (mean free path {}); are the medium's unit \
             and --metres-per-unit right?",
            length(diagonal),
            length(shortest)
        ));
    } else if reduced < 1e-5 * diagonal {
        warnings.push(format!(
            "`{material}`: light scatters within {} of an object of {}: it will look opaque; are the medium's unit and \
             --metres-per-unit right?",
            length(reduced),
            length(diagonal)
        ));
    } else if spacing > 3.0 * reduced {
        warnings.push(format!(
            "`{material}`: samples lie {} apart, light scatters within {}: expect grain; about {:.1e} samples would do",
            length(spacing),
            length(reduced),
            (spacing / reduced).powi(2)
        ));
    }
    Scale { lines, warnings }
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
