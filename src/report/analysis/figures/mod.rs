//! The figures of the report.

mod alignment;
mod ball;
mod figure;
mod hysteresis;
mod polar;
mod residuals;

pub(super) use alignment::{RunPicture, runs};
pub(super) use ball::left_over;
pub(super) use figure::Figure;
pub(super) use hysteresis::hysteresis;
pub(super) use polar::polar;
pub(super) use residuals::{against_angle, against_time, autocorrelation, histogram};
