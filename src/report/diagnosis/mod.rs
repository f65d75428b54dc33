//! What the model gets wrong, for people and for other programs.
//!
//! [`DiagnosisFacts`] is the one place where it is gathered: terminal, JSON and report read it and nothing
//! else.

mod facts;
mod figures;
mod gather;
pub(super) mod html;
mod terminal;
mod verdict;
mod views;
mod words;

pub use facts::{
    ArcFacts, BinFacts, DiagnosisFacts, FeatureFacts, FindingFacts, LeftOutFacts, MovedFacts,
    NumberFacts, OffTimeFacts, PictureFacts, PointFacts, ProgramGainFacts, RivalFacts,
    RunGainFacts, StructureFacts, ViewFacts, WrongSettingFacts,
};
pub use terminal::diagnosis_text;
pub(super) use terminal::in_short;
