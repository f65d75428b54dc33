//! What a test will be, before it is run: for the terminal, as `plan.json` and as `plan.html`.

mod cautions;
pub(super) mod facts;
mod figures;
mod gather;
pub(super) mod html;
pub(super) mod planned;
mod rows;
pub(super) mod terminal;
mod unseen;
mod verdict;
mod words;
