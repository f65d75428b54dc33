//! What can be in the name of a file.

/// Whether a letter can be in the name of a file on this system. On Windows `run 10:30.csv` is not a file but a part of `run 10`.
pub(crate) fn may_have(letter: char) -> bool {
    let on_windows = cfg!(windows) && matches!(letter, '<' | '>' | ':' | '"' | '|' | '?' | '*');
    !(letter.is_control() || matches!(letter, '/' | '\\') || on_windows)
}
