//! Documents and scripts agree with the code: equations are cited by the numbers of docs/method.md,
//! docs/architecture.md says where those of the note are, and planted errors are where tests/check/planted.sh says.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// All source files below a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("lists") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// The equation numbers that follow a citation: `5.8`, `(6.7)`, `5.2, 5.3`, `9.1 to 9.5`, `5.10 by 9.5`.
fn numbers(after: &str) -> Vec<&str> {
    let end = after.find(|c: char| !(c.is_ascii_digit() || " .,()\n/!tobyand".contains(c))).unwrap_or(after.len());
    let words = after[..end].split(|c: char| !(c.is_ascii_digit() || c == '.')).map(|word| word.trim_matches('.'));
    words
        .filter(|word| word.split_once('.').is_some_and(|(a, b)| a.parse::<u32>().is_ok() && b.parse::<u32>().is_ok()))
        .collect()
}

#[test]
fn numbers_are_found_in_citations() {
    assert_eq!(numbers(" 5.8) and a cross product"), ["5.8"]);
    assert_eq!(numbers(" (6.7):"), ["6.7"]);
    assert_eq!(numbers(" 2.1 to\n//! 2.3)."), ["2.1", "2.3"]);
    assert_eq!(numbers(" 5.10 by 9.5), and 1"), ["5.10", "9.5"]);
}

/// Seen to catch: an equation renumbered in the document, and one cited that it lacks.
#[test]
fn every_equation_that_is_cited_is_in_the_document() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let document = fs::read_to_string(root.join("docs/method.md")).expect("reads");
    let mut files = Vec::new();
    ["crates", "pipeline", "tests", "data"].iter().for_each(|folder| sources(&root.join(folder), &mut files));
    let mut cited = 0;
    for file in files.iter().filter(|path| !path.ends_with("citations.rs")) {
        let text = fs::read_to_string(file).expect("reads");
        for (at, name) in text.match_indices("method.md") {
            for number in numbers(&text[at + name.len()..]) {
                assert!(document.contains(&format!("({number})")), "{}: method.md has no {number}", file.display());
                cited += 1;
            }
        }
    }
    assert!(cited > 40, "only {cited} citations were found");
}

/// docs/architecture.md names only files that exist, and says where in the code every equation of the note is.
///
/// Seen to catch: a file that was renamed, a label without its row, a row with another file.
#[test]
fn the_architecture_and_the_code_agree() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let document = fs::read_to_string(root.join("docs/architecture.md")).expect("reads");
    let named: Vec<&str> =
        document.split('`').filter(|word| word.starts_with("crates/") || word.starts_with("pipeline/")).collect();
    assert!(named.len() > 30, "only {named:?}");
    named.iter().for_each(|name| assert!(root.join(name).exists(), "architecture.md names {name}, which is not there"));
    let mut files = Vec::new();
    ["crates", "pipeline"].iter().for_each(|folder| sources(&root.join(folder), &mut files));
    let mut labels = 0;
    for file in files {
        let text = fs::read_to_string(&file).expect("reads");
        let name = file.strip_prefix(&root).expect("a file of the project").to_string_lossy().into_owned();
        for (at, tag) in text.match_indices("note: [") {
            let label = text[at + tag.len()..].split(']').next().expect("a label");
            let row = format!("| `[{label}]` | `{name}` |");
            assert!(document.contains(&row), "architecture.md has no row {row}");
            labels += 1;
        }
    }
    assert_eq!(document.matches("| `[").count(), labels, "architecture.md has a row that no code bears out");
}

/// The code that tests/check/planted.sh changes is in the files that it names.
///
/// Seen to catch: an argument that was renamed, a file that was moved.
#[test]
fn every_planted_error_has_its_place() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let script = fs::read_to_string(root.join("tests/check/planted.sh")).expect("reads");
    let rows = script.lines().filter(|line| line.starts_with("  '") && !line.starts_with("  'nothing"));
    let rows: Vec<Vec<&str>> = rows.map(|line| line.split('|').collect()).collect();
    assert!(rows.len() > 10, "{rows:?}");
    for row in rows {
        let [name, file, pattern, _] = row[..] else { panic!("{row:?}") };
        let text = fs::read_to_string(root.join(file)).unwrap_or_else(|e| panic!("{name}: {file}: {e}"));
        assert!(text.contains(&pattern.replace('\\', "")), "{name}: `{pattern}` is not in {file}");
    }
}
