//! Motion: a program becomes a timed trajectory.
//!
//! Speeds are planned over whole stretches without a stop, in squared speeds and two passes: a block
//! begins and ends no faster than the programmed feeds, the accelerations and the corners allow. A corner
//! sharper than the machine file's `corner_stop_deg` is taken with a stop, others so fast that the speed
//! of no axis jumps by more than `corner_speed_step_mm_min`, or as an arc within `corner_tolerance_um` allows. Rapids stop at both ends, as a control does
//! that checks the position, and G61 and G09 stop at the end of a block. With `acceleration_change_ms`
//! the acceleration builds up in that time (bell-shaped acceleration) instead of at once.
//!
//! Slides may follow with a first-order lag ([`Followed`]).
//!
//! **Not modelled:** the in-position check at a stop, a look-ahead that is too short.
//!
//! Where a control has [recorded](crate::log::Recording) its motion, that stands in place of the estimate
//! ([`Trajectory::recorded`]).
//!
//! An operator's pause (M00) has no known length. It is its own kind of time: in a trajectory it stands
//! at its place with length zero, and whoever aligns a log finds out how long it was.

mod bell;
mod block;
mod builder;
mod driven;
mod followed;
mod limits;
mod matched;
mod profile;
mod reversals;
mod slides;
mod times;
mod trajectory;
mod turning;

pub use block::{Block, BlockKind, State};
pub use followed::Followed;
pub use profile::Profile;
pub use reversals::Reversals;
pub use times::Times;
pub use trajectory::{Duration, Trajectory};
