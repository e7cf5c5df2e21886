//! make removes and overwrites no files of others.

use super::{IMAGES, Tree, said, view};
use std::{fs, os::unix::fs::symlink, process::Command};

/// Files of other people in a tree that has rendered.
const OTHERS: [&str; 9] = [
    "../a.exr",
    "docs/a.png",
    "shots/b.exr",
    "shots/b.settings",
    "shots/k1M-s0.cloud",
    "out/notes.txt",
    "out/gallery.png",
    "out/thing/k500-s0/mine.cloud",
    "out/thing/k500-s0/marble-half-space/mine.exr",
];

/// A tree that has rendered to OUT, with other people's files in it, and with `shots` reached by a link in OUT.
fn rendered(out: &str) -> Tree {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    tree.write("list.json", format!("[{}]", view(0.4)));
    tree.make(&["SCENE=thing.gltf", "VIEWS=s.json list.json", &format!("OUT={out}")]);
    OTHERS.iter().for_each(|name| tree.write(name, "made by make: somebody else"));
    symlink(tree.path("shots"), tree.path("out/link")).expect("links");
    tree
}

/// Whatever OUT is, only what make made there goes. Seen to fail where OUT was removed as a whole, where a name with a
/// space was two, and where images were looked for by their endings.
#[test]
fn clean_removes_nothing_of_others() {
    let tree = rendered("out");
    let image = tree.path(IMAGES).join("s.exr");
    for out in [".", "..", "docs", "shots", "out shots", "~", "-rf", "out/link", "out"] {
        for goal in ["clean-images", "clean"] {
            tree.make(&[goal, &format!("OUT={out}")]);
            OTHERS.iter().for_each(|name| assert!(tree.path(name).exists(), "make {goal} OUT={out} removed {name}"));
        }
        assert_eq!(image.exists(), out != "out", "OUT={out}");
    }
}

/// Nothing stays of what was made, neither in OUT nor OUT itself.
#[test]
fn clean_removes_what_was_made() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    tree.write("list.json", format!("[{}]", view(0.4)));
    let before = tree.files();
    for out in ["deep/out", ".", "./out/"] {
        let out = format!("OUT={out}");
        tree.make(&["SCENE=thing.gltf", "VIEWS=s.json list.json", &out]);
        tree.make(&["clean-images", &out]);
        let left = tree.files();
        let is_image =
            |name: &String| name.ends_with(".exr") || (name.ends_with(".png") && !name.ends_with("card.png"));
        assert!(!left.iter().any(is_image), "{left:?}");
        assert!(left.iter().any(|name| name.ends_with(".cloud")), "{left:?}");
        tree.make(&["clean", &out]);
        fs::remove_dir(tree.path("deep")).ok();
        assert_eq!(tree.files(), before, "{out}");
    }
    fs::create_dir_all(tree.path("a folder")).expect("makes a folder");
    tree.make(&["clean", "OUT=a folder", "SCENE=that is gone.glb"]);
    assert_eq!(tree.files(), before);
}

/// A link as OUT: what was made behind it goes, the link and what else is there stay.
#[test]
fn clean_follows_out_and_no_other_link() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    tree.write("elsewhere/notes", "");
    symlink(tree.path("elsewhere"), tree.path("out")).expect("links");
    let before = tree.files();
    tree.make(&["SCENE=thing.gltf", "VIEWS=s.json"]);
    assert!(tree.path("elsewhere/thing").exists());
    tree.make(&["clean"]);
    assert_eq!(tree.files(), before);
}

/// Seen to fail where OUT was taken from the environment, and then removed or empty.
#[test]
fn out_of_the_environment_is_not_used() {
    let tree = rendered("out");
    tree.write("mine/only.exr", "");
    fs::create_dir(tree.path("empty")).expect("makes a folder");
    for out in ["mine", "empty", "", "."] {
        for goal in ["clean-images", "clean"] {
            let output = tree.command(&["-e", goal]).env("OUT", out).output().expect("make starts");
            assert_eq!(output.status.code(), Some(0), "{}", said(&output));
            assert!(said(&output).contains("of the environment is not used"), "{}", said(&output));
            assert!(tree.path("mine/only.exr").exists() && tree.path("empty").exists(), "OUT={out} make {goal}");
            OTHERS.iter().for_each(|name| assert!(tree.path(name).exists(), "OUT={out} make {goal} removed {name}"));
        }
    }
}

/// A name that is not one word to make would be written elsewhere, or read from elsewhere: of `OUT="out copy"` the
/// Makefile was seen to make the folder `copy`.
#[test]
fn names_that_make_reads_otherwise_are_refused() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    tree.write("fuzz/targets/cloud.rs", "");
    tree.write("shot.json", format!("[{}]", view(0.4)));
    tree.write("shot.a.json", view(0.4));
    let own = ["SCENE=thing.gltf", "VIEWS=s.json"];
    let cases: [(&[&str], &[&str]); 10] = [
        (&["OUT=out copy"], &["OUT=out copy", "a space"]),
        (&["OUT="], &["OUT is empty"]),
        (&["OUT=a:b"], &["OUT=a:b"]),
        (&["SCENE=my thing.gltf"], &["SCENE=my thing.gltf", "a space"]),
        (&["MEDIUM=it's.json"], &["MEDIUM=it's.json", "'"]),
        (&["VIEWS=shot.json shot.a.json"], &["VIEWS", "shot.json", "shot.a.json"]),
        (&["fuzz", "TARGET=../../docs"], &["TARGET", "cloud"]),
        (&["fuzz", "TARGET=cloud view"], &["TARGET=cloud view", "a space"]),
        (&["check", "GOLDEN="], &["GOLDEN is empty"]),
        (&["golden-milk"], &["make references"]),
    ];
    for (arguments, words) in cases {
        tree.refuses(&mut tree.command(&[&own[..], arguments].concat()), words);
    }
}

/// The copy that `make check-power` makes is removed with the next run: seen to remove a `tree` of somebody else's in
/// the folder that the variable WORK names.
#[test]
fn check_power_removes_its_own_copy_only() {
    let tree = Tree::new();
    tree.write("work/tree/notes", "");
    let mut command = Command::new("bash");
    command.current_dir(tree.path("")).env("WORK", "work").arg("tests/check/planted.sh");
    tree.refuses(&mut command, &["work/tree", "WORK"]);
}
