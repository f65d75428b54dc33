//! A blind trial: JSON.

pub(super) mod facts;
