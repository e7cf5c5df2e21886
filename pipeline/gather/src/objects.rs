//! The translucent objects of an image, prepared for its paths.

use crate::{
    image::{Input, Settings},
    reference::Walks,
    renderer::{Scattering, TranslucentObject},
};
use bssrdf::{Medium, Partition};
use calibration::Factors;
use formats::cloud::shards;
use near_field::NearField;
use scene::DVec3;
use std::sync::Arc;
use sums::{Summation, drawn::DrawnCounts, estimator::Scatterer};
use tint::Tinted;
use walks::Roughness;

/// The translucent objects by the materials of the scene; none for opaque ones.
pub fn objects<'a>(input: &Input<'a>, settings: &Settings) -> Vec<Option<TranslucentObject<'a>>> {
    let mut objects: Vec<Option<TranslucentObject>> = input.scene.materials.iter().map(|_| None).collect();
    for (slot, (sampled, medium)) in shards::materials(input.clouds).iter().zip(input.media).enumerate() {
        let tinted = input.tints.get(slot).and_then(Option::as_ref);
        let rough = Roughness::new(&input.scene.materials[sampled.index as usize], medium.eta);
        let scattering = |medium: &Medium, tinted: Option<&'a Tinted>| {
            let tint = tinted.map(|tinted| tinted.tint.clone());
            let entry = rough.as_ref().map(|rough| settings.model.rough_entry(medium, &rough.interface()));
            let near = || NearField::of_clouds(settings.model, medium, input.clouds, slot);
            let near = settings.near_field.then(near).flatten();
            let near = near.map(|near| near.tinted(tint.clone()).behind(entry.as_ref()));
            let partition = near.as_ref().map_or(Partition::NONE, NearField::partition);
            let scatterer = Arc::new(Scatterer::new(settings.model, medium, sampled.area_m2.sqrt()).far(partition));
            let summation = match tinted {
                Some(tinted) => Summation::new(scatterer, tinted.samples(medium.eta), DrawnCounts::of(input.clouds)),
                None => Summation::of_clouds(scatterer, input.clouds, slot),
            };
            Scattering { summation: summation.behind(entry.as_ref()), near, tint }
        };
        let parts = match tinted.and_then(|tinted| Some((tinted, tinted.blend.as_ref()?))) {
            None => vec![scattering(medium, tinted)],
            Some((first, blend)) => {
                let second = &blend.samples;
                let parts =
                    [(&blend.first, first), (&blend.between, second), (&blend.second, second), (&blend.between, first)];
                parts.map(|(medium, samples)| scattering(medium, Some(samples))).into()
            }
        };
        let is_translucent = |material| shards::materials(input.clouds).iter().any(|m| m.index == material);
        let walks =
            settings.reference.then(|| Walks::new(input, sampled.index, medium, rough.is_some(), is_translucent));
        let extinction = || medium.map(|c| c.extinction());
        objects[sampled.index as usize] = Some(TranslucentObject {
            unscattered: if settings.reference { extinction() } else { settings.model.unscattered_extinction(medium) },
            walks: walks.flatten(),
            factors: input.calibration.map(|c| Factors::new(&c.materials[slot])),
            lobe: match &rough {
                None => settings.model.exit_lobe(medium),
                Some(rough) => settings.model.rough_exit_lobe(medium, &rough.interface()),
            },
            parts,
            rough,
            color: color_of(medium),
            medium: medium.clone(),
        });
    }
    objects
}

/// The share of light that a half-space of the medium would scatter back, without its interface: Kulla and Conty, 2017,
/// by the reduced albedo.
fn color_of(medium: &Medium) -> DVec3 {
    let color = |albedo: f64| {
        let s = (1.0 - albedo).max(0.0).sqrt();
        (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
    };
    DVec3::from_array(medium.map(|c| color(c.reduced_albedo())))
}
