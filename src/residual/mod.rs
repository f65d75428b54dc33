//! What a fit leaves: samples, what the model follows, noise, and what an effect explains beside others.
//!
//! ```text
//! campaign ──> Residuals ──beside(columns)──> Beside ──fit(elements)──> Fitted
//!              samples, basis Q               what is left,             amplitudes, numbers inside,
//!              what the model leaves          noise                     gain, covariance
//! ```
//!
//! All of them are values: nothing here changes once it is made. Every repeat keeps its own coefficients,
//! set-up and times; an effect is one for all repeats. A further column `c` counts by what the fits of the
//! model do not follow, `c' = c - Q Q^T c` ([`Basis`](crate::solve::Basis)), and beside accepted effects by
//! what these do not follow either. So an effect is never credited with what a cubic explains, nor the model
//! blamed for it.
//!
//! Samples and columns are multiplied by the root of the weight that the fit gave each sample.

mod began;
#[cfg(test)]
pub(crate) mod bench;
mod beside;
mod column;
mod element;
mod fitted;
mod joint;
mod likeliest;
mod long_run;
mod noise;
mod residuals;
mod structure;
mod system;
#[cfg(test)]
mod tests;

pub use beside::Beside;
pub use column::Column;
pub use element::{Element, Owner, Tuning};
pub use fitted::Fitted;
pub use joint::{fit, fit_to};
pub use noise::Noise;
pub use residuals::{Repeat, Residuals, Run, Sample};
pub use structure::{Products, Structure, products, structure};
pub use system::{Anywhere, System};
