//! What a test will see before it is run, and which test sees most.

mod outlook;
mod planned;
mod volume;

pub use outlook::{MountingOutlook, Outlook, TimeByKind, Unseen};
pub use planned::PlannedProgram;
pub use volume::{PointSigma, Volume, VolumeSigma, of_coefficients};
