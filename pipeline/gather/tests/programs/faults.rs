//! Faults of a farm: killed processes, full disks, exchanged files, too little memory. No file is half-written, and a
//! second run succeeds.
//!
//! Seen to catch: the target written in place; temporary files of a killed process left behind; the handlers of signals
//! left out; a handler for an ignored signal; the need for memory estimated a hundred times too small; a cloud that
//! changes while it is read not noticed.

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Child, Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};
use test_support::{Bench, Limits, Run, data, program};

/// How many times each program is killed.
const KILLS: u32 = if cfg!(feature = "slow") { 100 } else { 6 };

/// A program whose target exists already, and the bytes that it would write.
struct Victim<'a> {
    bench: &'a Bench,
    name: &'a str,
    arguments: Vec<String>,
    target: &'a str,
    old: Vec<u8>,
    new: Vec<u8>,
    /// Duration of a whole run.
    duration: Duration,
}

/// A cloud of the sphere under another seed than `a.cloud`.
fn sampling(bench: &Bench) -> Victim<'_> {
    let scene = data("scenes/sphere.glb");
    let run =
        |seed: &str| ["-n", "200k", "--seed", seed, "-j", "1", "-o", "a.cloud", &scene].map(str::to_owned).to_vec();
    Victim::new(bench, "sample-surface", "a.cloud", [run("1"), run("2")])
}

/// A calibration of a cloud under another seed than `a.calibration`.
fn calibrating(bench: &Bench) -> Victim<'_> {
    let scene = data("scenes/sphere.glb");
    bench.succeed("sample-surface", &["-n", "20k", "-o", "sphere.cloud", &scene]);
    let run = |seed: &str| {
        let own = ["sphere.cloud", &scene, "--medium", "marble", "--walks", "200", "--seed", seed, "-j", "1"];
        [&own[..], &["-o", "a.calibration"]].concat().into_iter().map(str::to_owned).collect()
    };
    Victim::new(bench, "calibrate", "a.calibration", [run("1"), run("2")])
}

/// An image of a cloud under another seed than `a.exr`.
fn gathering(bench: &Bench) -> Victim<'_> {
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    bench.succeed("sample-surface", &["-n", "20k", "-o", "sphere.cloud", &scene]);
    let run = |seed: &str| {
        let size = ["--width", "96", "--height", "96", "--spp", "2"];
        let inputs = ["sphere.cloud", scene.as_str(), "--view", &view, "--medium", "marble"];
        let rest = ["--calibration", "none", "--seed", seed, "-j", "1", "-o", "a.exr"];
        [&inputs[..], &size, &rest].concat().into_iter().map(str::to_owned).collect()
    };
    Victim::new(bench, "gather", "a.exr", [run("1"), run("2")])
}

