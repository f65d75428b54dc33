//! A virtual machine and a virtual instrument.
//!
//! ```text
//! program ──> motion ──> state ──> bend ──> exact chain ──> length ──> instrument ──> readings
//!               ^                   ^                                      ^
//!          feed override     error functions,                 noise, steps, range, dropouts,
//!                            set-up errors,                   a clock of its own
//!                            hidden effects
//! ```
//!
//! The length is that of [`crate::machine::Machine::ball_vector_mm`], bent by
//! [`crate::model::ErrorFunctions`]. The terms' columns, and the way terms bend the chain, are not used
//! here: a wrong column must not agree with itself.
//!
//! The instrument's clock runs beside the machine's:
//!
//! ```text
//! program time = log time · (1 + ppm · 1e-6) - start - operator's pauses so far
//! ```
//!
//! with the start and the pauses in seconds of the machine's clock. While the operator pauses, the
//! machine stands and the bar reads on if it is in range.
//!
//! Everything random is drawn from `rand_pcg` by the scenario's seed: the same seed gives the same bits.
//! Pauses, white noise, correlated noise, dropouts and the phases of vibrations have a stream each, so
//! changing one of them leaves the others as they were.
//!
//! Whatever a machine does beyond its error functions is an effect that a scenario hides: each cause of
//! [`crate::model::CAUSES`] can be, and `hidden` is where another one belongs.
//!
//! **Not modelled:** what the room `motion` does not model, such as the in-position check at a stop, and
//! elasticity.

mod asked;
mod bend;
mod clock;
mod control;
mod file;
mod hidden;
mod instrument;
mod noise;
mod place;
mod random;
mod run;
mod scenario;
#[cfg(test)]
mod tests;
mod write;

pub use asked::at_the_place;
pub use clock::{Clock, ClockMoment};
pub use control::Control;
pub use noise::Noise;
pub use place::PlaceErrors;
pub use run::{SimulatedRun, TruePoint, run};
pub use scenario::{Coincidence, Dropouts, Pauses, Scenario};
pub use write::{TrueRun, truth_toml};
