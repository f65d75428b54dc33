//! Runs that took no part, with the reason.

use serde::Serialize;

use crate::error::Error;

/// Runs that took no part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Name of the run, or names of the runs of one repeat.
    #[serde(rename = "run")]
    pub runs: String,
    /// Why, in a sentence without a full stop.
    pub reason: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl LeftOut {
    /// Of what the error says the sentence, without the picture below it.
    pub(crate) fn of(runs: &str, error: &Error) -> Self {
        Self {
            runs: runs.to_owned(),
            reason: error.what.lines().next().unwrap_or_default().to_owned(),
            hint: error.hint.clone(),
        }
    }
}
