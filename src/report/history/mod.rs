//! A machine over time: terminal, JSON and page.

pub(super) mod facts;
mod figures;
pub(super) mod html;
pub(super) mod terminal;
mod words;
