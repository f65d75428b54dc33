//! Motion: a program becomes a timed trajectory.
//!
//! Speeds are planned over whole stretches without a stop, in squared speeds and two passes: a block
//! begins and ends no faster than the programmed feeds, the acceleration along the path and the corners
//! allow. A corner sharper than the machine file's `corner_stop_deg` is taken with a stop, others at
//! the programmed feed. Rapids stop at both ends, as a control does that checks the position.
//!
//! **Not modelled:** per-axis limits at feed, jerk, block time, servo lag.
//!
//! An operator's pause (M00) has no known length. It is its own kind of time: in a trajectory it stands
//! at its place with length zero, and whoever aligns a log finds out how long it was.

mod profile;
mod trajectory;

pub use profile::Profile;
pub use trajectory::{Block, BlockKind, Duration, State, Trajectory};
