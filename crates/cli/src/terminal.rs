//! Lines for people, in which names from files are safe for a terminal.

use std::{
    borrow::Cow,
    fmt::Display,
    io::{self, Write},
};

/// Prints a line on stderr, with the names in it made safe for a terminal. A closed stderr is no failure.
pub(crate) fn tell(line: impl Display) {
    writeln!(io::stderr(), "{}", printable(&line.to_string())).ok();
}

/// The text with an escape for every character that controls a terminal, or that would end or reorder a line: `\n` for
/// a newline, `\u{1b}` for the escape character. All other text is unchanged.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_unsafe) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_unsafe(c) { safe.extend(c.escape_debug()) } else { safe.push(c) }
    }
    Cow::Owned(safe)
}

/// Whether a character is a control character (C0, delete, C1), a line or paragraph separator, a mark of the direction
/// of writing, or the byte order mark.
fn is_unsafe(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::printable;

    /// Seen to catch: the C1 controls (of which U+009B begins a terminal's command), the separators, and the marks of
    /// direction left out.
    #[test]
    fn no_character_is_left_that_controls_a_terminal() {
        for (name, safe) in [
            ("Wax", "Wax"),
            ("Käse, 蝋, 🕯", "Käse, 蝋, 🕯"),
            ("a\nPASS", "a\\nPASS"),
            ("\u{1b}[2Jx\r\t\u{7}", "\\u{1b}[2Jx\\r\\t\\u{7}"),
            ("\u{9b}31m", "\\u{9b}31m"),
            ("\u{202e}fdp.exr\u{2066}", "\\u{202e}fdp.exr\\u{2066}"),
            ("one\u{2028}two\u{85}three", "one\\u{2028}two\\u{85}three"),
        ] {
            assert_eq!(printable(name), safe, "{name:?}");
        }
    }
}
