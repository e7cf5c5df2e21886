//! The attributes of a header that give the numbers of the channels their meaning: equal numbers with other primaries,
//! or of pixels of another shape, are another picture.

use std::collections::BTreeMap;

use formats::image::{Attribute, Channel, Image, Window};
use serde::{Deserialize, Serialize};

/// An attribute of the header, and the consequence if the images disagree about it.
struct Rule {
    name: &'static str,
    /// The meaning of its absence by the OpenEXR standard, in the words of [`words`], or `None` if the standard has
    /// none.
    absent: Option<&'static str>,
    /// The largest difference of two numbers that count as equal.
    tolerance: f64,
    /// What can be done if the images cannot be compared. `None` is for the position of the camera, a change of which
    /// shows in the pixels, so that it is only reported.
    way_out: Option<&'static str>,
}

/// The tolerance for primaries, which programs round to three or four digits.
const ROUNDED: f64 = 5e-4;
const EXACT: f64 = 0.0;
/// The tolerance for the rounding of a matrix that was multiplied in float32.
const MATRIX: f64 = 1e-5;

const RENDER: &str = "write both with one setting of the renderer";
/// The display window, which is a field of an image in memory and not an attribute.
const DISPLAY: &str = "displayWindow";
const AS_DATA: &str = "the data window";

/// The attributes that are compared, by name. Others describe how the file was made or is to be shown. The data window
/// is compared in `structure.rs`.
#[rustfmt::skip]
const RULES: [Rule; 13] = [
    Rule { name: "acesImageContainerFlag", absent: None, tolerance: EXACT, way_out: Some("convert one of them") },
    Rule { name: "adoptedNeutral", absent: None, tolerance: ROUNDED, way_out: Some("convert one of them") },
    Rule { name: "chromaticities", absent: Some("0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329"), tolerance: ROUNDED,
        way_out: Some("convert one to the primaries of the other, or correct the header that is wrong") },
    Rule { name: "colorInteropID", absent: None, tolerance: EXACT, way_out: Some("convert one of them") },
    Rule { name: DISPLAY, absent: Some(AS_DATA), tolerance: EXACT, way_out: Some(RENDER) },
    Rule { name: "envmap", absent: Some("no environment"), tolerance: EXACT, way_out: Some("convert one of them") },
    Rule { name: "multiView", absent: None, tolerance: EXACT, way_out: Some(RENDER) },
    Rule { name: "pixelAspectRatio", absent: Some("1"), tolerance: 1e-6, way_out: Some(RENDER) },
    Rule { name: "screenWindowCenter", absent: Some("0, 0"), tolerance: 1e-6, way_out: Some(RENDER) },
    Rule { name: "screenWindowWidth", absent: Some("1"), tolerance: 1e-6, way_out: Some(RENDER) },
    Rule { name: "view", absent: None, tolerance: EXACT, way_out: Some("compare images of one view") },
    Rule { name: "whiteLuminance", absent: None, tolerance: 1e-3, way_out: Some("scale one of them") },
    Rule { name: "worldToCamera", absent: None, tolerance: MATRIX, way_out: None },
];

/// The attributes with their values, by name, except those whose value is the meaning of their absence.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Meaning(BTreeMap<String, String>);

/// An attribute about which two headers disagree.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{name} is {test}, but {reference} in the reference, so that equal numbers do not mean the same; {way_out}")]
pub struct Difference {
    /// The name of the attribute.
    pub name: &'static str,
    /// Its value, or the meaning of its absence.
    pub reference: String,
    /// Its value, or the meaning of its absence.
    pub test: String,
    /// The remedy.
    pub way_out: &'static str,
}

impl Meaning {
    pub(crate) fn of(image: &Image) -> Meaning {
        let found = RULES.iter().filter_map(|rule| {
            let value = match (rule.name, image.display) {
                (DISPLAY, display) => window(display?),
                (name, _) => of_all_parts(image, name)?,
            };
            let usual = rule.absent.is_some_and(|absent| rule.agree(absent, &value));
            (!usual).then(|| (rule.name.to_owned(), value))
        });
        Meaning(found.collect())
    }

    /// The attributes that decide whether images can be compared.
    pub(crate) fn judged(mut self) -> Meaning {
        RULES.iter().filter(|rule| rule.way_out.is_none()).for_each(|rule| drop(self.0.remove(rule.name)));
        self
    }

