//! Renaming where others look on.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::input::is_in_use;

/// So long others may look at what was just written: a scanner takes some 10 ms for a file.
const PATIENCE: Duration = Duration::from_secs(2);
/// And then it is tried again.
const AGAIN: Duration = Duration::from_millis(10);

/// Renames a file or a directory, over a file that is there. A scanner for viruses opens what was just written, and as long
/// as it does, Windows renames neither the file nor a directory that it is in.
pub(super) fn rename(from: &Path, to: &Path) -> std::io::Result<()> {
    let began = Instant::now();
    loop {
        match std::fs::rename(from, to) {
            Err(error) if is_looked_at(&error) && began.elapsed() < PATIENCE => {
                std::thread::sleep(AGAIN);
            }
            renamed => return renamed,
        }
    }
}

/// Whether somebody may be looking at it, or into it: of a directory Windows says no more than that access is denied.
fn is_looked_at(error: &std::io::Error) -> bool {
    const ACCESS_DENIED: i32 = 5;
    is_in_use(error) || cfg!(windows) && error.raw_os_error() == Some(ACCESS_DENIED)
}