impl<'a> Victim<'a> {
    /// Runs both; the file of the first run is the old one.
    fn new(bench: &'a Bench, name: &'a str, target: &'a str, [old, new]: [Vec<String>; 2]) -> Victim<'a> {
        let content = |arguments: &[String]| {
            let start = Instant::now();
            bench.succeed(name, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
            (bench.read(target), start.elapsed())
        };
        let ((new_bytes, duration), (old_bytes, _)) = (content(&new), content(&old));
        assert_ne!(old_bytes, new_bytes, "nothing would be seen");
        Victim { bench, name, arguments: new, target, old: old_bytes, new: new_bytes, duration }
    }

    fn start(&self) -> Child {
        self.bench.start(self.name, &self.arguments.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Starts the program over the old file and sends it a signal after `delay`.
    fn signalled(&self, signal: &str, delay: Duration) -> ExitStatus {
        fs::write(self.bench.path(self.target), &self.old).expect("writes");
        let mut child = self.start();
        if signal != "-KILL" {
            while !catches_signals(&child) {
                sleep(Duration::from_millis(1));
            }
        }
        sleep(delay);
        send(signal, &child);
        child.wait().expect("ends")
    }

    /// Whether the target is the new file; it must be that or the old one.
    fn is_new(&self) -> bool {
        let found = fs::read(self.bench.path(self.target)).expect("the target is there");
        assert!(found == self.old || found == self.new, "{}: neither the old file nor the new", self.target);
        found == self.new
    }

    /// A delay between zero and a little more than a whole run, different for each `k` below `count`.
    fn delay(&self, k: u32, count: u32) -> Duration {
        // Multiples of the golden ratio are spread evenly and unordered.
        let share = (f64::from(k) * 0.618_033_988_75 + 0.5 / f64::from(count)).fract();
        self.duration.mul_f64(1.1 * share)
    }
}

/// Whether a process has installed its handlers of SIGINT and SIGTERM, or has ended.
fn catches_signals(child: &Child) -> bool {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let over = status.contains("State:\tZ");
    over || signals(&status, "SigCgt:").is_none_or(|caught| caught >> (2 - 1) & caught >> (15 - 1) & 1 == 1)
}

/// A set of signals in the status of a process.
fn signals(status: &str, name: &str) -> Option<u64> {
    status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix(name)?.trim(), 16).ok())
}

/// Whether this process and hence its children ignore SIGHUP, as under `nohup`.
fn ignores_hangup() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    signals(&status, "SigIgn:").is_some_and(|ignored| ignored & 1 == 1)
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(status.is_ok(), "there is a program kill");
}

fn temporaries(bench: &Bench) -> BTreeSet<String> {
    let names = bench.files().into_iter().filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    names.filter(|name| name.ends_with(".tmp")).collect()
}

/// After SIGKILL at moments all over a run, the target is the old file or the new one, whole, and the next run removes
/// the temporary file.
fn survives_kills(victim: &Victim<'_>) {
    let (mut finished, mut left_something) = (0, 0);
    for k in 0..KILLS {
        let status = victim.signalled("-KILL", victim.delay(k, KILLS));
        assert!(matches!(status.code(), None | Some(0)), "{status}");
        finished += u32::from(victim.is_new());
        left_something += u32::from(!temporaries(victim.bench).is_empty());
    }
    assert!(finished < KILLS, "{}: every kill came too late", victim.name);
    assert!(victim.start().wait().expect("ends").success(), "a rerun is clean");
    assert!(victim.is_new());
    assert_eq!(temporaries(victim.bench), BTreeSet::new());
    eprintln!(
        "{}: {KILLS} kills, {} left the old file, {finished} the new one; {left_something} left a temporary file, \
         which a rerun removed",
        victim.name,
        KILLS - finished
    );
}

#[test]
fn a_killed_sampler_leaves_the_old_cloud_or_the_new() {
    survives_kills(&sampling(&Bench::new()));
}

#[test]
fn a_killed_calibration_leaves_the_old_file_or_the_new() {
    survives_kills(&calibrating(&Bench::new()));
}

#[test]
fn a_killed_gather_leaves_the_old_image_or_the_new() {
    survives_kills(&gathering(&Bench::new()));
}

#[test]
fn signals_to_end_leave_no_temporary_file() {
    let bench = Bench::new();
    for victim in [sampling(&bench), calibrating(&bench), gathering(&bench)] {
        let hangup = (!ignores_hangup()).then_some(("-HUP", 129));
        for (signal, code) in hangup.into_iter().chain([("-INT", 130), ("-TERM", 143)]) {
            let mut stopped = 0;
            for k in 0..6 {
                let status = victim.signalled(signal, victim.delay(k, 6));
                assert!([Some(0), Some(code)].contains(&status.code()), "{signal}: {status}");
                assert!(victim.is_new() || !status.success());
                assert_eq!(temporaries(&bench), BTreeSet::new(), "{signal}");
                stopped += u32::from(!status.success());
            }
            assert!(stopped > 0, "{}: every {signal} came too late", victim.name);
        }
    }
}

/// A program started by `nohup` continues when its terminal closes.
#[test]
fn a_hangup_that_is_ignored_does_nothing() {
    let bench = Bench::new();
    let victim = sampling(&bench);
    let mut command = Command::new("nohup");
    command.arg(program(victim.name)).args(&victim.arguments).current_dir(bench.path("."));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("there is a program nohup");
    while !catches_signals(&child) {
        sleep(Duration::from_millis(1));
    }
    send("-HUP", &child);
    assert!(child.wait().expect("ends").success());
    assert!(victim.is_new());
}

/// Two processes that write the same target at once leave the file of one of them, whole.
#[test]
fn two_samplers_on_one_target_do_not_mix() {
    let bench = Bench::new();
    let victim = sampling(&bench);
    let mut other = victim.arguments.clone();
    let seed = other.iter().position(|argument| argument == "2").expect("a seed");
    other[seed] = "1".into();
    let other: Vec<&str> = other.iter().map(String::as_str).collect();
    for _ in 0..KILLS.min(20) {
        fs::remove_file(bench.path(victim.target)).expect("removes");
        let (mut first, mut second) = (victim.start(), bench.start("sample-surface", &other));
        for child in [&mut first, &mut second] {
            assert!(child.wait().expect("ends").success());
        }
        victim.is_new();
        assert_eq!(temporaries(&bench), BTreeSet::new());
    }
}

#[test]
fn a_target_that_may_not_be_written_stays() {
    let bench = Bench::new();
    for victim in [sampling(&bench), calibrating(&bench), gathering(&bench)] {
        let path = bench.path(victim.target);
        let mut permissions = fs::metadata(&path).expect("is there").permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).expect("sets");
        let arguments: Vec<&str> = victim.arguments.iter().map(String::as_str).collect();
        bench.refuses(victim.name, &arguments, &[victim.target, "read-only"]);
        assert!(!victim.is_new());
    }
}

