//! What could be there: every cause on every seat, curves, steps and lines.

pub(super) mod candidate;
pub(super) mod channel;
pub(super) mod curves;
pub(super) mod knock;
pub(super) mod screen;
#[cfg(test)]
mod tests;
pub(super) mod vibration;
