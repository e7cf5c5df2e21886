//! Outputs never replace inputs, and outputs that cannot be written are refused before the work.

use std::{
    fs,
    os::unix::fs::{MetadataExt, PermissionsExt, symlink},
    path::Path,
    process::Command,
    time::{Duration, Instant},
};
use test_support::{Bench, Run, data, program};

/// A folder with one file of each kind that the programs read: a scene with its buffer, a cloud of it under an
/// environment, the environment, a medium and a view.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.slab("scene.gltf", |_| ());
    bench.write("sky.hdr", fs::read(data("environments/sky.hdr")).expect("reads"));
    bench.write("medium.json", fs::read(data("media/marble.json")).expect("reads"));
    bench.write("view.json", r#"{"eye":[0,0.2,0.3],"target":[0,0,0],"yfov":20,"width":4,"height":4}"#);
    bench.succeed("sample-surface", &words("scene.gltf -n 1000 --environment sky.hdr -o slab.cloud --quiet"));
    bench
}

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

const SAMPLE: &str = "scene.gltf --environment sky.hdr --for-medium medium.json --target-error 0.9 --quiet";
const CALIBRATE: &str = "slab.cloud scene.gltf --environment sky.hdr --medium Slab=medium.json --walks 100 --quiet";
const GATHER: &str =
    "slab.cloud scene.gltf --environment sky.hdr --medium Slab=medium.json --view view.json --spp 2 --quiet";

/// Seen to catch: each of the inputs not declared; hard links taken for different files; outputs declared after the
/// work.
#[test]
fn no_output_replaces_an_input() {
    let bench = bench();
    let read_by_both = ["scene.gltf", "slab.bin", "sky.hdr", "medium.json"];
    for (name, line, others, options) in [
        ("sample-surface", SAMPLE, &[][..], &["--output", "--ply", "--stats"][..]),
        ("calibrate", CALIBRATE, &["slab.cloud"], &["--output", "--stats"]),
        ("gather", GATHER, &["slab.cloud", "view.json"], &["--output", "--preview", "--stats"]),
    ] {
        for input in read_by_both.iter().chain(others) {
            fs::hard_link(bench.path(input), bench.path("hard")).expect("links");
            symlink(input, bench.path("link")).expect("links");
            let before = bench.read(input);
            for (option, spelled) in options.iter().flat_map(|option| [*input, "hard", "link"].map(|s| (*option, s))) {
                let mut arguments = words(line);
                arguments.extend([option, spelled]);
                if option != "--output" {
                    arguments.extend(["--output", "new"]);
                }
                bench.refuses(name, &arguments, &[spelled, option, "would replace", "give another name"]);
            }
            assert_eq!(bench.read(input), before, "{name}: {input}");
            ["hard", "link"].iter().for_each(|link| fs::remove_file(bench.path(link)).expect("removes"));
        }
        let twice = [&words(line)[..], &["--output", "new", "--stats", "./new"]].concat();
        bench.refuses(name, &twice, &["--stats would replace --output"]);
    }
}

/// Seen to catch: `--ply` refused only after a million samples were drawn.
#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let bench = bench();
    for option in ["--output", "--ply", "--stats"] {
        let mut arguments = words("scene.gltf -n 100M");
        arguments.extend([option, "nowhere/file", "--output", "new.cloud"].iter().take(if option == "--output" {
            2
        } else {
            4
        }));
        let start = Instant::now();
        bench.refuses("sample-surface", &arguments, &["nowhere/file", option, "No such file"]);
        assert!(start.elapsed() < Duration::from_secs(10), "{option}");
    }
    for (program, line) in [("sample-surface", SAMPLE), ("calibrate", CALIBRATE), ("gather", GATHER)] {
        for option in ["--output", "--stats"] {
            bench.refuses(program, &[&words(line)[..], &[option, "-"]].concat(), &["streams are not accepted"]);
        }
    }
}

