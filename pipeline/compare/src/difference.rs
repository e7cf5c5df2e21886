//! The signed difference as an image, for viewers.

use formats::image::{Attribute, Channel, Image};

use crate::meaning;

/// Two finite samples are further apart than float32 reaches.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "channel {channel} at pixel {},{} differs by {difference:.3e}, which float32 does not hold; leave out --diff-exr", pixel[0], pixel[1]
)]
pub struct TooFar {
    /// Its name with its layer.
    pub channel: String,
    /// Column and row in the coordinates of the data window.
    pub pixel: [i64; 2],
    /// Test minus reference.
    pub difference: f64,
}

/// Test minus reference of every channel, with their names, their windows and what gives them their meaning; rounded once,
/// to float32. Where a sample is not finite, neither is the difference.
///
/// Both images have the same size and channels, as [`crate::compare`] has checked.
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
    let mut attributes = meaning::kept(reference);
    attributes.insert("comments".to_owned(), Attribute::Text("test - reference, signed".to_owned()));
    Ok(Image {
        width: reference.width,
        height: reference.height,
        channels: reference.channels.iter().map(subtract).collect::<Result<_, _>>()?,
        attributes,
        window: reference.window,
        display: reference.display,
    })
}
