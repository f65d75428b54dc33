//! What is named where an effect is hidden in a log, and where none is.

#![allow(clippy::unwrap_used, clippy::panic)]

mod blind;
mod everywhere;
mod judge;
mod laid_over;
mod measured;
