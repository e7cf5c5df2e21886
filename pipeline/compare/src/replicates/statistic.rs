//! The statistics of an image: a few means over many pixels, so that they are nearly normally distributed.
//!
//! They are the channel means of every color layer, and the brightness and color of nine tiles of the subsurface layer,
//! because a fault may brighten one side and darken the other. Ratios of channels do not have the noise that the
//! channels share: the color of skin is known ten times better than its brightness. The last statistic is the noise
//! that the image claims.

use formats::image::Image;
use serde::{Deserialize, Serialize};

/// The number of tiles along each side of the picture.
const TILES: usize = 3;
/// The layer that has tiles and colors, and whose variance between replicates is tested.
const SCATTERED: &str = "subsurface";
/// The channels of a color layer.
const RGB: [&str; 3] = ["R", "G", "B"];

/// The quantity that a statistic measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A mean radiance in W/(m² sr).
    Light,
    /// A mean radiance in W/(m² sr) whose variance between replicates is tested too.
    Scatter,
    /// A ratio of the radiances of two channels. Older files have the British spelling.
    #[serde(alias = "colour")]
    Color,
    /// The mean standard error of the pixels in W/(m² sr). Only its growth is a fault.
    Noise,
}

/// One statistic of one image.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statistic {
    pub name: String,
    pub kind: Kind,
    pub value: f64,
}

/// The statistics of an image. Images with the same channels have the same names in the same order.
pub(super) fn statistics(image: &Image) -> Vec<Statistic> {
    let mut found = Vec::new();
    for layer in color_layers(image) {
        let kind = if layer == SCATTERED { Kind::Scatter } else { Kind::Light };
        let means = means(image, &layer, |_, _| true);
        for (channel, mean) in RGB.iter().zip(means) {
            found.push(Statistic { name: format!("{} {channel}", shown(&layer)), kind, value: mean });
        }
        if layer == SCATTERED {
            found.extend(colors(shown(&layer), means));
            found.extend((0..TILES * TILES).flat_map(|tile| of_tile(image, &layer, tile)));
        }
    }
    found.extend(noise(image));
    found
}

/// The index of the tile of a pixel; tiles are numbered row after row.
fn tile_of(image: &Image, x: usize, y: usize) -> usize {
    y * TILES / image.height * TILES + x * TILES / image.width
}

/// The brightness and color of one tile.
fn of_tile(image: &Image, layer: &str, tile: usize) -> Vec<Statistic> {
    let means = means(image, layer, |x, y| tile_of(image, x, y) == tile);
    let name = format!("{} tile {},{}", shown(layer), tile % TILES, tile / TILES);
    let light = Statistic { name: format!("{name} R+G+B"), kind: Kind::Light, value: means.iter().sum() };
    [light].into_iter().chain(colors(&name, means)).collect()
}

/// The ratios of the channels.
fn colors(name: &str, [red, green, blue]: [f64; 3]) -> [Statistic; 2] {
    [("R/G", red / green), ("B/G", blue / green)].map(|(ratio, value)| Statistic {
        name: format!("{name} {ratio}"),
        kind: Kind::Color,
        value,
    })
}

/// The channel means over the pixels of a part of the image.
fn means(image: &Image, layer: &str, inside: impl Fn(usize, usize) -> bool) -> [f64; 3] {
    let pixels: Vec<usize> =
        (0..image.width * image.height).filter(|pixel| inside(pixel % image.width, pixel / image.width)).collect();
    RGB.map(|channel| {
        let samples = image.channel(&full(layer, channel)).unwrap_or_default();
        pixels.iter().map(|pixel| f64::from(samples[*pixel])).sum::<f64>() / pixels.len().max(1) as f64
    })
}

/// The mean standard errors. The root gives less weight to the few pixels that the mirror image of a lamp makes very
/// noisy.
fn noise(image: &Image) -> impl Iterator<Item = Statistic> + '_ {
    RGB.iter().filter_map(|channel| {
        let variances = image.channel(&full("variance", channel))?;
        let sum: f64 = variances.iter().map(|variance| f64::from(*variance).sqrt()).sum();
        let value = sum / variances.len().max(1) as f64;
        Some(Statistic { name: format!("noise {channel}"), kind: Kind::Noise, value })
    })
}

