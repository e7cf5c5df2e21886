use super::*;

#[test]
fn a_dropped_output_leaves_the_old_file_and_no_other() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("file");
    write(&path, b"old").expect("writes");
    let mut output = Output::create(&path).expect("creates");
    output.write_all(b"new").expect("buffers");
    drop(output);
    assert_eq!(fs::read(&path).expect("reads"), b"old");
    assert_eq!(fs::read_dir(folder.path()).expect("lists").count(), 1);
}

#[test]
fn a_committed_output_replaces_the_file() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("file");
    write(&path, b"old").expect("writes");
    write(&path, b"new").expect("writes");
    assert_eq!(fs::read(&path).expect("reads"), b"new");
    assert_eq!(fs::read_dir(folder.path()).expect("lists").count(), 1);
}

/// Seen to catch: the lock left out, every temporary file of the folder taken.
#[test]
fn temporary_files_of_killed_processes_are_removed_and_of_live_ones_are_not() {
    let folder = tempfile::tempdir().expect("folder");
    let path = |name: &str| folder.path().join(name);
    let names = || {
        let list = fs::read_dir(folder.path()).expect("lists");
        let mut names: Vec<_> = list.map(|e| e.expect("entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    };
    let strangers = [".a.cloud.1-.tmp", ".a.cloud.1-2-3.tmp", ".a.cloud.old.tmp", ".b.cloud.1-2.tmp"];
    for name in strangers.iter().chain(&[".a.cloud.99-0.tmp", ".a.cloud.99-1.tmp"]) {
        fs::write(path(name), b"half").expect("writes");
    }
    let live = Output::create(&path("a.cloud")).expect("creates");
    write(&path("a.cloud"), b"whole").expect("writes beside a live one");
    assert_eq!(names().len(), strangers.len() + 2, "{:?}", names());
    live.commit().expect("is still there");
    let mut expected = strangers.map(str::to_owned).to_vec();
    expected.push("a.cloud".into());
    assert_eq!(names(), expected);
}

#[test]
fn a_full_device_is_an_error_and_stays_a_device() {
    let full = Path::new("/dev/full");
    if full.exists() {
        let message = write(full, &[0; 100]).expect_err("no space").to_string();
        assert!(message.contains("/dev/full"), "{message}");
        assert!(!fs::metadata(full).expect("still there").is_file());
    }
}

#[test]
fn a_target_in_no_folder_is_an_error_at_once() {
    assert!(Output::create(Path::new("no/such/folder/file")).is_err());
    assert!(Output::create(Path::new(".")).is_err());
}

/// Seen to catch: no permissions kept, permissions kept under the umask, the link replaced.
#[test]
fn a_replaced_file_keeps_its_permissions_and_links_stay_links() {
    let folder = tempfile::tempdir().expect("folder");
    let path = |name: &str| folder.path().join(name);
    let mode = |name: &str| fs::metadata(path(name)).expect("there").permissions().mode() & 0o7777;
    for wanted in [0o664, 0o600, 0o666, 0o755] {
        fs::write(path("file"), b"old").expect("writes");
        fs::set_permissions(path("file"), fs::Permissions::from_mode(wanted)).expect("sets");
        let output = Output::create(&path("file")).expect("creates");
        let temporary = output.temporary.clone().expect("a regular file has one");
        let during = fs::metadata(&temporary).expect("there").permissions().mode() & 0o777;
        assert_eq!(during & !wanted, 0, "{during:o} while a file of {wanted:o} is written");
        output.commit().expect("replaces");
        assert_eq!(mode("file"), wanted, "{:o} instead of {wanted:o}", mode("file"));
    }
    fs::create_dir(path("real")).expect("makes");
    std::os::unix::fs::symlink("real/one", path("link")).expect("links");
    std::os::unix::fs::symlink("link", path("chain")).expect("links");
    for content in [b"1", b"2"] {
        // In the first round the links lead to no file.
        write(&path("chain"), content).expect("writes");
        assert_eq!(fs::read(path("real/one")).expect("reads"), content);
    }
    for link in ["link", "chain"] {
        assert!(fs::symlink_metadata(path(link)).expect("there").is_symlink(), "{link}");
    }
    std::os::unix::fs::symlink("circle", path("circle")).expect("links");
    write(&path("circle"), b"").expect_err("a link to itself");
}

/// Seen to catch: the whole name in the temporary one, which then has 266 bytes.
#[test]
fn any_name_that_the_file_system_takes_is_taken() {
    let folder = tempfile::tempdir().expect("folder");
    for length in [LONG_NAME, LONG_NAME + 1, 200, 255] {
        let path = folder.path().join("n".repeat(length));
        write(&path, b"content").expect("writes");
        // A temporary file that a killed process left for a long name is found again.
        let left = temporary_name(&path).expect("a name");
        fs::write(&left, b"half").expect("writes");
        write(&path, b"again").expect("writes");
        assert!(!left.exists(), "{length}");
    }
    let message = check(&folder.path().join("n".repeat(256))).expect_err("too long").to_string();
    assert!(message.contains("too long"), "{message}");
}

/// Seen to catch: the check of the file's kind left out, where each of these waits for ever.
#[test]
fn pipes_are_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().expect("folder");
    let pipe = |name: &str| {
        let path = folder.path().join(name);
        assert!(std::process::Command::new("mkfifo").arg(&path).status().expect("starts").success());
        path
    };
    let message = write(&pipe("fifo"), b"").expect_err("refused").to_string();
    assert!(message.contains("fifo: cannot write: is a pipe"), "{message}");
    let left = pipe(".file.99-0.tmp");
    write(&folder.path().join("file"), b"content").expect("writes");
    assert!(left.exists());
}

/// Seen to catch within a few rounds: no lock.
#[test]
fn after_two_simultaneous_groups_all_files_are_those_of_one() {
    let folder = tempfile::tempdir().expect("folder");
    let names = ["image.exr", "image.png", "image.json"].map(|name| folder.path().join(name));
    for _ in 0..100 {
        let barrier = std::sync::Barrier::new(2);
        thread::scope(|scope| {
            for run in [b"one", b"two"] {
                let (names, barrier) = (&names, &barrier);
                scope.spawn(move || {
                    let mut group = Group::default();
                    names.iter().for_each(|name| group.write(name, run).expect("writes"));
                    barrier.wait();
                    group.commit().expect("commits");
                });
            }
        });
        let found = names.each_ref().map(|name| fs::read(name).expect("reads"));
        assert!(found.iter().all(|bytes| *bytes == found[0]), "{found:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("lists").count(), names.len());
}

/// A signal removes the temporary files that are in the list, so that each must be there while it exists.
///
/// Seen to catch: a file that was added to the list after it had been created.
#[test]
fn every_temporary_file_is_in_the_list() {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let folder = fs::canonicalize(folder.path()).expect("it exists");
    let target = folder.join("a.cloud");
    let done = std::sync::atomic::AtomicBool::new(false);
    let unlisted = thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                Output::create(&target).expect("the folder is writable");
            }
        });
        let unlisted: usize = (0..5000)
            .map(|_| {
                let listed = registered();
                let files = fs::read_dir(&folder).expect("it exists").map(|entry| entry.expect("it is read").path());
                files.filter(|path| !listed.contains(path)).count()
            })
            .sum();
        done.store(true, Ordering::Relaxed);
        unlisted
    });
    assert_eq!(unlisted, 0, "files of 5000 readings");
}
