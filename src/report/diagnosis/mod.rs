//! What the model gets wrong, for people and for other programs.
//!
//! [`DiagnosisFacts`](facts::DiagnosisFacts) is the one place where it is gathered: terminal, JSON and report read
//! it and nothing else.

pub(super) mod facts;
mod figures;
mod gather;
pub(super) mod html;
pub(super) mod owner;
pub(super) mod settings;
pub(super) mod terminal;
pub(super) mod verdict;
mod views;
mod words;
