//! Assigns a medium to each sampled material.

use crate::{Blended, Candidate, ReadMediumError, Unclear, quoted, read_medium, scene_medium, the_one, word_for};
use bssrdf::Medium;
use formats::cloud::SampledMaterial;
use scene::Scene;

/// Why media cannot be assigned.
#[derive(Debug, thiserror::Error)]
pub enum AssignError {
    #[error("--medium: SCENE gives no medium; give a name (`gather --list-media` prints them) or a FILE.json")]
    Missing,
    #[error("--medium: material `{0}` of the cloud has no medium; add --medium {argument}", argument = quoted(&format!("{}=NAME", .0)))]
    MissingFor(String),
    #[error("{0}")]
    UnclearMaterial(String),
    #[error("--medium: given twice for the same material: `{0}` and `{1}`")]
    Twice(String, String),
    #[error("--medium: {0}")]
    Medium(#[from] ReadMediumError),
    #[error("{0}")]
    Scene(ReadMediumError),
}

/// The medium of each sampled material: that of the arguments `[MATERIAL=]NAME|FILE.json`, or else that of the scene's
/// file. Of two that the alpha of a texture blends, it is their mean.
pub fn assign_media(
    arguments: &[String],
    sampled: &[SampledMaterial],
    scene: &Scene,
) -> Result<Vec<Medium>, AssignError> {
    let names = material_names(sampled);
    let mut for_all: Option<&str> = None;
    let mut for_one: Vec<Option<&str>> = vec![None; sampled.len()];
    for argument in arguments {
        let (slot, medium) = match split(argument, &names) {
            Some((name, medium)) => {
                let index = the_one(name, &names, false).map_err(|unclear| unclear_material(name, &unclear))?;
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
        if let Some(blended) = Blended::of(scene, m.index).map_err(AssignError::Scene)? {
            return Ok(blended.mean);
        }
        let own =
            scene.materials.get(usize::from(m.index)).map(scene_medium).transpose().map_err(AssignError::Scene)?;
        own.flatten().ok_or_else(|| missing(m))
    });
    chosen.collect()
}

/// The sampled materials as candidates for a word on the command line.
fn material_names(sampled: &[SampledMaterial]) -> Vec<Candidate<'_>> {
    let detail = |m: &SampledMaterial| format!(", {:.4e} m2", m.area_m2);
    sampled.iter().map(|m| Candidate { index: m.index.into(), names: vec![&m.name], detail: detail(m) }).collect()
}

fn unclear_material(name: &str, unclear: &Unclear) -> AssignError {
    let missing = format!("the cloud has no material `{name}`; it has");
    AssignError::UnclearMaterial(unclear.message("--medium", name, &missing, "material of the cloud"))
}

/// Splits `MATERIAL=MEDIUM`. The name of a material may contain an equals sign; the longest name that exists is taken.
fn split<'a>(argument: &'a str, names: &[Candidate]) -> Option<(&'a str, &'a str)> {
    let at = |(k, _): (usize, &str)| Some((argument.get(..k)?, argument.get(k + 1..)?));
    let known = |name: &str| !matches!(the_one(name, names, false), Err(Unclear::Unknown { .. }));
    let splits: Vec<_> = argument.match_indices('=').filter_map(at).collect();
    splits.iter().rev().find(|(name, _)| known(name)).or(splits.first()).copied()
}
