//! Circular tests as ISO 230-4 has them: what a path over an arc is by itself, without a model of the machine.
//!
//! The path is the readings of the data arc at the angles of their estimated places. With `rho` the length minus the nominal
//! length `R`, `u` the direction of the bar, `t` that along the path and `c` the centre of the least-squares circle, which is how far the balls were
//! set beside each other, the radial deviation is
//!
//! ```text
//! e = sqrt((R + rho)² - (c·t)²) - R - c·u
//! ```
//!
//! | value | is |
//! | --- | --- |
//! | G, circular deviation | smallest distance of two concentric circles that hold the path of one way between them: minimum zone; beside it the range about the least-squares circle |
//! | G(b), bi-directional circular deviation | the same of both ways together, about one centre |
//! | F max, F min, radial deviation | largest and smallest `e`, outward positive, about the least-squares centre; of whole circles only |
//! | D, mean bi-directional radial deviation | radius of the least-squares circle of both ways minus `R`; of whole circles only |
//! | H, circular hysteresis | largest difference of the two ways at one angle, as ISO 230-4:1996 had it |
//!
//! The uncertainty of each has its noise and the scale of the transducer (`scale_sigma_percent` of the value: what the bar reads of a centre
//! beside its own is taken off with the same scale). F and D need a bar whose length is known besides: `length_sigma_um`. On a part of a circle centre and radius hang
//! together, so that neither F nor D is told, and G is what the centre has left of it: the condition number says how much.
//!
//! **Noise widens.** A range is never too small by noise. What noise does to every value is seen on what the fit computes for
//! the same places: with noise drawn as the fit found it, the values scatter (`noise`) and come out larger (`widened`). What was
//! read is told as it is; nothing is taken off.

mod draw;
mod driven;
mod found;
mod passes;
mod thresholds;
mod values;

pub use driven::{CircularTest, Driven, Untold, of};
pub use found::{Found, Way, WayPath};
pub use passes::Filter;
pub use values::Ways;
