//! Bytes as a file, because the programs open files by their names.

use std::path::Path;

/// A folder in memory, where the system has one: a fuzzer writes thousands of files a second.
const IN_MEMORY: &str = "/dev/shm";

/// Calls `use_file` with a file of these bytes that lies alone in its folder.
pub fn with_file<T>(name: &str, bytes: &[u8], use_file: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir_in(IN_MEMORY).or_else(|_| tempfile::tempdir()).expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("room for a temporary file");
    use_file(&path)
}
