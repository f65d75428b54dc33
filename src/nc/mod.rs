//! Numerical control.
mod program;
pub use program::{Action, Move, Path, Program, Step};
