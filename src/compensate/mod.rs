//! What the errors of a machine do to a workpiece: the displacement of a tool anywhere, and what follows from it.
//!
//! An [`ErrorModel`] is what an analysis says of a machine where it was measured: its parameters with their covariance by the noise
//! and by all, and the effects that a diagnosis found beside them. It comes from a campaign, or from the `error_model` of an
//! `analysis.json` that was [read](Analysed::read) back.
//!
//! **One rule for signs.** `e = actual - commanded` of the tool *against the workpiece* along the programmed positive
//! directions. It is taken from the exact chain, where a slide that carries the workpiece has its other sign. What compensates
//! is `-e`. Positions are machine coordinates.

mod bounds;
mod compensation;
mod controls;
mod correct;
mod error_model;
mod field;
mod figures;
mod foretold;
mod left;
mod near;
mod read;
mod rigid;
mod shrink;
mod stored;
mod tables;
#[cfg(test)]
mod tests;
mod volume;
mod wanted;
mod worth;

pub use compensation::{Compensating, Compensation, LARGEST_MM, OnePoint};
pub use controls::{Control, Limits, Named, Written};
pub use correct::{Corrected, Correcting, correct};
pub use error_model::{ErrorModel, Held};
pub use field::{Displacement, Field, Row, Sigmas};
pub use figures::{Figure, Figures};
pub use foretold::{Line, LinePoint};
pub use left::{Group, Left, Sizes};
pub use near::Measured;
pub use read::Analysed;
pub use shrink::Shrunk;
pub use stored::Stored;
pub use tables::{Column, Grid, SlideTable, Tables, Ways};
pub use volume::{MOST_POINTS, Node, Volume, VolumeMap};
pub use worth::Worth;
