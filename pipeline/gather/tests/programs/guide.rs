//! docs/guide.md explains every option of the programs once, and no other option.

use std::{collections::BTreeSet, fs, process::Command};
use test_support::program;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide.md");

const PROGRAMS: [&str; 4] = ["sample-surface", "calibrate", "gather", "compare"];

/// The programs that the second column of a table stands for: some by their names, the first three, or all.
fn programs(cell: &str) -> Vec<&str> {
    match cell {
        "three" => PROGRAMS[..3].to_vec(),
        "all" => PROGRAMS.to_vec(),
        names => names.split(", ").collect(),
    }
}

/// The words of a text that are options, without their values.
fn options(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    words.filter(|word| {
        word.starts_with('-') && word.trim_start_matches('-').starts_with(|c: char| c.is_ascii_alphabetic())
    })
}

/// The options that `--help` lists, each with its program. Their explanations are further indented.
fn offered() -> BTreeSet<(String, String)> {
    let mut found = BTreeSet::new();
    let calls = PROGRAMS.map(|name| (name, &[][..])).into_iter();
    for (name, first) in calls.chain([("compare", &["--html-index", "index.html"][..])]) {
        let output = Command::new(program(name)).args(first).arg("--help").output().expect("it starts");
        let help = String::from_utf8(output.stdout).expect("text");
        let lines = help.lines().filter(|line| line.starts_with("  -") || line.starts_with("      --"));
        let heads = lines.map(|line| line.trim_start().split("  ").next().unwrap_or_default());
        found.extend(heads.flat_map(options).map(|option| (name.to_owned(), option.to_owned())));
    }
    found
}

/// Seen to fail for an option that the page lacked, one that it had twice, one of another program, and one that no
/// program has, in a table and in the text.
#[test]
fn the_guide_explains_every_option_once() {
    let offered = offered();
    assert!(offered.len() > 110, "only {} options were found", offered.len());
    let page = fs::read_to_string(PAGE).expect("docs/guide.md");
    let mut explained = BTreeSet::new();
    for row in page.lines().filter(|line| line.starts_with("| `-")) {
        let mut cells = row.trim_start_matches('|').split(" | ").map(str::trim);
        let (head, of) = (cells.next().unwrap_or_default(), cells.next().unwrap_or_default());
        for program in programs(of) {
            assert!(PROGRAMS.contains(&program), "no program is called so: {row}");
            for option in options(head) {
                let new = explained.insert((program.to_owned(), option.to_owned()));
                assert!(new, "docs/guide.md explains {option} of {program} twice");
            }
        }
    }
    let missing: Vec<_> = offered.difference(&explained).collect();
    let unknown: Vec<_> = explained.difference(&offered).collect();
    assert!(missing.is_empty() && unknown.is_empty(), "docs/guide.md lacks {missing:?} and has {unknown:?}");
    let long = |option: &&str| option.starts_with("--");
    for option in options(&page).filter(long).filter(|option| *option != "--paste") {
        assert!(offered.iter().any(|(_, known)| known == option), "docs/guide.md names {option}, which no program has");
    }
}
