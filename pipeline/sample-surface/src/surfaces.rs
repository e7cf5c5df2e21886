//! Finds the surfaces that the arguments name.

use crate::settings::Request;
use cli::{Candidate, Failure, Unclear, material_names, the_one};
use sample_surface::{SampleError, Surfaces};
use scene::Scene;
use std::collections::BTreeSet;

/// The surfaces to sample: those of the named materials, or those that are translucent by the scene's file.
pub fn surfaces(request: &Request, scene: &Scene) -> Result<Surfaces, Failure> {
    let named = |e: Failure| e.within(request.scene.path.display());
    let mut surfaces = if request.translucent.is_empty() {
        let (surfaces, unmarked) = Surfaces::translucent(scene).map_err(|e| failure(request, &e))?;
        if unmarked {
            request.common.say("no material is marked as translucent: all surfaces that do not emit are translucent");
        }
        surfaces
    } else {
        Surfaces { materials: translucent(&request.translucent, scene).map_err(named)?, shares: Vec::new() }
    };
    surfaces.shares = shares(&request.shares, scene, &surfaces.materials).map_err(named)?;
    Ok(surfaces)
}

/// A failure of this scene, with the options that are the way out.
pub fn failure(request: &Request, error: &SampleError) -> Failure {
    let way_out = match error {
        SampleError::NoLight => ": give it one, or light it with --environment",
        SampleError::NoSurface => "; name one with --translucent",
        SampleError::Lost(_) => ", or pass --translucent NAME",
        SampleError::ShareSum { .. } => " (--share)",
        _ => "",
    };
    let message = format!("{}: {error}{way_out}", request.scene.path.display());
    match error {
        SampleError::NotFinite { .. } => Failure::numerical(message),
        _ => Failure::usage(message),
    }
}

/// The request with the size of a unit that `--size` means for these surfaces.
pub fn sized(mut request: Request) -> Result<Request, Failure> {
    let words = &request.translucent;
    request.scene = match words.is_empty() {
        true => request.scene.sized_by_file()?,
        false => request.scene.sized(|scene| translucent(words, scene))?,
    };
    Ok(request)
}

/// The materials that the words of `--translucent` mean, in ascending order; one without triangles is none.
fn translucent(words: &[String], scene: &Scene) -> Result<Vec<u16>, Failure> {
    let used: BTreeSet<u16> = scene.mesh.triangles.iter().map(|t| t.material).collect();
    let candidates = material_names(scene, &used.into_iter().collect::<Vec<_>>());
    let materials = words.iter().map(|word| material(word, &candidates, "--translucent", "surface"));
    Ok(materials.collect::<Result<BTreeSet<u16>, Failure>>()?.into_iter().collect())
}

/// The materials that the words of `--share` mean, each with its share.
fn shares(words: &[(String, f64)], scene: &Scene, sampled: &[u16]) -> Result<Vec<(u16, f64)>, Failure> {
    let candidates = material_names(scene, sampled);
    let mut shares: Vec<(u16, f64)> = Vec::new();
    for (word, share) in words {
        let material = material(word, &candidates, "--share", "sampled surface")?;
        if shares.iter().any(|(other, _)| *other == material) {
            return Err(Failure::usage(format!("--share: `{word}` has two; give one")));
        }
        shares.push((material, *share));
    }
    Ok(shares)
}

/// The material that a word of an option means; no `surface` has a material that it does not mean.
fn material(word: &str, candidates: &[Candidate], option: &str, surface: &str) -> Result<u16, Failure> {
    let missing = format!("no {surface} has a material called `{word}`; there are");
    let unclear = |e: Unclear| Failure::usage(e.message(option, word, &missing, "material"));
    the_one(word, candidates, false).map(|index| index as u16).map_err(unclear)
}
