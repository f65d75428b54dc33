//! Alignment: which sample was taken where.
//!
//! The instrument and the machine share no clock. Known are the program, the feed, the acceleration and
//! what the log shows by itself: the moments of engagement and release, where the reading runs through
//! the bar's range at the speed of the feed-in, and standstills. From these comes the time map
//!
//! `program time = (1 + rate) · log time - offset[leg]`,
//!
//! one offset a *leg*, the part of a program between two operator's pauses; the difference of two
//! offsets is how long the operator let the machine stand. Inside a leg without a ramp the offset is
//! known only to about a second here; the room `identify` refines it together with the coefficients.
//!
//! The map is straight inside a leg. A log that lost readings there without a gap in its times, or a
//! machine that stood where the program does not say so, is refused by [`TimeStep`].

mod breaks;
mod by_angle;
mod carried;
mod clipped;
mod data_arc;
mod draft;
mod engaged;
mod engagement;
mod following;
mod lay;
mod leg_chords;
mod mean_path;
mod means;
mod misread;
mod off_centre;
mod pace;
mod path_steps;
mod ramp;
mod rounding;
mod run;
mod samples;
mod section;
mod slip;
mod steps;
mod stops;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
mod tests;
mod time_map;
mod turns;
mod waits;
mod window;

pub use breaks::Break;
pub use by_angle::by_angle;
pub use carried::FOLLOWING_S;
pub use clipped::taken_out as clipped;
pub use engaged::Slip;
pub use engagement::{Engagement, Refusal};
pub use following::Following;
pub use lay::align;
pub use misread::{Misread, misread};
pub use off_centre::{OffCentre, off_centre};
pub use ramp::{Mark, MarkKind};
pub use rounding::NO_SAG_MM;
pub use run::{Rig, Run};
pub use samples::{Alignment, Part, Sample};
pub use section::{Circle, Section};
pub use steps::{ArcTime, TimeStep};
pub use time_map::{Moment, TimeMap};
pub use waits::read_while_it_waited;
pub use window::averaged;
