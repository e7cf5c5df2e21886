//! The channels of both images, grouped into layers, and the choice of layers that gates judge.

use formats::image::Image;

use crate::metric::Pair;

/// The name of the layer of the picture itself.
pub(crate) const BEAUTY: &str = "beauty";

/// The channels without a layer that hold the coverage of each pixel, for all colors or for one. They belong to the
/// picture, but are layers of their own, because the metrics of the picture would hide its faults if alpha were part of
/// it.
pub(crate) const ALPHA: [&str; 4] = ["A", "AR", "AG", "AB"];

/// The order of the channels of a layer. Other channels follow by name.
const ORDER: [&str; 9] = ["R", "G", "B", "A", "X", "Y", "Z", "RY", "BY"];

/// A layer of both images.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    /// The part of the channels' names before the last dot. Channels without a dot are `beauty` if they are the
    /// picture, else layers of their own name.
    pub name: String,
    /// The names after the dot with their samples: first R, G, B, A, X, Y, Z, RY, BY in this order, then others by
    /// name.
    pub channels: Vec<(String, Pair<'a>)>,
}

impl<'a> Layer<'a> {
    /// The samples of the layer, channel after channel.
    pub fn samples(&self) -> Vec<Pair<'a>> {
        self.channels.iter().map(|(_, samples)| *samples).collect()
    }
}

/// The layers of two images with the same channels: beauty first, then by name.
pub(crate) fn layers<'a>(reference: &'a Image, test: &'a Image) -> Vec<Layer<'a>> {
    let mut layers: Vec<Layer<'a>> = Vec::new();
    let picture = picture(reference);
    for channel in &reference.channels {
        let (layer, name) = split(&channel.name, picture);
        let Some(samples) = test.channel(&channel.name) else { continue };
        let entry = (name.to_owned(), (channel.samples.as_slice(), samples));
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

/// The channels without a layer that are the picture: red, green and blue with a luminance, else CIE X, Y and Z, else
/// luminance with its chroma. X and Z without Y are something else, such as depth.
fn picture(image: &Image) -> &'static [&'static str] {
    let has = |name: &&str| image.channels.iter().any(|channel| channel.name == *name);
    match () {
        () if ["R", "G", "B"].iter().any(has) => &["R", "G", "B", "Y"],
        () if ["X", "Y", "Z"].iter().all(has) => &["X", "Y", "Z"],
        () if has(&"Y") => &["Y", "RY", "BY"],
        () => &[],
    }
}

fn split<'a>(channel: &'a str, picture: &[&str]) -> (&'a str, &'a str) {
    match channel.rsplit_once('.') {
        Some((layer, name)) => (layer, name),
        None if picture.contains(&channel) => (BEAUTY, channel),
        None => (channel, channel),
    }
}

/// The layers that the gates judge.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// The beauty layer and its alpha; for `exact`, which is about the file, all layers.
    #[default]
    Default,
    /// All layers.
    All,
    /// The layer of this name.
    Named(String),
}

impl Choice {
    /// The choice by the name of a layer, or by `all`. `beauty` is a layer like any other if it is named.
    pub fn new(name: Option<&str>) -> Choice {
        match name {
            None => Choice::Default,
            Some("all") => Choice::All,
            Some(name) => Choice::Named(name.to_owned()),
        }
    }

    /// The name of the layer, which is beauty by default, or `None` for all layers.
    pub(crate) fn layer(&self) -> Option<&str> {
        match self {
            Choice::Default => Some(BEAUTY),
            Choice::All => None,
            Choice::Named(name) => Some(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use formats::image::Channel;

    use super::*;

    #[test]
    fn channels_are_grouped_by_the_name_before_the_dot() {
        let names = ["A", "B", "G", "N.X", "R", "Z", "a.b.R", "subsurface.B", "subsurface.G", "subsurface.R"];
        assert_eq!(found(&names), ["beauty RGB", "A A", "N X", "Z Z", "a.b R", "subsurface RGB"]);
    }

    /// Seen to catch: a picture of X, Y and Z, or of luminance and chroma, of which only Y was judged.
    #[test]
    fn a_picture_without_colors_is_one_layer() {
        assert_eq!(found(&["X", "Y", "Z"]), ["beauty XYZ"]);
        assert_eq!(found(&["A", "BY", "RY", "Y"]), ["beauty YRYBY", "A A"]);
        assert_eq!(found(&["Y", "Z"]), ["beauty Y", "Z Z"]);
        assert_eq!(found(&["X", "Z"]), ["X X", "Z Z"]);
        assert_eq!(found(&["B", "BY", "G", "R", "X", "Y", "Z"]), ["beauty RGBY", "BY BY", "X X", "Z Z"]);
    }

    /// The names of the layers with those of their channels.
    fn found(names: &[&str]) -> Vec<String> {
        let channels = names.iter().map(|name| Channel { name: (*name).to_owned(), samples: vec![0.0] }).collect();
        let image = Image { width: 1, height: 1, channels, ..Image::default() };
        let name = |layer: &Layer<'_>| {
            format!("{} {}", layer.name, layer.channels.iter().map(|(name, _)| name.as_str()).collect::<String>())
        };
        layers(&image, &image).iter().map(name).collect()
    }
}
