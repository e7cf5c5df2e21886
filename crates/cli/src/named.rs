//! Finds the camera or material of a scene that a word on a command line means.

/// A camera or material that a word may mean.
pub struct Candidate<'a> {
    /// Its index in the list that the programs print.
    pub index: usize,
    /// Names of its own.
    pub names: Vec<&'a str>,
    /// A detail that tells it from others of the same name, in the words of a message.
    pub detail: String,
}

/// Why a word does not mean exactly one candidate.
#[derive(Debug, PartialEq, Eq)]
pub enum Unclear {
    /// No candidate has this name; these names exist.
    Unknown { known: String },
    /// Several candidates have this name; each is listed by its index, which is never ambiguous.
    Several { choices: String },
}

impl Unclear {
    /// The message about a `word` of an option: that something is `missing`, before the names that exist, or that the
    /// word may be several of a `kind`.
    pub fn message(&self, option: &str, word: &str, missing: &str, kind: &str) -> String {
        match self {
            Unclear::Unknown { known } => format!("{option}: {missing} {known}"),
            Unclear::Several { choices } => {
                format!("{option}: `{word}` may be more than one {kind}: give one of {choices}")
            }
        }
    }
}

/// The prefix of a word that is an index and not a name.
const INDEX: &str = "index:";

/// The index of the candidate that `word` means: `index:N` is the candidate of that index and nothing else, any other
/// word is a name. With `numbers`, a whole number is both a name and an index; if these are two candidates, the word is
/// unclear.
pub fn the_one(word: &str, candidates: &[Candidate], numbers: bool) -> Result<usize, Unclear> {
    let is_meant = |candidate: &&Candidate| match word.strip_prefix(INDEX).and_then(|n| n.parse::<usize>().ok()) {
        Some(index) => candidate.index == index,
        None => candidate.names.contains(&word) || numbers && candidate.index.to_string() == word,
    };
    let meant: Vec<&Candidate> = candidates.iter().filter(is_meant).collect();
    match meant[..] {
        [one] => Ok(one.index),
        [] => Err(Unclear::Unknown { known: listed(candidates, |c| format!("`{}`", name(c))) }),
        _ => {
            let choices = listed(meant, |c| format!("{INDEX}{} (`{}`{})", c.index, name(c), c.detail));
            Err(Unclear::Several { choices })
        }
    }
}

/// A word that means the candidate of this index: its name, unless that is unclear.
pub fn word_for(index: usize, candidates: &[Candidate], numbers: bool) -> String {
    let own = candidates.iter().find(|c| c.index == index).map(name);
    let clear = own.filter(|name| the_one(name, candidates, numbers) == Ok(index));
    clear.map_or_else(|| format!("{INDEX}{index}"), str::to_owned)
}

fn name<'a>(candidate: &Candidate<'a>) -> &'a str {
    candidate.names.first().copied().unwrap_or_default()
}

fn listed<T>(items: impl IntoIterator<Item = T>, text: impl Fn(T) -> String) -> String {
    items.into_iter().map(text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to fail when names were looked up before indices: `1` then was the camera of that name, whatever else it
    /// may mean.
    #[test]
    fn a_word_means_one_candidate_or_none() {
        let candidate = |(index, names): (usize, [&'static str; 2])| Candidate {
            index,
            names: names.into(),
            detail: String::new(),
        };
        let names =
            [["1", "Front"], ["2", "Back"], ["2", "Side"], ["index:0", "Front "], ["9", "index:x"], ["5", "Back"]];
        let candidates: Vec<Candidate> = names.into_iter().enumerate().map(candidate).collect();
        for (word, index) in [
            ("0", 0),
            ("Front", 0),
            ("Side", 2),
            ("3", 3),
            ("9", 4),
            ("5", 5),
            ("index:0", 0),
            ("index:1", 1),
            ("index:x", 4),
        ] {
            assert_eq!(the_one(word, &candidates, true), Ok(index), "{word}");
        }
        let choices = |word| match the_one(word, &candidates, true) {
            Err(Unclear::Several { choices }) => choices,
            other => panic!("{word}: {other:?}"),
        };
        assert_eq!(choices("1"), "index:0 (`1`), index:1 (`2`)");
        assert_eq!(choices("2"), "index:1 (`2`), index:2 (`2`)");
        assert_eq!(choices("Back"), "index:1 (`2`), index:5 (`5`)");
        for word in ["7", "front", "", "index:6", "index:-1", "00"] {
            assert!(matches!(the_one(word, &candidates, true), Err(Unclear::Unknown { .. })), "{word}");
        }
        // Without numbers, `1` is only a name.
        assert_eq!(the_one("1", &candidates, false), Ok(0));
        assert!(the_one("3", &candidates, false).is_err());
        let words: Vec<String> = (0..6).map(|k| word_for(k, &candidates, true)).collect();
        assert_eq!(words, ["index:0", "index:1", "index:2", "index:3", "9", "5"]);
    }
}
