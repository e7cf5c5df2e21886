//! The two media of a surface that the alpha of its texture blends.

use crate::{ReadMediumError, blended_media};
use bssrdf::Medium;
use scene::{Scene, SurfaceColors};

/// The media of a blend.
pub struct Blended {
    /// The first is where alpha is 1.
    pub media: [Medium; 2],
    /// The medium of the mean alpha over the surface, which the programs take where they know one medium alone.
    pub mean: Medium,
}

impl Blended {
    /// The blend that the scene's file states for a material, if it states one.
    pub fn of(scene: &Scene, material: u16) -> Result<Option<Blended>, ReadMediumError> {
        let Some(stated) = scene.materials.get(usize::from(material)) else { return Ok(None) };
        let Some(media) = blended_media(stated)? else { return Ok(None) };
        let second = SurfaceColors::new(scene, material).mean_of(|color| 1.0 - color.base.w).clamp(0.0, 1.0);
        let mean = media[0].mixed(&media[1], second);
        Ok(Some(Blended { media, mean }))
    }
}
