//! What the model gets wrong, for people and for other programs.
//!
//! [`DiagnosisFacts`] is the one place where it is gathered: terminal, JSON and report read it and nothing
//! else.

mod facts;
mod gather;
mod terminal;
mod verdict;
mod words;

pub use facts::{
    DiagnosisFacts, FeatureFacts, FindingFacts, LeftOutFacts, MovedFacts, NumberFacts,
    ProgramGainFacts, RivalFacts, RunGainFacts, StructureFacts,
};
pub use terminal::diagnosis_text;
pub(super) use terminal::in_short;
