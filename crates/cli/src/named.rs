//! Which of a scene's things a word on a command line means.

/// Something that a word may mean.
pub struct Thing<'a> {
    /// Its place in the list that the programs print.
    pub index: usize,
    /// What it is called.
    pub names: Vec<&'a str>,
    /// What tells it from others of its name.
    pub place: String,
}

/// Why a word does not mean one thing.
#[derive(Debug, PartialEq, Eq)]
pub enum Unclear {
    /// It means nothing; the names that there are.
    Unknown { known: String },
    /// It may mean more than one: each by its index, which is the way out.
    Several { choices: String },
}

/// What an index is said by where a name may be taken for it.
const INDEX: &str = "index:";

/// The index of the one of `things` that `word` means: `index:N` is the Nth and nothing else, any other word is a name.
/// Where `numbers` says so, a whole number is a name and an index, and if these are two things, it is unclear.
pub fn the_one(word: &str, things: &[Thing], numbers: bool) -> Result<usize, Unclear> {
    let is_meant = |thing: &&Thing| match word.strip_prefix(INDEX).and_then(|n| n.parse::<usize>().ok()) {
        Some(index) => thing.index == index,
        None => thing.names.contains(&word) || numbers && thing.index.to_string() == word,
    };
    let meant: Vec<&Thing> = things.iter().filter(is_meant).collect();
    match meant[..] {
        [one] => Ok(one.index),
        [] => Err(Unclear::Unknown { known: listed(things, |t| format!("`{}`", name(t))) }),
        _ => {
            let meant = meant.into_iter();
            Err(Unclear::Several {
                choices: listed(meant, |t| format!("{INDEX}{} (`{}`{})", t.index, name(t), t.place)),
            })
        }
    }
}

/// A word that means the thing of this index, its name if that is clear.
pub fn word_for(index: usize, things: &[Thing], numbers: bool) -> String {
    let names = things.iter().find(|t| t.index == index).map(name);
    let clear = names.filter(|name| the_one(name, things, numbers) == Ok(index));
    clear.map_or_else(|| format!("{INDEX}{index}"), str::to_owned)
}

fn name<'a>(thing: &Thing<'a>) -> &'a str {
    thing.names.first().copied().unwrap_or_default()
}

fn listed<T>(things: impl IntoIterator<Item = T>, text: impl Fn(T) -> String) -> String {
    things.into_iter().map(text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to fail where a name was looked for first: `1` was the camera called so, whatever else it may mean.
    #[test]
    fn a_word_means_one_thing_or_none() {
        let thing = |index, names: [&'static str; 2]| Thing { index, names: names.into(), place: String::new() };
        let things =
            [["1", "Front"], ["2", "Back"], ["2", "Side"], ["index:0", "Front "], ["9", "index:x"], ["5", "Back"]];
        let things: Vec<Thing> = things.into_iter().enumerate().map(|(k, names)| thing(k, names)).collect();
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
            assert_eq!(the_one(word, &things, true), Ok(index), "{word}");
        }
        let choices = |word| match the_one(word, &things, true) {
            Err(Unclear::Several { choices }) => choices,
            other => panic!("{word}: {other:?}"),
        };
        assert_eq!(choices("1"), "index:0 (`1`), index:1 (`2`)");
        assert_eq!(choices("2"), "index:1 (`2`), index:2 (`2`)");
        assert_eq!(choices("Back"), "index:1 (`2`), index:5 (`5`)");
        for word in ["7", "front", "", "index:6", "index:-1", "00"] {
            assert!(matches!(the_one(word, &things, true), Err(Unclear::Unknown { .. })), "{word}");
        }
        // Without numbers `1` is but a name.
        assert_eq!(the_one("1", &things, false), Ok(0));
        assert!(the_one("3", &things, false).is_err());
        let words: Vec<String> = (0..6).map(|k| word_for(k, &things, true)).collect();
        assert_eq!(words, ["index:0", "index:1", "index:2", "index:3", "9", "5"]);
    }
}
