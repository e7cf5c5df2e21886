//! The signed difference as an image, for viewers.

use formats::image::{Attribute, Channel, Image};

/// Test minus reference of every channel, with their names and their data window; rounded once, to float32.
///
/// Both images have the same size and channels, as [`crate::compare`] has checked.
pub fn difference(reference: &Image, test: &Image) -> Image {
    let subtract = |channel: &Channel| {
        let test = test.channel(&channel.name).unwrap_or_default();
        let samples = channel.samples.iter().zip(test).map(|(reference, test)| test - reference).collect();
        Channel { name: channel.name.clone(), samples }
    };
    Image {
        width: reference.width,
        height: reference.height,
        channels: reference.channels.iter().map(subtract).collect(),
        attributes: [("comments".to_owned(), Attribute::Text("test - reference, signed".to_owned()))].into(),
        window: reference.window,
        display: reference.display,
    }
}
