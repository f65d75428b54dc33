//! The paper's Sections 4 and 5 computed again, from both places of the pivot of X.
//!
//! [`Comparison`] holds every figure that the paper prints beside what comes out here; [`search`](search())
//! looks for the geometry that the paper does not state. What comes out is in `docs/paper.md`.

mod comparison;
mod search;
mod stages;
mod time;

pub use comparison::{Comparison, Geometry, MountingRow, Row, StrategyRows};
pub use search::{Found, FoundVolume, Nearest, search, search_steps};
pub use stages::{Pruning, Stage, removed_by, stages};
pub use time::{PAPER_READINGS, PAPER_TEST_S, PaperTime};