/// The layers with red, green and blue in order of name. The picture itself has no name and comes first.
fn color_layers(image: &Image) -> Vec<String> {
    let reds = image.channels.iter().filter_map(|channel| match channel.name.rsplit_once('.') {
        Some((layer, "R")) => Some(layer.to_owned()),
        None if channel.name == "R" => Some(String::new()),
        _ => None,
    });
    let whole = |layer: &String| RGB.iter().all(|channel| image.channel(&full(layer, channel)).is_some());
    let mut layers: Vec<String> = reds.filter(|layer| layer != "variance" && whole(layer)).collect();
    layers.sort();
    layers
}

/// The name of a layer in the report.
fn shown(layer: &str) -> &str {
    if layer.is_empty() { "beauty" } else { layer }
}

/// The name of a channel with that of its layer.
fn full(layer: &str, channel: &str) -> String {
    if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") }
}

/// The smallest share of its layer's light with which a tile is tested, relative to an equal share.
const MIN_SHARE: f64 = 0.25;

/// Whether a statistic is of a tile that is nearly all background. `light` finds the mean of the reference by name.
pub(super) fn is_background(name: &str, light: impl Fn(&str) -> f64) -> bool {
    let Some((layer, rest)) = name.split_once(" tile ") else { return false };
    let tile = rest.split(' ').next().unwrap_or_default();
    let whole: f64 = RGB.iter().map(|channel| light(&format!("{layer} {channel}"))).sum();
    let enough = light(&format!("{layer} tile {tile} R+G+B")) >= MIN_SHARE * whole;
    // The comparison is written so that a share of NaN is background.
    !enough
}

#[cfg(test)]
mod tests {
    use formats::image::Channel;

    use super::*;

    /// A picture of six by six pixels: red is 1 in the left tiles, 2 in the middle and 3 on the right, green is 2, blue
    /// is 4.
    fn picture() -> Image {
        let red = (0..36).map(|pixel| ((pixel % 6) / 2 + 1) as f32).collect::<Vec<_>>();
        let planes = [red, vec![2.0; 36], vec![4.0; 36]];
        let layer = |layer: &'static str| {
            let planes = planes.clone();
            RGB.iter().zip(planes).map(move |(name, samples)| Channel { name: full(layer, name), samples })
        };
        let channels = layer("").chain(layer("subsurface")).chain(layer("variance")).collect();
        Image { width: 6, height: 6, channels, ..Image::default() }
    }

    #[test]
    fn known_values() {
        let found = statistics(&picture());
        let value = |name: &str| found.iter().find(|statistic| statistic.name == name).unwrap().value;
        assert_eq!((value("beauty R"), value("subsurface R"), value("subsurface B")), (2.0, 2.0, 4.0));
        assert_eq!((value("subsurface R/G"), value("subsurface B/G")), (1.0, 2.0));
        assert_eq!((value("subsurface tile 0,2 R+G+B"), value("subsurface tile 2,0 R+G+B")), (7.0, 9.0));
        assert_eq!((value("subsurface tile 2,1 R/G"), value("noise B")), (1.5, 2.0));
        assert_eq!(found.len(), 3 + 3 + 2 + 27 + 3);
    }

    /// Seen to catch: the attribute `alias` left out.
    #[test]
    fn statistics_with_the_older_spelling_are_read() {
        let read = |word: &str| serde_json::from_str::<Kind>(word).expect("a kind");
        assert_eq!([read("\"colour\""), read("\"color\"")], [Kind::Color; 2]);
        assert_eq!(serde_json::to_string(&Kind::Color).expect("writes"), "\"color\"");
    }

    #[test]
    fn a_tile_with_little_light_is_background() {
        let light = |name: &str| match name {
            "subsurface tile 0,0 R+G+B" => 0.9,
            "subsurface tile 1,0 R+G+B" => f64::NAN,
            name if name.contains("tile") => 1.1,
            _ => 4.0 / 3.0,
        };
        let background = |name: &str| is_background(name, light);
        assert!(background("subsurface tile 0,0 R/G") && background("subsurface tile 1,0 R+G+B"));
        assert!(!background("subsurface tile 1,1 R/G") && !background("subsurface R"));
    }
}
