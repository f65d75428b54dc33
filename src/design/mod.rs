//! What a test will see before it is run, and which test sees most.

mod volume;

pub use volume::{PointSigma, Volume, VolumeSigma, of_coefficients};
