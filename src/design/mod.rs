//! What a test will see before it is run, and which test sees most.

mod candidates;
mod information;
mod outlook;
mod planned;
mod search;
mod volume;

pub use candidates::{SetUpCandidate, can_drive, candidate_arcs, set_up_candidates};
pub use outlook::{MountingOutlook, Outlook, TimeByKind, Unseen};
pub use planned::PlannedProgram;
pub use volume::{PointSigma, Volume, VolumeSigma, of_coefficients};
