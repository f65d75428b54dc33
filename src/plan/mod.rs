//! The plan of a test: arcs on the sphere and in planes, strategies, and the path that a program will drive.
//!
//! Points are vectors from the workpiece ball to the tool ball in programmed coordinates, mm. Angles
//! on the sphere: polar angle from the tool axis Z, azimuth from X towards Y.

mod arc;
#[cfg(test)]
mod bounds_tests;
mod clearance;
mod design_request;
mod leg;
pub mod log_format;
mod log_text;
mod operator;
mod parts;
mod path;
mod planar;
mod plane;
mod raw;
mod raw_arc;
mod raw_feeds;
mod raw_log;
mod raw_mounting;
mod raw_plan;
mod record;
mod step;
mod strategy;
mod test_file;
mod tolerance;
mod ways;

pub use arc::Arc;
pub use clearance::{LeastClearance, Part};
pub use design_request::{Criterion, DesignRequest, Places};
pub use leg::{Interpolation, Leg, OVERSHOOT};
pub use operator::Operator;
pub use parts::{BallBar, Estimation, NamedMounting, PathPlan, Run};
pub use path::Path;
pub use planar::{Planar, Planes};
pub use plane::Plane;
pub(crate) use raw::CORRELATIONS_S;
pub(crate) use raw_feeds::FEEDS_MM_MIN;
pub(crate) use raw_log::ARCS_DEG;
pub(crate) use raw_mounting::LENGTHS_MM;
pub use record::{Record, Warmth};
pub use step::{Circular, Step};
pub use strategy::Strategy;
pub use test_file::Test;
pub use tolerance::Tolerance;
pub use ways::BAR_STOPS;
