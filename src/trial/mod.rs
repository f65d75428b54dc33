//! The standing trial: effects hidden at random, campaigns simulated, diagnosed without knowing, judged.
//!
//! ```text
//! draw ──> size ──> simulate ──> align, identify ──> diagnose ──> judge ──> table
//!            ^                                                      ^
//!            └──── what of an effect the fits of the model leave ───┘
//! ```
//!
//! A trial is its seed, its [`Class`] and its index: the same three hide the same effect on the same days
//! and give the same verdict, whatever the number of threads.
//!
//! **Size.** An effect of size `R` changes the residuals by `R` rms over all samples of all runs (a knock
//! too, though it is in one run only), after the fit of the model has taken its share. That share, and
//! what an effect does to the lengths, come from the exact chain with and without the effect; the columns
//! that look for effects are not used.
//!
//! **Not hidden**, because the terms of the trial do not see them or absorb them: the calibrated length of
//! the bar, the feed override, the clock, the place of the balls, the pivots, single coefficients.

mod archive;
mod chance;
mod class;
mod course;
mod data_set;
mod days;
mod draw;
mod files;
mod grid;
mod judge;
mod one;
mod rates;
mod request;
mod session;
mod simulated;
mod stage;
mod table;

pub use archive::{CampaignFiles, CampaignRow, campaigns_csv};
pub use class::{Class, IN_GRID, REQUIRED};
pub use course::{Course, CourseProgram, CourseRun};
pub use data_set::Made;
pub use draw::drawn;
pub use grid::{Grid, table as grid_table};
pub use judge::{Found, Judgement, Verdict};
pub use one::{OffBy, Outcome, Seconds};
pub use rates::Rate;
pub use request::Request;
pub use session::Session;
pub use stage::Trace;
pub use table::table;
