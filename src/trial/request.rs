//! Which trial.

use super::class::Class;

/// A trial that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// What kind.
    pub class: Class,
    /// Which of them.
    pub index: u64,
}
