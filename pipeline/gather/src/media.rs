//! Which medium fills which material.

use bssrdf::Medium;
use cli::{ReadMediumError, Thing, Unclear, count_up, read_medium, scene_medium, the_one, word_for};
use formats::cloud::SampledMaterial;
use scene::Material;

/// Why media cannot be assigned.
#[derive(Debug, thiserror::Error)]
pub enum AssignError {
    #[error("--medium: which one? SCENE gives none; give a name (--list-media prints them) or a FILE.json")]
    Missing,
    #[error("--medium: material `{0}` of the cloud has no medium; add --medium {0}=NAME")]
    MissingFor(String),
    #[error("--medium: the cloud has no material `{name}`; it has {known}")]
    UnknownMaterial { name: String, known: String },
    #[error("--medium: `{name}` may be more than one material of the cloud: give one of {choices}")]
    SeveralMaterials { name: String, choices: String },
    #[error("--medium: given twice for the same material: `{0}` and `{1}`")]
    Twice(String, String),
    #[error("--medium: {0}")]
    Medium(#[from] ReadMediumError),
    #[error("{0}")]
    Scene(ReadMediumError),
}

/// The medium of each sampled material: from arguments `[MATERIAL=]NAME|FILE.json`, or else from the scene's
/// `materials`.
pub fn assign(
    arguments: &[String],
    sampled: &[SampledMaterial],
    materials: &[Material],
) -> Result<Vec<Medium>, AssignError> {
    let names = material_names(sampled);
    let mut for_all: Option<&str> = None;
    let mut for_one: Vec<Option<&str>> = vec![None; sampled.len()];
    for argument in arguments {
        let (slot, medium) = match split(argument, &names) {
            Some((name, medium)) => {
                let index = the_one(name, &names, false).map_err(|unclear| unclear_material(name, unclear))?;
                let own = for_one.iter_mut().zip(sampled).find(|(_, m)| usize::from(m.index) == index);
                (own.map_or(&mut for_all, |(slot, _)| slot), medium)
            }
            None => (&mut for_all, argument.as_str()),
        };
        if let Some(before) = slot.replace(medium) {
            return Err(AssignError::Twice(before.into(), medium.into()));
        }
    }
    let missing = |m: &SampledMaterial| match arguments {
        [] if sampled.len() == 1 => AssignError::Missing,
        _ => AssignError::MissingFor(word_for(usize::from(m.index), &names, false)),
    };
    let chosen = for_one.iter().zip(sampled).map(|(one, m)| {
        if let Some(name) = one.or(for_all) {
            return Ok(read_medium(name)?);
        }
        let own = materials.get(usize::from(m.index)).map(scene_medium).transpose().map_err(AssignError::Scene)?;
        own.flatten().ok_or_else(|| missing(m))
    });
    chosen.collect()
}

/// The sampled materials as a word may mean them.
fn material_names(sampled: &[SampledMaterial]) -> Vec<Thing<'_>> {
    let place = |m: &SampledMaterial| format!(", {:.4e} m2", m.area_m2);
    sampled.iter().map(|m| Thing { index: m.index.into(), names: vec![&m.name], place: place(m) }).collect()
}

fn unclear_material(name: &str, unclear: Unclear) -> AssignError {
    let name = name.to_owned();
    match unclear {
        Unclear::Unknown { known } => AssignError::UnknownMaterial { name, known },
        Unclear::Several { choices } => AssignError::SeveralMaterials { name, choices },
    }
}

/// Splits `MATERIAL=MEDIUM`; the name of a material may hold an equals sign, and the longest that fits is meant.
fn split<'a>(argument: &'a str, names: &[Thing]) -> Option<(&'a str, &'a str)> {
    let at = |(k, _): (usize, &str)| Some((argument.get(..k)?, argument.get(k + 1..)?));
    let known = |name: &str| !matches!(the_one(name, names, false), Err(Unclear::Unknown { .. }));
    let splits: Vec<_> = argument.match_indices('=').filter_map(at).collect();
    splits.iter().rev().find(|(name, _)| known(name)).or(splits.first()).copied()
}

/// Lengths of a medium beside the object's, and what is odd about them.
pub struct Scale {
    /// One line for each: medium, mean free path, 1/σ_tr, object, sample spacing.
    pub lines: Vec<String>,
    pub warnings: Vec<String>,
}

/// The surface of a material, m.
pub struct Object<'a> {
    pub material: &'a str,
    /// Of the box around it.
    pub diagonal: f64,
    /// Mean distance of its samples that carry light; infinite if none does.
    pub spacing: f64,
    /// Samples of the cloud, with those of other surfaces and without light.
    pub drawn: u64,
    /// What float32 rounds its positions by, at most.
    pub rounding: f64,
}

/// Samples farther apart than this many times the way that light goes are seen as grain.
const SPARSE: f64 = 3.0;

/// Compares a medium with the object that it fills; `transport` is `σ_tr`, 1/m.
pub fn scale(object: &Object, medium: &Medium, transport: [f64; 3]) -> Scale {
    let Object { material, diagonal, spacing, drawn, rounding } = *object;
    let path = medium.mean_free_path();
    let diffuse = transport.map(|s| 1.0 / s);
    let three = |v: [f64; 3]| v.map(length).join(" ");
    let lines = vec![
        format!("material `{material}`: {} (eta {})", medium.name, medium.eta),
        format!("  sigma_a, 1/m     {}", coefficients(medium.map(|c| c.sigma_a))),
        format!("  sigma_s, 1/m     {}, g {}", coefficients(medium.map(|c| c.sigma_s)), mean_cosine(medium)),
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
    } else if spacing == f64::INFINITY {
        warnings.push(format!("`{material}`: no sample of it carries light: it will show no scattered light"));
    } else if spacing > SPARSE * reduced {
        warnings.push(format!(
            "`{material}`: samples lie {} apart, light scatters within {}: expect grain; a cloud of about {} samples would do",
            length(spacing),
            length(reduced),
            count_up(drawn as f64 * (spacing / reduced).powi(2))
        ));
    }
    if rounding > 0.01 * reduced {
        warnings.push(format!(
            "`{material}`: positions are rounded by up to {}, light scatters within {}: the scene is too wide for so \
             dense a medium; leave out what is far away",
            length(rounding),
            length(reduced)
        ));
    }
    Scale { lines, warnings }
}

fn coefficients(sigma: [f64; 3]) -> String {
    sigma.map(|s| format!("{s:.4e}")).join(" ")
}

/// One number if the channels agree.
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