/// Runs a program that must end by itself within seconds.
fn ends(bench: &Bench, name: &str, arguments: &[&str]) -> Run {
    let mut child = bench.start(name, arguments);
    let start = Instant::now();
    while child.try_wait().expect("can be waited for").is_none() {
        if start.elapsed() > Duration::from_secs(20) {
            child.kill().expect("ends");
            panic!("{name} {arguments:?} waits for ever");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().expect("has ended").into()
}

/// Seen to catch: the kind of the file not checked in each of the declarations.
#[test]
fn a_pipe_in_place_of_a_file_is_refused_at_once() {
    let bench = bench();
    assert!(Command::new("mkfifo").arg(bench.path("pipe")).status().expect("starts").success());
    let gather = |line: &str| format!("{line} --width 4 --spp 2 --quiet");
    let lines = [
        ("sample-surface", "pipe -n 100 -o new.cloud".to_owned()),
        ("sample-surface", "scene.gltf -n 100 -o pipe".to_owned()),
        ("sample-surface", "scene.gltf -n 100 -o new.cloud --stats pipe".to_owned()),
        ("gather", gather("pipe scene.gltf --environment sky.hdr --medium marble -o new.exr")),
        ("gather", gather("slab.cloud pipe --environment sky.hdr --medium marble -o new.exr")),
        ("gather", gather("slab.cloud scene.gltf --environment sky.hdr --medium marble -o pipe")),
        ("gather", gather("slab.cloud scene.gltf --environment sky.hdr --medium ./pipe -o new.exr")),
        ("gather", gather("slab.cloud scene.gltf --environment sky.hdr --medium marble --view pipe -o new.exr")),
        ("gather", gather("slab.cloud scene.gltf --environment sky.hdr --calibration pipe -o new.exr")),
        ("calibrate", "pipe scene.gltf --environment sky.hdr --medium marble -o new --quiet".to_owned()),
        ("calibrate", "slab.cloud scene.gltf --environment sky.hdr --medium marble -o pipe --quiet".to_owned()),
        ("gather", "--list-cameras pipe".to_owned()),
        ("compare", "pipe pipe".to_owned()),
    ];
    for (name, line) in lines {
        let output = ends(&bench, name, &words(&line));
        let message = output.stderr;
        assert_eq!(output.status.code(), Some(2), "{name} {line}: {message}");
        assert!(message.contains("pipe") && message.lines().count() == 1, "{name} {line}: {message}");
    }
}

/// Seen to fail: under `ulimit -f` the system ended the program in the middle of its file.
#[test]
fn a_file_that_may_not_grow_leaves_no_half_behind() {
    let bench = bench();
    let before = bench.files();
    let mut command = Command::new("/bin/sh");
    command.args(["-c", "ulimit -f 64 && exec \"$@\"", "sh"]).arg(program("sample-surface"));
    command.args(["scene.gltf", "-n", "100k", "-o", "big.cloud", "--quiet"]);
    let output = Run::of(command.current_dir(bench.folder()));
    let message = output.stderr;
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("big.cloud: cannot write: File too large"), "{message}");
    assert_eq!(bench.files(), before);
}

/// Runs a program as a user who may have `processes` processes, each thread counting as one. Root has no such limit, so
/// the process becomes another user first.
fn with_few_threads(bench: &Bench, processes: u32, name: &str, arguments: &[&str]) -> Run {
    // The other user must be able to read the program. This process must not have it open for writing, even for a
    // moment: a process that another test starts meanwhile would inherit the open file, and the program could not be
    // run.
    let copy = bench.path(name);
    assert!(Command::new("cp").arg(program(name)).arg(&copy).status().expect("starts").success());
    [(bench.folder(), 0o777), (&copy, 0o755)]
        .iter()
        .for_each(|(path, mode)| fs::set_permissions(path, fs::Permissions::from_mode(*mode)).expect("sets"));
    let mut command = Command::new("prlimit");
    command.arg(format!("--nproc={processes}"));
    let is_root = fs::metadata("/proc/self").is_ok_and(|meta| meta.uid() == 0);
    command.args(if is_root { &["setpriv", "--reuid", "64321", "--clear-groups"][..] } else { &[] }).arg(copy);
    Run::of(command.current_dir(bench.folder()).args(arguments))
}

/// Programs run where no thread can be started, and ignore an environment variable that asks for very many.
///
/// Seen to catch: the pool of the calling thread alone left out; the number of threads left to rayon.
#[test]
fn few_threads_or_none_give_the_same_bytes() {
    let bench = bench();
    let expected = bench.read("slab.cloud");
    let line = words("scene.gltf -n 1000 --environment sky.hdr -o few.cloud -j 8");
    for (processes, said) in [(1, "none of 8 threads"), (4, "of 8 threads"), (1000, "sampling")] {
        let output = with_few_threads(&bench, processes, "sample-surface", &line);
        let message = output.stderr;
        assert_eq!(output.status.code(), Some(0), "{processes} processes: {message}");
        assert!(message.contains(said), "{processes} processes: {message}");
        assert_eq!(bench.read("few.cloud"), expected);
        fs::remove_file(bench.path("few.cloud")).expect("removes");
    }
    let output = with_few_threads(&bench, 1, "gather", &words(&format!("{GATHER} --calibration none -o few.exr")));
    assert_eq!(output.status.code(), Some(0), "{}", output.stderr);
    let output = with_few_threads(&bench, 1, "calibrate", &words(&format!("{CALIBRATE} -o few.calibration")));
    assert_eq!(output.status.code(), Some(0), "{}", output.stderr);
    let output = with_few_threads(&bench, 1, "compare", &words("few.exr few.exr --exact -j 4"));
    assert_eq!(output.status.code(), Some(0), "{}", output.stderr);

    let mut command = Command::new(program("sample-surface"));
    command.env("RAYON_NUM_THREADS", "100000").current_dir(bench.folder());
    command.args(words("scene.gltf -n 1000 --environment sky.hdr -o many.cloud --stats many.json --quiet"));
    assert!(command.status().expect("starts").success());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    assert_eq!(bench.json("many.json")["threads"], cores);
    assert_eq!(bench.read("many.cloud"), expected);
}

/// Names may contain characters that control a terminal. Seen to catch: messages printed without escapes.
#[test]
fn names_from_files_cannot_command_a_terminal() {
    let bench = Bench::new();
    let evil = "Wax\u{1b}[2J\u{9b}31m\nPASS\r\u{202e}";
    bench.slab("evil.gltf", |root| {
        root["materials"][0]["name"] = evil.into();
        root["cameras"][0]["name"] = evil.into();
    });
    let is_safe = |text: &str| {
        let bad = text.chars().find(|c| (c.is_control() && *c != '\n') || *c == '\u{202e}');
        assert!(bad.is_none() && !text.contains("\nPASS"), "{text:?}");
    };
    bench.succeed("sample-surface", &["evil.gltf", "-n", "100", "-o", "evil.cloud", "--quiet"]);
    for line in [
        "evil.cloud evil.gltf --medium marble --width 4 --spp 2 -o new.exr",
        "evil.cloud evil.gltf -o new.exr",
        "evil.cloud evil.gltf --medium marble --camera none -o new.exr",
        "--list-cameras --list-materials evil.gltf",
    ] {
        let output = bench.run("gather", &words(line));
        is_safe(&output.stderr);
        is_safe(&output.stdout);
    }
    let odd = "odd\u{1b}[31m\nPASS.glb";
    let output = bench.run("sample-surface", &[odd, "-o", "new.cloud"]);
    is_safe(&output.stderr);
    assert!(!Path::new(odd).exists());
}
