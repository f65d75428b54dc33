//! A set-up of a designed test.

use super::candidates::SetUpCandidate;
use crate::plan::Arc;

/// One set-up of a proposal with its arcs in the order in which they are driven.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedSetUp {
    /// The set-up.
    pub set_up: SetUpCandidate,
    /// Its arcs.
    pub arcs: Vec<Arc>,
}
