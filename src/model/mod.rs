//! The error model: coefficient names, error functions, terms and the projected Jacobian.
//!
//! Each slide H has six error functions
//! `E_IH(h, b) = E_IH0 + E_IH1 h + E_IH2 h² + E_IH3 h³ + b E_IHb` (paper, Eq. 3) of its machine
//! coordinate `h` (mm) and its sense `b`; `EXH EYH EZH` are in mm, `EAH EBH ECH` in rad, all in
//! directions of the machine frame, and they describe the displacement of *that slide*. With the six
//! set-up errors of the two balls this makes 96 names.
//!
//! [`CAUSES`] are what a machine may do beyond that; an [`Effect`] is one of them at work, and [`Motion`]
//! is what effects depend on besides position and sense.
//!
//! A [`Term`] is the unit of the model: a name, parameters with units, columns over samples, and the
//! way it bends the exact chain. Extending the model is adding a term.

mod cause;
mod causes;
mod coefficient;
mod effect;
mod functions;
mod harmonics;
mod held;
mod jacobian;
mod key;
mod law;
mod local;
mod local_frame;
mod model_file;
mod motion;
mod seat;
mod sets;
mod shape;
mod term;
mod unit;
mod variable;

pub use cause::{Cause, Runs};
pub use causes::{BALL_PLACE, CAUSES, PIVOT};
pub use coefficient::{Ball, Coefficient, Component, Power, SetUp};
pub use effect::Effect;
pub use functions::ErrorFunctions;
pub use held::{Form, HeldEffect};
pub use jacobian::{Situation, SlideGradient};
pub use key::{AMPLITUDE, DEGREE, Key, MOUNTING, Measure, ORDER, PHASE, RUN};
pub use law::{Inner, Law, Over, Scale, Start};
pub use local::{Local, LocalShape};
pub use local_frame::{LocalFrame, LocalTerm};
pub(crate) use model_file::LARGEST_ERROR;
pub use model_file::ModelFile;
pub use motion::{Averaged, Corner, Motion, Reversal};
pub use seat::{Seat, SeatKind};
pub use sets::{COMPLETE, LOCAL, NAMED_SETS, coefficients, local_terms, terms};
pub use shape::Shape;
pub use term::{Model, Parameter, ParameterId, Term};
pub use unit::Unit;
pub use variable::{Dependence, Empirical, Variable, place};
