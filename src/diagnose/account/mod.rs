//! What it is worth: the gain, the numbers with their uncertainty, what moved, what nobody can see.

pub(super) mod arcs;
pub(super) mod costs;
pub(super) mod effects;
mod foretold;
pub(super) mod gain;
pub(super) mod left_out;
pub(super) mod moved;
pub(super) mod numbers;
pub(super) mod times;
pub(super) mod unseen;
