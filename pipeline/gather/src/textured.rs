//! The textures of translucent surfaces: the samples of a run, tinted once for all of its images.

use crate::settings::Request;
use bssrdf::Model;
use cli::{Failure, LitScene};
use formats::cloud::shards;
use scene::Rays;
use tint::{Tint, Tinted};

/// The share of a surface from which on a line says that its texture is brighter than its medium can be.
const LIMITED: f64 = 0.01;

/// The tinted samples of each material; none of those without texture. Random walks know no textures.
pub fn make(request: &Request, lit: &LitScene, rays: &Rays, model: Model) -> Result<Vec<Option<Tinted>>, Failure> {
    let (common, scene, clouds) = (&request.common, &lit.scene, lit.clouds());
    let mut tints = Vec::new();
    for (slot, (sampled, medium)) in shards::materials(clouds).iter().zip(&lit.media).enumerate() {
        let (name, path) = (&sampled.name, request.scene.path.display());
        let Some((tint, facts)) = common.in_pool(|| Tint::new(scene, sampled.index, medium, model))? else {
            tints.push(None);
            continue;
        };
        let blend = lit.blend(sampled.index, medium)?;
        if request.reference {
            common.warn(format_args!("{path}: material `{name}`: --reference does not show its texture"));
            tints.push(None);
            continue;
        }
        if facts.limited > LIMITED {
            let (share, medium) = (100.0 * facts.limited, &medium.name);
            common.warn(format_args!(
                "{path}: material `{name}`: on {share:.0} % of its surface the texture is brighter than {medium} can be, and \
                 all light leaves there; a medium that absorbs more shows all of the texture"
            ));
        }
        let tinted = common.in_pool(|| match &blend {
            None => Tinted::new(scene, rays, clouds, slot, tint),
            Some(blend) => Tinted::blended(scene, rays, clouds, (slot, tint), &blend.media),
        })?;
        if tinted.lost > 0 {
            let lost = tinted.lost;
            common
                .warn(format_args!("{path}: material `{name}`: {lost} samples lie on no triangle and have no texture"));
        }
        tints.push(Some(tinted));
    }
    Ok(if tints.iter().any(Option::is_some) { tints } else { Vec::new() })
}
