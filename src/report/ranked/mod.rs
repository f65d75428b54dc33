//! Features of the plane of each circular test, ranked by what repairing them would gain.
//!
//! [`RankingFacts`](facts::RankingFacts) is the one place where it is gathered: terminal, JSON and report read it and nothing
//! else.

pub(super) mod facts;
mod gather;
pub(super) mod html;
pub(super) mod remedies;
pub(super) mod terminal;
mod words;