/// The target may lie in a folder of another file system, or be a link to a file there: the temporary file lies in the
/// folder of the target.
#[test]
fn a_target_on_another_file_system() {
    let Ok(elsewhere) = tempfile::tempdir_in("/dev/shm") else {
        eprintln!("not run: there is no /dev/shm to write to");
        return;
    };
    let bench = Bench::new();
    let target = elsewhere.path().join("b.cloud");
    let scene = data("scenes/sphere.glb");
    let sample =
        |output: &str, seed: &str| bench.succeed("sample-surface", &[&scene, "-n", "1k", "--seed", seed, "-o", output]);
    sample(&target.to_string_lossy(), "1");
    let first = fs::read(&target).expect("reads");
    std::os::unix::fs::symlink(&target, bench.path("link.cloud")).expect("links");
    sample("link.cloud", "2");
    assert_ne!(fs::read(&target).expect("reads"), first);
    assert!(fs::symlink_metadata(bench.path("link.cloud")).expect("is there").is_symlink());
    assert_eq!(fs::read_dir(elsewhere.path()).expect("lists").count(), 1);
}

/// Runs `script` in a namespace of its own, in which it may mount; none where the system does not allow that.
fn in_own_mounts(bench: &Bench, script: &str) -> Option<Run> {
    let unshare = |flags: &[&str], script: &str| {
        let mut command = Command::new("unshare");
        command.args(flags).args(["sh", "-ec", script]).current_dir(bench.folder()).output().ok().map(Run::from)
    };
    let flags = [&["--mount"][..], &["--mount", "--map-root-user"]];
    let allowed = |flags: &&&[&str]| {
        let tried = unshare(flags, "mkdir -p small && mount -t tmpfs -o size=16k none small");
        tried.is_some_and(|output| output.status.success())
    };
    flags.iter().find(allowed).and_then(|flags| unshare(flags, script))
}

/// Where the disk is full when a cloud or an image is written, there is a message and the old file, and no other file.
#[test]
fn a_full_disk_leaves_the_old_file() {
    let bench = Bench::new();
    let victims = [sampling(&bench), gathering(&bench)];
    for victim in &victims {
        let program = program(victim.name);
        let arguments = victim.arguments.iter().map(|a| if a == victim.target { "small/target" } else { a });
        let command = arguments.map(|argument| format!("'{argument}'")).collect::<Vec<_>>().join(" ");
        let script = format!(
            "mkdir -p small; mount -t tmpfs -o size=100k none small; echo old > small/target; set +e; \
             '{}' {command}; echo \"exit $?: $(ls -A small): $(cat small/target)\"",
            program.display()
        );
        let Some(output) = in_own_mounts(&bench, &script) else {
            eprintln!("not run: this system lets no test mount a file system");
            return;
        };
        let Run { stdout: said, stderr: message, .. } = output;
        assert!(said.ends_with("exit 2: target: old\n"), "{said}{message}");
        let last = message.lines().last().unwrap_or_default();
        assert!(last.contains("small/target") && last.contains("No space left"), "{message}");
    }
}

