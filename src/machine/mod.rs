//! The machine: its description file, its kinematic chain, and the way from ball positions to axis positions.
//!
//! **Frames.** `F` is the machine frame, at the nominal crossing of the rotary axes. All slides are
//! parallel to `F` when every error is zero. The topology string reads from the workpiece `w` to `F`
//! and on to the tool `t`: letters left of `F` carry the workpiece, letters right of it carry the tool.
//!
//! **Axis positions** `h` are machine coordinates in the programmed sense: +X, +Y and +Z always move the
//! tool that way *relative to the workpiece* (ISO 841), so a slide on the workpiece side moves against
//! its own letter in `F`.
//!
//! **Not modelled here:** motion of the rotary axes and the spindle (they stand still in a ball-bar
//! test), elasticity, temperature.

mod axis;
mod bounds;
mod builtin;
mod chain;
mod clearance;
mod controller;
mod file;
mod inverse;
mod plausible;
mod topology;

pub use axis::Axis;
pub use builtin::Builtin;
pub use chain::{ChainErrors, Lever, Mounting, Pose, SlideError};
pub use clearance::{Clearance, Cylinder};
pub use controller::{Controller, Dialect};
pub use file::{Machine, Pivot, Slide};
pub use plausible::Plausible;
pub use topology::{Side, Topology};
