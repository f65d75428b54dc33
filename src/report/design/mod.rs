//! A test that was designed: what was chosen, for the terminal and as `design.json`.

pub(super) mod facts;
pub(super) mod terminal;