/// Whether a process has mapped a file, or has ended.
fn maps(child: &Child, file: &str) -> bool {
    fs::read_to_string(format!("/proc/{}/maps", child.id())).map_or(true, |maps| maps.is_empty() || maps.contains(file))
}

/// Runs a slow `gather` and changes its cloud in the middle of the run.
fn gather_disturbed(bench: &Bench, disturb: impl FnOnce(&Path)) -> (Run, Vec<u8>) {
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    bench.succeed("sample-surface", &["-n", "200k", "-o", "mine.cloud", &scene]);
    let arguments = ["mine.cloud", &scene, "--view", &view, "--medium", "marble", "--spp", "8", "--quiet", "-o"];
    let start = Instant::now();
    bench.succeed("gather", &[&arguments[..], &["alone.exr"]].concat());
    let whole = start.elapsed();
    let child = bench.start("gather", &[&arguments[..], &["mine.exr"]].concat());
    while !maps(&child, "mine.cloud") {
        sleep(Duration::from_millis(1));
    }
    // The cloud is checked within milliseconds; rendering takes the rest of the run.
    sleep(whole.mul_f64(0.2));
    disturb(&bench.path("mine.cloud"));
    (child.wait_with_output().expect("ends").into(), bench.read("alone.exr"))
}

#[test]
fn a_cloud_replaced_while_it_is_read_is_read_to_the_end() {
    let bench = Bench::new();
    let scene = data("scenes/sphere.glb");
    let (output, alone) = gather_disturbed(&bench, |_| {
        bench.succeed("sample-surface", &["-n", "200k", "--seed", "9", "-o", "mine.cloud", &scene]);
    });
    assert_eq!(output.status.code(), Some(0), "{}", output.stderr);
    assert!(bench.read("mine.exr") == alone, "not the image of the old cloud");
}

/// `cp` overwrites a file in place, which these programs never do.
#[test]
fn a_cloud_written_to_while_it_is_read_is_no_image() {
    type Disturb = fn(&Path);
    let disturbances: [(&str, Disturb); 2] = [
        ("cut short", |path| fs::write(path, b"").expect("writes")),
        ("written to", |path| {
            let bytes = fs::read(path).expect("reads");
            sleep(Duration::from_millis(20));
            let mut file = fs::OpenOptions::new().write(true).open(path).expect("opens");
            std::io::Write::write_all(&mut file, &vec![1; bytes.len()]).expect("writes");
        }),
    ];
    for (words, disturb) in disturbances {
        let bench = Bench::new();
        let (output, _) = gather_disturbed(&bench, disturb);
        let message = output.stderr;
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        assert!(message.contains(words) && message.lines().count() == 1, "{message}");
        assert!(!bench.path("mine.exr").exists());
    }
}

/// Under any limit of memory, the program stays within it or names its need first.
#[test]
fn too_little_memory_is_said_before_the_work() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let sample = ["-n", "1M", "-j", "2", "-o", "c.cloud", "--quiet", scene.as_str()];
    bench.succeed("sample-surface", &["-n", "20k", "-o", "d.cloud", &scene]);
    let size = ["--width", "512", "--height", "512", "--spp", "1", "-j", "2", "--quiet", "-o", "d.exr"];
    let gather = [&["d.cloud", scene.as_str(), "--view", &view, "--medium", "marble"], &size[..]].concat();
    for (program, arguments, target) in [("sample-surface", &sample[..], "c.cloud"), ("gather", &gather, "d.exr")] {
        let (mut refused, mut done) = (0, 0);
        for mebibytes in [96, 160, 224, 288, 352, 416, 480, 640, 1024] {
            fs::remove_file(bench.path(target)).ok();
            let output = bench.run_within(Limits { kibibytes: mebibytes << 10, seconds: 60 }, program, arguments);
            let message = output.stderr;
            match output.status.code() {
                Some(0) => done += 1,
                Some(2) if message.contains(" GiB of memory, ") => refused += 1,
                _ => panic!("{program} in {mebibytes} MiB: {}: {message}", output.status),
            }
        }
        assert!(refused > 0 && done > 0, "{program}: {refused} limits refused, {done} held");
    }
}
