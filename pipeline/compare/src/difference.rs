//! The signed difference of two images as an image.

use formats::image::{Attribute, Channel, Image};

use crate::meaning;

/// The difference of two finite samples is beyond float32.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "channel {channel} at pixel {},{} differs by {difference:.3e}, which float32 does not hold", pixel[0], pixel[1]
)]
pub struct TooFar {
    /// The name of the channel with that of its layer.
    pub channel: String,
    /// The column and row in the coordinates of the data window.
    pub pixel: [i64; 2],
    /// The difference, test minus reference.
    pub difference: f64,
}

/// Test minus reference of every channel, rounded once, to float32. The names of the channels, the windows and the
/// attributes that give the numbers their meaning are those of the reference. Where a sample is not finite, neither is
/// the difference.
///
/// Both images must have the same size and channels, as [`crate::compare()`] checks.
pub fn difference(reference: &Image, test: &Image) -> Result<Image, TooFar> {
    let subtract = |channel: &Channel| {
        let test = test.channel(&channel.name).unwrap_or_default();
        let samples: Vec<f32> = channel.samples.iter().zip(test).map(|(reference, test)| test - reference).collect();
        let overflows =
            |i: &usize| samples[*i].is_infinite() && channel.samples[*i].is_finite() && test[*i].is_finite();
        match (0..samples.len()).find(overflows) {
            None => Ok(Channel { name: channel.name.clone(), samples }),
            Some(i) => Err(TooFar {
                channel: channel.name.clone(),
                pixel: [(i % reference.width, 0), (i / reference.width, 1)]
                    .map(|(offset, axis)| offset as i64 + i64::from(reference.window[axis])),
                difference: f64::from(test[i]) - f64::from(channel.samples[i]),
            }),
        }
    };
    let channels = reference.channels.iter().map(subtract).collect::<Result<_, _>>()?;
    let mut image = meaning::computed_from(reference, channels);
    image.attributes.insert("comments".to_owned(), Attribute::Text("test - reference, signed".to_owned()));
    Ok(image)
}
