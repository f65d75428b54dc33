//! Inputs that nobody thought of, for every reader of ballbar.
//!
//! | module | holds |
//! | --- | --- |
//! | [`choices`] | random numbers, or those that an engine gives: what is done to an input |
//! | [`mutate`] | what can be done to an input: bytes, numbers, words, lines, the file as a whole |
//! | [`seeds`] | what mutations begin with: the project's own files |
//! | [`targets`] | one function for each reader, and what the commands do with what it accepts |
//! | [`limits`] | how much memory and time an input may take |
//! | [`campaign`] | replays the corpus, runs mutated inputs, keeps what fails |
//!
//! `fuzz/README.md` says how to run it.

pub mod campaign;
pub mod choices;
pub mod limits;
pub mod mutate;
pub mod seeds;
pub mod targets;
