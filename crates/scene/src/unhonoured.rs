//! What a file asks for and the picture does not show, as one line.

use crate::Scene;
use std::collections::HashMap;

/// So many properties are named, and so many of what has one.
const PROPERTIES: usize = 12;
const HOLDERS: usize = 3;

/// Bytes of a holder's name; a longer one is cut.
const LONGEST_NAME: usize = 40;

/// A property that something in the scene has, and that is not honoured.
#[derive(Clone, Debug)]
pub(crate) struct Unhonoured {
    /// With the list that its holder is in, as the file has both.
    pub property: String,
    /// What has it; none if that is the file.
    pub holder: Option<Holder>,
    /// On opaque, and on translucent surfaces: none if it is honoured there, else the numbers that it is taken as, if any.
    pub on: [Option<&'static [f64]>; 2],
}

/// What has a property.
#[derive(Clone, Debug)]
pub(crate) enum Holder {
    Material(u16),
    Named(String),
    Numbered(usize),
}

impl Scene {
    /// Adds one warning that names every property of the file that the picture does not show, though something that is
    /// drawn or lights has it. Materials are asked as what they are: `translucent` or opaque.
    pub fn warn_of_unhonoured(&mut self, translucent: impl Fn(u16) -> bool) {
        let mut found: Vec<(String, Vec<&Holder>)> = Vec::new();
        let mut known = HashMap::new();
        for one in &self.unhonoured {
            let is_translucent = matches!(&one.holder, Some(Holder::Material(k)) if translucent(*k));
            let Some(taken) = one.on[usize::from(is_translucent)] else { continue };
            let property = format!("{}{}", one.property, taken_as(taken));
            let place = *known.entry(property).or_insert_with_key(|property| {
                found.push((property.clone(), Vec::new()));
                found.len() - 1
            });
            found[place].1.extend(&one.holder);
        }
        if !found.is_empty() {
            let named: Vec<String> = found.iter().take(PROPERTIES).map(|(p, holders)| self.named(p, holders)).collect();
            let more = rest(found.len() - named.len());
            let named = named.join(", ");
            self.warnings.push(format!("not honoured: {named}{more}; docs/scenes.md says what is"));
        }
    }

    /// A property with what has it.
    fn named(&self, property: &str, holders: &[&Holder]) -> String {
        if holders.is_empty() {
            return property.to_owned();
        }
        let name = |holder: &&Holder| match holder {
            Holder::Material(k) => quoted(self.materials.get(usize::from(*k)).map_or("", |m| &m.name)),
            Holder::Named(name) => quoted(name),
            Holder::Numbered(k) => k.to_string(),
        };
        let first: Vec<String> = holders.iter().take(HOLDERS).map(name).collect();
        format!("{property} ({}{})", first.join(", "), rest(holders.len() - first.len()))
    }
}

fn taken_as(numbers: &[f64]) -> String {
    match numbers {
        [] => String::new(),
        [first, others @ ..] if others.iter().all(|x| x == first) => format!(" taken as {first}"),
        all => format!(" taken as {all:?}"),
    }
}

/// A name of a file in a message.
pub(crate) fn quoted(name: &str) -> String {
    format!("`{}`", cut(name, LONGEST_NAME))
}

/// Text of no more than so many bytes, and a mark if there were more.
pub(crate) fn cut(text: &str, bytes: usize) -> String {
    if text.len() <= bytes { text.to_owned() } else { format!("{}…", &text[..text.floor_char_boundary(bytes)]) }
}

/// How many there are beyond those that were named.
pub(crate) fn rest(count: usize) -> String {
    if count == 0 { String::new() } else { format!(" and {count} more") }
}
