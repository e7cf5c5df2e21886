//! Where a mapped file is truncated while it is read, the program ends with one message and exit code 2 instead of a
//! crash.

use signal_hook::{consts::SIGBUS, low_level};
use std::io::Write;

const MESSAGE: &[u8] = b"a file was cut short or its disk failed while it was read; \
write the new one beside it and rename, as these programs do, and run again\n";

/// From now on SIGBUS, by which the kernel tells that a page of a mapped file is gone, ends the process with exit code
/// 2. A temporary file stays, and the next writer of the same target removes it.
#[allow(unsafe_code)]
pub fn end_with_a_message() {
    // SAFETY: a handler may call only what is safe wherever the signal can arrive. This one arrives where mapped memory is
    // read, in a thread that holds no lock and is inside no allocation; the lock of stderr can only be held by another
    // thread, for the time of a system call. `low_level::exit` is the system's `_exit`, which runs no other code.
    let registered = unsafe {
        low_level::register(SIGBUS, || {
            std::io::stderr().write_all(MESSAGE).ok();
            low_level::exit(2);
        })
    };
    registered.ok();
}
