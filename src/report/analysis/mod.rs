//! The results of a test: `analysis.json`, `report.html`, the samples as CSV, the summary for the terminal.
//!
//! [`Analysis`](facts::Analysis) is the one place where numbers are gathered; terminal, JSON and the tables of
//! the page read it and nothing else. Curves are drawn from the identifications themselves.

mod advice;
mod arc_table;
mod before;
pub(super) mod cautions;
mod control;
mod control_text;
mod driven;
pub(super) mod facts;
mod figures;
mod front;
pub(super) mod gather;
pub mod html;
mod live;
pub(super) mod machine_errors;
pub(super) mod means;
mod mountings;
mod paths;
pub(super) mod place;
mod record;
pub(super) mod run_facts;
mod run_tables;
pub(super) mod samples;
pub(super) mod shown;
mod tables;
pub(super) mod terminal;
mod traces;
mod uncertain;
mod verdict;
