//! A second, small judge of the path. It shares no code with `src/nc`: it has its own reader of words, its own modal state,
//! its own motion and its own geometry, and takes from the library only what the machine and the test file say.
//!
//! Programs with one fault in them are judged by it and by `ballbar check`; programs of tests drawn at random are written
//! and judged. [`verdict`] says what is dangerous and what is harmless.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod arcs;
mod bodies;
mod control;
mod drawn;
mod drawn_tests;
mod faults;
mod klartext;
mod known;
mod known_spoken;
mod modal;
mod mutations;
mod path;
mod power;
mod programs;
mod setting;
mod siemens;
mod tongue;
mod verdict;
mod walk;
mod words;
