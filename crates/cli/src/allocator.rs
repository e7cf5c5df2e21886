//! Where the system grants no memory, every program ends with one message and exit code 2 instead of an abort.
//!
//! [`crate::require_memory`] refuses large data before any work; this allocator covers everything else, of any size and
//! in any library.

use signal_hook::low_level;
use std::{
    alloc::{GlobalAlloc, Layout, System},
    io::Write,
    panic,
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

const MESSAGE: &[u8] = b"there is not enough memory: raise its limit (`ulimit -v`, that of the container or queue), \
or take smaller inputs or fewer threads, and run again\n";

/// The system's allocator, except that it ends the process instead of returning null.
struct EndsWhenFull;

#[global_allocator]
static ALLOCATOR: EndsWhenFull = EndsWhenFull;

// SAFETY: every call is passed on to the system's allocator with the same arguments, and its result is returned; if that is
// null, the process ends instead.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for EndsWhenFull {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise about `layout` is the one that `System` asks for.
        granted(unsafe { System.alloc(layout) })
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        granted(unsafe { System.alloc_zeroed(layout) })
    }

    #[inline]
    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promises about the block, its layout and its new size are those that `System` asks for, and
        // the block comes from `System`.
        granted(unsafe { System.realloc(old, layout, size) })
    }

    #[inline]
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) }
    }
}

#[inline]
fn granted(block: *mut u8) -> *mut u8 {
    if block.is_null() {
        end();
    }
    block
}

/// From now on, the process also ends if a thread is not granted the stack on which it handles signals, where the
/// standard library panics.
pub fn end_without_signal_stacks() {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if info.payload_as_str().is_some_and(|what| what.starts_with("failed to allocate an alternative stack")) {
            end();
        }
        usual(info);
    }));
}

/// Ends the process without asking for memory: the message is static, stderr has no buffer, and `low_level::exit` is
/// the system's `_exit`. A temporary file stays, and the next writer of the same target removes it.
#[cold]
fn end() -> ! {
    static ENDING: AtomicBool = AtomicBool::new(false);
    if ENDING.swap(true, Ordering::Relaxed) {
        // Another thread prints the message.
        loop {
            std::thread::sleep(Duration::from_secs(1));
        }
    }
    std::io::stderr().write_all(MESSAGE).ok();
    low_level::exit(2);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    /// Seen to fail without the hook: the process was aborted by signal 6.
    #[test]
    fn a_thread_without_a_signal_stack_ends_the_process_with_2() {
        const MARK: &str = "A_THREAD_PANICS";
        if std::env::var_os(MARK).is_some() {
            end_without_signal_stacks();
            panic!("failed to allocate an alternative stack: Cannot allocate memory (os error 12)");
        }
        let own = std::env::current_exe().expect("this program");
        let name = "allocator::tests::a_thread_without_a_signal_stack_ends_the_process_with_2";
        let output =
            Command::new(own).args([name, "--exact", "--nocapture"]).env(MARK, "1").output().expect("it starts");
        assert_eq!((output.status.code(), &output.stderr[..]), (Some(2), MESSAGE));
    }
}
