//! Memory that is not granted ends a program with a message, whoever asks for it and how.

use cli::available_memory_bytes;
use std::{env, hint::black_box, path::Path, process::Command};

/// Set for the process that is to run out of memory.
const HOW: &str = "HOW_MEMORY_IS_FILLED";

/// Asks for memory until there is none.
fn fill(how: &str) {
    const TOO_MUCH: usize = 1 << 40;
    let pieces = || black_box(std::iter::from_fn(|| Some(Box::new(1_u64))).collect::<Vec<_>>()).len();
    let filled = match how {
        "at once" => black_box(vec![1_u8; TOO_MUCH]).len(),
        "zeros" => black_box(vec![0_u8; TOO_MUCH]).len(),
        "fallible" => black_box(Vec::<u8>::new().try_reserve_exact(TOO_MUCH)).map_or(0, |()| TOO_MUCH),
        "grown" => black_box(std::iter::from_fn(|| Some(1_u64)).collect::<Vec<_>>()).len(),
        "in pieces" => pieces(),
        _ => {
            std::thread::scope(|scope| [0; 4].map(|_| scope.spawn(pieces)).map(|t| t.join().unwrap_or(0)).iter().sum())
        }
    };
    unreachable!("{filled} pieces were granted");
}

/// The tree without the allocator was aborted by signal 6 in all of these.
#[test]
fn a_program_without_memory_says_so_and_ends_with_2() {
    if let Ok(how) = env::var(HOW) {
        assert!(available_memory_bytes().is_some());
        fill(&how);
        return;
    }
    if !Path::new("/bin/sh").exists() {
        return;
    }
    let own = env::current_exe().expect("this program");
    for how in ["at once", "zeros", "fallible", "grown", "in pieces", "by many threads"] {
        let mut command = Command::new("/bin/sh");
        command
            .args(["-c", "ulimit -v 150000 && exec \"$@\"", "sh"])
            .arg(&own)
            .args(["--nocapture", "--test-threads=1"]);
        let output = command.env(HOW, how).output().expect("it starts");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{how}: {:?} {message}", output.status);
        assert_eq!(message.lines().count(), 1, "{how}: {message}");
        assert!(message.starts_with("there is not enough memory: "), "{how}: {message}");
    }
}
