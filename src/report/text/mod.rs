//! Words and numbers as they are written: lines for a terminal, decimals, units, lists.

pub(super) mod filters;
pub(super) mod layout;
pub(super) mod markup;
pub(super) mod numbers;
pub(super) mod policy;
pub(super) mod units;
pub(super) mod words;
