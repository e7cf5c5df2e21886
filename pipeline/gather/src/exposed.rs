//! The exposure of a run's previews, and the backdrop that goes with it.

use crate::{image_jobs::ImageJob, settings::Request};
use cli::{Failure, LitScene};
use gather::{Input, exposure};
use scene::{DVec3, Rays};
use tint::Tinted;

/// Radiance of the backdrop times the exposure: a dark gray, before which both light and dark edges show.
const BACKDROP: f64 = 0.06;

/// Gives all images of a request one exposure: that of the translucent surfaces as they are seen from all around,
/// unless it is fixed. Says by how much the previews are brightened.
pub fn expose(
    request: &Request,
    (inputs, tints): (&LitScene, &[Option<Tinted>]),
    rays: &Rays,
    jobs: &mut [ImageJob],
) -> Result<(), Failure> {
    let outputs = &request.outputs;
    let Some(first) = jobs.first().filter(|_| outputs.preview.is_some() || request.backdrop) else {
        return Ok(());
    };
    let camera = first.camera.clone();
    let (scene, clouds, media) = (&inputs.scene, inputs.clouds(), &inputs.media);
    let input = Input { scene, rays, clouds, media, tints, calibration: None, camera: &camera };
    let automatic = match outputs.exposure_fixed {
        true => 0.0,
        false => request.common.in_pool(|| exposure::brightness(&input))?.map_or(0.0, exposure::stops),
    };
    for job in jobs {
        job.stops = automatic + outputs.exposure;
        job.settings.backdrop = request.backdrop.then(|| DVec3::splat(BACKDROP * (-automatic).exp2()));
    }
    if outputs.preview.is_some() && !outputs.exposure_fixed {
        request.common.say(format_args!(
            "previews of this cloud and these media are exposed by {automatic:+.2} stops; --exposure adds to that"
        ));
    }
    Ok(())
}
