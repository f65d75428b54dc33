//! The comparison with the paper: on the terminal, as a page, as JSON.

pub(super) mod facts;
pub(super) mod page;
mod rows;
pub(super) mod terminal;
