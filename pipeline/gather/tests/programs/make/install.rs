//! `make install`: programs, manual pages and completions, where they were asked for and nowhere else.

use super::Tree;
use std::{fs, os::unix::fs::PermissionsExt, path::Path, process::Command};

/// The files below a folder, by their paths in it.
fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|inner| format!("{name}/{inner}")));
        } else {
            found.push(name);
        }
    }
    found.sort();
    found
}

/// Seen to catch: a folder with a space that is taken for two, PREFIX of the environment, a text of another program.
#[test]
fn programs_come_with_their_manual_pages_and_completions() {
    let tree = Tree::new();
    let (root, prefix) = (tree.path("a root"), tree.path("a root/usr"));
    let root = format!("DESTDIR={}", root.display());
    let arguments = ["install", &root, "PREFIX=/usr", "PROGRAMS=gather calibrate"];
    let output = tree.command(&arguments).env("PREFIX", "/nowhere").output().expect("make starts");
    assert!(output.status.success(), "{output:?}");
    let of = |name: &str| {
        [
            format!("bin/{name}"),
            format!("share/bash-completion/completions/{name}"),
            format!("share/fish/vendor_completions.d/{name}.fish"),
            format!("share/man/man1/{name}.1"),
            format!("share/zsh/site-functions/_{name}"),
        ]
    };
    let mut wanted = [of("gather"), of("calibrate")].concat();
    wanted.sort();
    assert_eq!(files(&prefix), wanted);
    let mode = |name: &str| fs::metadata(prefix.join(name)).expect("there").permissions().mode() & 0o777;
    assert_eq!([mode("bin/gather"), mode("share/man/man1/gather.1")], [0o755, 0o644]);
    let text = |name: &str| fs::read_to_string(prefix.join(name)).expect("text");
    let page = text("share/man/man1/gather.1");
    for words in [".TH gather 1", "\\-\\-time\\-limit", "EXIT STATUS"] {
        assert!(page.contains(words), "{words}");
    }
    // The shell completes an option, and a value of one.
    let completes = |typed: &str, before: &str| {
        let script = "source \"$0\"; COMP_WORDS=(gather \"$2\" \"$1\"); COMP_CWORD=2; _gather gather \"$1\" \"$2\"; echo \"${COMPREPLY[@]}\"";
        let file = prefix.join("share/bash-completion/completions/gather");
        let output = Command::new("bash").args(["-c", script]).arg(file).args([typed, before]).output().expect("bash");
        String::from_utf8(output.stdout).expect("text").trim().to_owned()
    };
    assert_eq!(completes("--time-l", "cloud"), "--time-limit");
    assert!(completes("", "--bssrdf").starts_with("half-space "));
    assert!(text("share/zsh/site-functions/_gather").starts_with("#compdef gather"));
    assert!(text("share/fish/vendor_completions.d/calibrate.fish").contains("complete -c calibrate -l walks"));
    tree.make(&["uninstall", &root, "PREFIX=/usr", "PROGRAMS=gather calibrate"]);
    assert!(files(&prefix).is_empty());
    tree.refuses(&mut tree.command(&["install", &root, "PROGRAMS=gather cat"]), &["PROGRAMS=gather cat"]);
}
