//! A mapped file that somebody cuts short while it is read: one message and exit code 2, not a crash.

use signal_hook::{consts::SIGBUS, low_level};
use std::io::Write;

const MESSAGE: &[u8] = b"a file was cut short or its disk failed while it was read; \
write the new one beside it and rename, as these programs do, and run again\n";

/// From now on the kernel's word that a page of a mapped file is gone ends the process with exit code 2. Its temporary
/// file stays: the next that writes the same target removes it.
#[allow(unsafe_code)]
pub fn end_with_a_message() {
    // SAFETY: a handler may call only what is safe wherever the signal comes. This one comes where mapped memory is
    // read, in a thread that then holds no lock and is inside no allocation; what the lock of stderr may wait for is
    // another thread's system call. `low_level::exit` is the system's `_exit`, which runs nothing else.
    let registered = unsafe {
        low_level::register(SIGBUS, || {
            std::io::stderr().write_all(MESSAGE).ok();
            low_level::exit(2);
        })
    };
    registered.ok();
}
