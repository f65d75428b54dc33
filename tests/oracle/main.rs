//! The rooms `machine`, `model`, `align` and `identify` held against independent oracles and against
//! data that this code did not make.
//!
//! | module | oracle |
//! | --- | --- |
//! | `columns` | central differences of the exact chain, and a chain of 4x4 transforms in dual numbers |
//! | `kinematics` | forward after inverse |
//! | `ranks` | the tables of `DESIGN.md`, section 4, which were computed apart from this code |
//! | `truth` | what was put into the logs of `tests/data` |
//! | `refusal` | logs laid over programs that they do not belong to, logs that lost something |
//! | `determinism` | the same bits on every run and with every number of threads |
//!
//! `cargo test --release --test oracle -- --nocapture` shows every number that was measured.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod chain;
mod columns;
mod common;
mod determinism;
mod dual_chain;
mod kinematics;
mod local;
mod ranks;
mod refusal;
mod truth;
