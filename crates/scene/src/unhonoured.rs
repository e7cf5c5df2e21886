//! Properties of a file that the image does not show, and how messages name things.

/// Bytes of a name in a message; a longer one is cut.
const MAX_NAME_BYTES: usize = 40;

/// A property of something in the scene that the image does not show.
#[derive(Clone, Debug)]
pub(crate) struct Unhonoured {
    /// Its name in the file, with that of the list that its holder is in.
    pub property: String,
    /// The holder of the property; none for the file itself.
    pub holder: Option<Holder>,
    /// On opaque and on translucent surfaces: none if it is honoured there, else the numbers that stand in for it, if
    /// any.
    pub on: [Option<&'static [f64]>; 2],
}

/// The holder of a property.
#[derive(Clone, Debug)]
pub(crate) enum Holder {
    Material(u16),
    Named(String),
    Numbered(usize),
}

/// A name that a file gives, for a message.
pub(crate) fn quoted(name: &str) -> String {
    format!("`{}`", cut(name, MAX_NAME_BYTES))
}

/// The text, cut after this number of bytes, with a mark if it was longer.
pub(crate) fn cut(text: &str, bytes: usize) -> String {
    if text.len() <= bytes { text.to_owned() } else { format!("{}…", &text[..text.floor_char_boundary(bytes)]) }
}

/// At most `max` of these names, and how many more there are.
pub(crate) fn first_of(names: impl ExactSizeIterator<Item = String>, max: usize) -> String {
    let left_out = names.len().saturating_sub(max);
    let named = names.take(max).collect::<Vec<_>>().join(", ");
    if left_out == 0 { named } else { format!("{named} and {left_out} more") }
}
