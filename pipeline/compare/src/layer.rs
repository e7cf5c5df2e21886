//! Channels of both images, grouped into layers.

use formats::image::Image;

use crate::metric::Samples;

/// Name of the layer of the picture itself.
pub(crate) const BEAUTY: &str = "beauty";

/// Colours before alpha; other channels follow by name.
const ORDER: [&str; 4] = ["R", "G", "B", "A"];

/// A layer of both images.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    /// What comes before the last dot; `beauty` for R, G, B and Y without one; else the channel's own name.
    pub name: String,
    /// Names after the dot, with their samples; R, G, B, A come in this order, then others by name.
    pub channels: Vec<(String, Samples<'a>)>,
}

impl<'a> Layer<'a> {
    /// All samples of the layer, channel after channel.
    pub fn samples(&self) -> Samples<'a> {
        Samples { planes: self.channels.iter().flat_map(|(_, samples)| samples.planes.iter().copied()).collect() }
    }
}

/// Both images have the same channels. Beauty first, then by name.
pub(crate) fn layers<'a>(reference: &'a Image, test: &'a Image) -> Vec<Layer<'a>> {
    let mut layers: Vec<Layer<'a>> = Vec::new();
    for channel in &reference.channels {
        let (layer, name) = split(&channel.name);
        let Some(samples) = test.channel(&channel.name) else { continue };
        let entry = (name.to_owned(), Samples { planes: vec![(channel.samples.as_slice(), samples)] });
        match layers.iter_mut().find(|known| known.name == layer) {
            Some(known) => known.channels.push(entry),
            None => layers.push(Layer { name: layer.to_owned(), channels: vec![entry] }),
        }
    }
    for layer in &mut layers {
        layer.channels.sort_by_key(|(name, _)| {
            (ORDER.iter().position(|known| known == name).unwrap_or(ORDER.len()), name.clone())
        });
    }
    layers.sort_by_key(|layer| (layer.name != BEAUTY, layer.name.clone()));
    layers
}

/// Depth and alpha are not colour: mixed into the picture's metrics they would hide its faults.
fn split(channel: &str) -> (&str, &str) {
    match channel.rsplit_once('.') {
        Some((layer, name)) => (layer, name),
        None if ["R", "G", "B", "Y"].contains(&channel) => (BEAUTY, channel),
        None => (channel, channel),
    }
}

#[cfg(test)]
mod tests {
    use formats::image::Channel;

    use super::*;

    #[test]
    fn channels_are_grouped_by_the_name_before_the_dot() {
        let names = ["A", "B", "G", "N.X", "R", "Z", "a.b.R", "subsurface.B", "subsurface.G", "subsurface.R"];
        let channels = names.map(|name| Channel { name: name.to_owned(), samples: vec![0.0] }).to_vec();
        let image = Image { width: 1, height: 1, channels, ..Image::default() };
        let found: Vec<String> = layers(&image, &image)
            .iter()
            .map(|layer| {
                format!("{} {}", layer.name, layer.channels.iter().map(|(name, _)| name.as_str()).collect::<String>())
            })
            .collect();
        assert_eq!(found, ["beauty RGB", "A A", "N X", "Z Z", "a.b R", "subsurface RGB"]);
    }
}
