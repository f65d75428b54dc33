//! Ctrl-C: while files change their places it waits, and before that it leaves nothing.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What shells give for a program that Ctrl-C ended: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

/// Held while files are written.
static WRITING: Mutex<()> = Mutex::new(());
/// Whether the user has asked to stop.
static CAME: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C, and a request to terminate, end the program in an orderly way.
pub(crate) fn heed() {
    // Where the system refuses a handler, Ctrl-C ends the program at once, and the next one sets the directory right.
    let _ = ctrlc::set_handler(|| {
        CAME.store(true, Ordering::SeqCst);
        let _finished = hold();
        leave();
    });
}

/// Keeps Ctrl-C waiting as long as the guard lives.
pub(super) fn hold() -> MutexGuard<'static, ()> {
    WRITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether the user has asked to stop.
pub(super) fn came() -> bool {
    CAME.load(Ordering::SeqCst)
}

/// Ends the program as interrupted.
pub(super) fn leave() -> ! {
    std::process::exit(INTERRUPTED)
}
