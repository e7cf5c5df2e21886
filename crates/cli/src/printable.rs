//! Names from files, made safe for a terminal and for messages of one line.

use std::borrow::Cow;

/// The text with every character that a terminal would obey, or that would end or reorder a line, shown as its escape:
/// a newline as `\n`, the escape character as `\u{1b}`. All other text stays as it is.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_obeyed(c) { safe.extend(c.escape_debug()) } else { safe.push(c) }
    }
    Cow::Owned(safe)
}

/// Control characters (C0, delete, C1), line and paragraph separators, what changes the direction of writing, and the
/// byte order mark.
fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::printable;

    /// Planted errors that this caught: the C1 controls (of which U+009B begins a terminal's command), the separators and
    /// the marks of direction left out.
    #[test]
    fn nothing_is_left_that_a_terminal_obeys() {
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
