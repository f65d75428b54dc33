//! What a test will see before it is run, and which test sees most.

mod candidates;
mod choosable;
mod filling;
mod given;
mod information;
mod ordering;
mod outlook;
mod planned;
mod problem;
mod proposal;
mod proposed;
mod relaxed;
mod search;
mod set_up_choice;
#[cfg(test)]
mod tests;
mod volume;
mod written;

pub use candidates::{SetUpCandidate, can_drive, candidate_arcs, set_up_candidates};
pub use given::Measured;
pub use outlook::{MountingOutlook, Outlook, TimeByKind, Unseen};
pub use planned::PlannedProgram;
pub use proposal::{Designer, NextArc, Proposal};
pub use proposed::ProposedSetUp;
pub use volume::{PointSigma, Volume, VolumeSigma, of_coefficients};
