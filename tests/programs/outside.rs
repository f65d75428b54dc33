//! Tools by other authors, where they are installed; `.ci/run` installs them and asks for them.

use std::process::Command;

/// Whether an outside tool can be run. In CI it must be.
pub(crate) fn installed(tool: &str) -> bool {
    let found = Command::new("sh").args(["-c", &format!("command -v {tool}")]).output();
    found_or_skipped(found.is_ok_and(|output| output.status.success()), tool)
}

/// Whether a tool was found; if not, says that the test is skipped, or in CI fails it.
pub(crate) fn found_or_skipped(found: bool, tool: &str) -> bool {
    if found {
        return true;
    }
    assert!(
        std::env::var_os("BALLBAR_OUTSIDE_TOOLS").is_none(),
        "{tool} is not installed, and BALLBAR_OUTSIDE_TOOLS asks for it"
    );
    println!("skipped: {tool} is not installed; .ci/run installs it");
    false
}
