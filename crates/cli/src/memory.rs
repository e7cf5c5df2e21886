//! How much memory is left: of the machine, within the control group of a queue or container, and within `ulimit -v`.

use crate::Failure;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Memory that a program takes besides its data: code, stacks of threads, pools of the allocator.
const OVERHEAD_BYTES: u64 = 64 << 20;

/// The largest amount of memory that this process has held, bytes; 0 where the system does not tell.
pub fn peak_memory_bytes() -> u64 {
    status("VmHWM:").unwrap_or(0)
}

/// Memory that this process can still fill, bytes: the smallest remainder of all limits, where the system tells them.
pub fn available_memory_bytes() -> Option<u64> {
    let machine = read("/proc/meminfo").and_then(|text| kibibytes(&text, "MemAvailable:"));
    let group = read("/proc/self/cgroup").and_then(|text| group_headroom(&text, Path::new("/sys/fs/cgroup")));
    [machine, group, address_space()].into_iter().flatten().min()
}

/// Memory that work needs, bytes.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// Memory that is filled.
    pub held: u64,
    /// Memory of mapped files. The system can take it back, but `ulimit -v` counts it.
    pub mapped: u64,
}

/// Refuses, before any work is done, a need that cannot be met: that of `what`, where `way_out` says what the user can
/// do.
pub fn require_memory(what: &str, need: Need, way_out: &str) -> Result<(), Failure> {
    let held = need.held.saturating_add(OVERHEAD_BYTES);
    let limits = [(held, available_memory_bytes()), (held.saturating_add(need.mapped), address_space())];
    let gibibytes = |bytes: u64| bytes as f64 / 2f64.powi(30);
    match limits.into_iter().find_map(|(needed, left)| Some((needed, left.filter(|left| needed > *left)?))) {
        Some((needed, available)) => Err(Failure::usage(format!(
            "{what} needs {:.2} GiB of memory, {:.2} GiB are free; {way_out}",
            gibibytes(needed),
            gibibytes(available)
        ))),
        None => Ok(()),
    }
}

/// Address space that `ulimit -v` leaves, bytes.
fn address_space() -> Option<u64> {
    let limits = read("/proc/self/limits")?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit = line.split_whitespace().next()?.parse::<u64>().ok()?;
    Some(limit.saturating_sub(status("VmSize:")?))
}

/// The smallest remainder of the control groups that `memberships` names, the text of /proc/self/cgroup; they are
/// mounted at `root`.
fn group_headroom(memberships: &str, root: &Path) -> Option<u64> {
    let memory = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        match controllers {
            "" => Some((root.to_owned(), path.to_owned(), VERSION_2)),
            list if list.split(',').any(|name| name == "memory") => {
                Some((root.join("memory"), path.to_owned(), VERSION_1))
            }
            _ => None,
        }
    };
    let groups = memberships.lines().filter_map(memory);
    groups.filter_map(|(mount, path, files)| min_headroom(&mount, mount.join(path), files)).min()
}

/// Names of the files with the limit and the use of a group, and of the entries of its statistics that count pages of
/// files, which the system takes back when it needs them.
type Files = [&'static str; 4];
const VERSION_2: Files = ["memory.max", "memory.current", "inactive_file", "active_file"];
const VERSION_1: Files = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file", "total_active_file"];

/// The smallest remainder of a group and of those that contain it, each of which may have a limit. Inside a container
/// the path is that of the host, and only the group of the mount itself is visible.
fn min_headroom(mount: &Path, group: PathBuf, files: Files) -> Option<u64> {
    let groups = group.ancestors().take_while(|folder| folder.starts_with(mount));
    groups.filter_map(|folder| headroom(folder, files)).min()
}

fn headroom(folder: &Path, [limit, used, inactive, active]: Files) -> Option<u64> {
    let number = |name: &str| read(folder.join(name))?.trim().parse::<u64>().ok();
    let statistics = read(folder.join("memory.stat")).unwrap_or_default();
    let entry = |name: &str| {
        let found = statistics.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
        found.unwrap_or(0)
    };
    let kept = number(used)?.saturating_sub(entry(inactive) + entry(active));
    Some(number(limit)?.saturating_sub(kept))
}

fn status(name: &str) -> Option<u64> {
    kibibytes(&read("/proc/self/status")?, name)
}

/// The value of a line `name 123 kB`, in bytes.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

fn read(path: impl AsRef<Path>) -> Option<String> {
    fs::read_to_string(path).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: pages of files counted as used, containing groups left out.
    #[test]
    fn the_smallest_remainder_of_all_groups_counts() {
        let root = tempfile::tempdir().expect("a folder");
        let group = |path: &str, files: &[(&str, &str)]| {
            let folder = root.path().join(path);
            fs::create_dir_all(&folder).expect("makes");
            for (name, text) in files {
                fs::write(folder.join(name), text).expect("writes");
            }
        };
        let stat = ("memory.stat", "anon 5\ninactive_file 30\nactive_file 20\n");
        group("", &[("memory.max", "max\n")]);
        group("job", &[("memory.max", "1000\n"), ("memory.current", "300\n"), stat]);
        group("job/step", &[("memory.max", "max\n"), ("memory.current", "300\n")]);
        assert_eq!(group_headroom("0::/job/step\n", root.path()), Some(750));
        assert_eq!(group_headroom("0::/elsewhere\n", root.path()), None);

        let old = ("memory.stat", "inactive_file 1\ntotal_inactive_file 100\ntotal_active_file 0\n");
        group("memory/uid", &[("memory.limit_in_bytes", "500"), ("memory.usage_in_bytes", "200"), old]);
        assert_eq!(group_headroom("3:cpu,memory:/uid\n1:cpu:/\n0::/job\n", root.path()), Some(400));
    }

    #[test]
    fn this_process_has_memory_and_the_message_says_the_need() {
        let available = available_memory_bytes().expect("the system tells");
        assert!(available > 0 && peak_memory_bytes() > 0);
        require_memory("nothing", Need { held: 0, mapped: 0 }, "").expect("fits");
        let message =
            require_memory("all", Need { held: 1 << 60, mapped: 0 }, "take less").expect_err("does not").message;
        assert!(message.starts_with("all needs 1073741824.06 GiB of memory, "), "{message}");
        assert!(message.ends_with("; take less"), "{message}");
    }
}