    pub(crate) fn is_usual(&self) -> bool {
        self.0.is_empty()
    }

    /// The first attribute by which the two cannot be compared.
    pub(crate) fn difference(&self, reference: &Meaning) -> Option<Difference> {
        RULES.iter().find_map(|rule| {
            let way_out = rule.way_out?;
            let [reference, test] = [reference, self].map(|meaning| meaning.value(rule));
            let (reference, test) = (reference?, test?);
            (!rule.agree(&reference, &test)).then_some(Difference { name: rule.name, reference, test, way_out })
        })
    }

    /// Further remarks: attributes that differ but are not judged, and those that one header alone has.
    pub(crate) fn notes(&self, reference: &Meaning) -> Vec<String> {
        let only = |rule: &Rule, image| {
            Some(format!("{} is in the {image} only, so that another value would not be noticed", rule.name))
        };
        let note = |rule: &Rule| match [reference, self].map(|meaning| meaning.value(rule)) {
            [Some(_), None] => only(rule, "reference"),
            [None, Some(_)] => only(rule, "test image"),
            [Some(reference), Some(test)] if !rule.agree(&reference, &test) => {
                Some(format!("{} differs and is not judged: the cameras stand at different places", rule.name))
            }
            _ => None,
        };
        RULES.iter().filter_map(note).collect()
    }

    fn value(&self, rule: &Rule) -> Option<String> {
        self.0.get(rule.name).cloned().or_else(|| rule.absent.map(str::to_owned))
    }
}

impl Rule {
    /// Whether two values are equal. Numbers may differ by the tolerance.
    fn agree(&self, one: &str, other: &str) -> bool {
        let numbers =
            |text: &str| text.split(", ").map(|number| number.parse::<f64>().ok()).collect::<Option<Vec<_>>>();
        one == other
            || match (numbers(one), numbers(other)) {
                (Some(one), Some(other)) => {
                    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= self.tolerance * a.abs().max(b.abs()).max(1.0);
                    one.len() == other.len() && one.iter().zip(&other).all(near)
                }
                _ => false,
            }
    }
}

/// An image of these channels that were computed from another image. It keeps the attributes that give the numbers
/// their meaning.
pub(crate) fn computed_from(image: &Image, channels: Vec<Channel>) -> Image {
    let kept = image.attributes.iter().filter(|(name, _)| RULES.iter().any(|rule| rule.name == **name));
    let attributes = kept.map(|(name, value)| (name.clone(), value.clone())).collect();
    let Image { width, height, window, display, .. } = *image;
    Image { width, height, channels, attributes, window, display }
}

/// The value of an attribute, or the values of all parts if the parts of a file disagree.
fn of_all_parts(image: &Image, name: &str) -> Option<String> {
    let of_part = format!("{name} of part ");
    let others = image.attributes.iter().filter(|(other, _)| other.starts_with(&of_part));
    let others = others.map(|(other, value)| format!(", but {} in part {}", words(value), &other[of_part.len()..]));
    Some(words(image.attributes.get(name)?) + &others.collect::<String>())
}

fn window(Window { position: [x, y], size: [width, height] }: Window) -> String {
    format!("{width} x {height} pixels at [{x}, {y}]")
}

/// The value of an attribute in words.
pub(crate) fn words(value: &Attribute) -> String {
    let list = |numbers: &[f32]| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(", ");
    match value {
        Attribute::Text(text) => text.clone(),
        Attribute::Float(number) => number.to_string(),
        Attribute::Double(number) => number.to_string(),
        Attribute::Int(number) => number.to_string(),
        Attribute::Vector(numbers) => list(numbers),
        Attribute::Matrix(numbers) => list(numbers),
        Attribute::Chromaticities(numbers) => list(numbers),
        Attribute::Texts(texts) => texts.join("\n"),
        Attribute::Other { kind, value } => other(kind, value),
    }
}

