//! What somebody begins with: a machine file and a test file that belong together, and what every key of them means.
//!
//! The place of the balls is chosen with the planner itself: the test that is written has a program that passes its
//! own check. The comments of the files are those of `docs/reference.md`, which is in the program.

mod begun;
mod commented;
mod machine_file;
mod measured;
mod place;
mod reference;
mod test_file;
mod test_kind;
#[cfg(test)]
mod tests;
mod travel;
mod wish;

pub use begun::Begun;
pub use measured::Measured;
pub use reference::{Entry, REFERENCE, Reference};
pub use test_kind::TestKind;
pub use travel::{Travel, Zero};
pub use wish::Wish;
