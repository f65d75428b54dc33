//! Circular tests of ISO 230-4 and what tolerances say of them, for people and for other programs.
//!
//! [`CircularFacts`](facts::CircularFacts) is the one place where it is gathered: terminal, JSON and report read it and
//! nothing else.

mod conformity;
pub(super) mod facts;
pub(super) mod gather;
pub(super) mod html;
pub(super) mod terminal;
pub(super) mod words;