fn other(kind: &str, value: &[u8]) -> String {
    match (kind, value) {
        ("envmap", [0]) => "latitude and longitude".to_owned(),
        ("envmap", [1]) => "cube".to_owned(),
        ("v2f", _) if value.len() == 8 => {
            let numbers = value.as_chunks::<4>().0.iter();
            numbers.map(|bytes| f32::from_le_bytes(*bytes).to_string()).collect::<Vec<_>>().join(", ")
        }
        _ => format!("{kind} of {} bytes, {}", value.len(), &blake3::hash(value).to_hex()[..16]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(attributes: &[(&str, Attribute)]) -> Image {
        let attributes = attributes.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        Image { width: 4, height: 3, attributes, ..Image::default() }
    }

    #[test]
    fn what_is_absent_means_what_the_standard_says() {
        let rec709 = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.312_71, 0.329_02];
        let center = Attribute::Other { kind: "v2f".to_owned(), value: vec![0; 8] };
        let usual = image(&[
            ("chromaticities", Attribute::Chromaticities(rec709)),
            ("pixelAspectRatio", Attribute::Float(1.0)),
            ("screenWindowCenter", center),
            ("capDate", Attribute::Text("2024".to_owned())),
        ]);
        assert!(Meaning::of(&usual).is_usual());
    }

    /// Seen to catch: each row of the table left out.
    #[test]
    fn every_attribute_of_the_table_is_looked_at() {
        let other = |kind: &str, value: &[u8]| Attribute::Other { kind: kind.to_owned(), value: value.to_vec() };
        let text = |text: &str| Attribute::Text(text.to_owned());
        let aces = [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.321_68, 0.337_67];
        for (name, one, two) in [
            ("acesImageContainerFlag", Some(Attribute::Int(0)), Attribute::Int(1)),
            ("adoptedNeutral", Some(other("v2f", &[0; 8])), other("v2f", &[0, 0, 0, 63, 0, 0, 0, 63])),
            ("chromaticities", None, Attribute::Chromaticities(aces)),
            ("colorInteropID", Some(text("lin_rec709_scene")), text("lin_ap1_scene")),
            ("envmap", None, other("envmap", &[0])),
            ("envmap", Some(other("envmap", &[1])), other("envmap", &[0])),
            ("multiView", Some(Attribute::Texts(vec!["left".into()])), Attribute::Texts(vec!["right".into()])),
            ("pixelAspectRatio", None, Attribute::Float(2.0)),
            ("screenWindowCenter", None, other("v2f", &[0, 0, 0, 63, 0, 0, 0, 0])),
            ("screenWindowWidth", None, Attribute::Float(0.5)),
            ("view", Some(text("left")), text("right")),
            ("whiteLuminance", Some(Attribute::Float(100.0)), Attribute::Float(203.0)),
        ] {
            let of = |value: Option<&Attribute>| {
                Meaning::of(&image(&value.map(|value| (name, value.clone())).into_iter().collect::<Vec<_>>()))
            };
            let (one, two) = (of(one.as_ref()), of(Some(&two)));
            for (test, reference) in [(&one, &two), (&two, &one)] {
                assert_eq!(test.difference(reference).map(|found| found.name), Some(name));
            }
            assert!(two.difference(&two).is_none() && two.notes(&two).is_empty());
        }
        let views = |second: &str| Meaning::of(&image(&[("view", text("left")), ("view of part 2", text(second))]));
        assert_eq!(views("right").difference(&views("front")).unwrap().test, "left, but right in part 2");
        assert!(views("right").difference(&views("right")).is_none());
        let shown = |size| Meaning::of(&Image { display: Some(Window { position: [0, 0], size }), ..image(&[]) });
        assert_eq!(shown([8, 8]).difference(&Meaning::default()).unwrap().reference, "the data window");
        assert!(shown([8, 8]).difference(&shown([8, 9])).is_some());
    }

    #[test]
    fn what_one_header_alone_says_is_told() {
        let white = Meaning::of(&image(&[("whiteLuminance", Attribute::Float(100.0))]));
        assert!(white.difference(&Meaning::default()).is_none());
        assert!(white.notes(&Meaning::default())[0].contains("whiteLuminance is in the test image only"));
        let camera = |x| Meaning::of(&image(&[("worldToCamera", Attribute::Matrix([x; 16]))]));
        assert!(camera(1.0).difference(&camera(2.0)).is_none());
        assert!(camera(1.0).notes(&camera(2.0))[0].contains("worldToCamera differs and is not judged"));
        assert!(camera(1.0).notes(&camera(1.000_001)).is_empty() && camera(1.0).judged().is_usual());
    }
}
