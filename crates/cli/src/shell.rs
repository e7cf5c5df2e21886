//! Words of commands that a program says, as a shell takes them.

/// A word of a command, in quotes if a shell would read it otherwise.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
    let plain = !word.is_empty() && word.chars().all(is_plain);
    if plain { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::quoted;
    use std::process::Command;

    /// Seen to catch: quotes within the word left as they are, an empty word left out, a tilde and a dollar sign.
    #[test]
    fn a_shell_reads_the_word_that_was_meant() {
        for word in
            ["bunny.glb", "my bunny's \"best\".glb", "", "$HOME", "~", "a;b&c|d", "`id`", "*", "Wax=märble", "a\\b"]
        {
            let line = format!("printf %s {}", quoted(word));
            let output = Command::new("/bin/sh").args(["-c", &line]).output().expect("a shell");
            assert_eq!(String::from_utf8_lossy(&output.stdout), word, "{line}");
        }
        assert_eq!(quoted("out/k1M-s0/a_b.cloud"), "out/k1M-s0/a_b.cloud");
    }
}
