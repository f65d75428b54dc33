//! Identification: from aligned samples to coefficients, their uncertainty, and what nobody can see.
//!
//! **Estimation** (paper, Eq. 7): Gauss-Newton on the exact chain. With `rho_i` the deviation that the
//! chain predicts for sample `i`, the step `d` minimises
//!
//! `sum_i (w_i / sigma²) (y_i - rho_i - J_i d)² + sum_m (mark residual / its sigma)² + (rate / its tolerance)²`
//!
//! over the coefficients and, at the same time, over the time map: one offset for every leg and the
//! clock rate. The first sum has a column `d rho / d t` for them, the second are the engagements and
//! releases, the third is what the instrument's maker says of its clock.
//!
//! **Uncertainty.** The samples of an arc are correlated. An autoregressive model of the residuals
//! gives their covariance `S`; what noise that lasts does to short arcs the fit takes out of them, and likely
//! noises give that, `B`. The covariance of the estimate is `(J'WJ)^+ (J'W S W J + B) (J'WJ)^+`. It counts noise,
//! correlated noise and the uncertainty of the time map. It does not count what the model gets wrong.
//!
//! **Rank.** A direction in coefficient space counts as observed when its effect over the measured
//! sphere stands out of the noise, see [`SEEN_UM`].

mod across;
mod asked;
mod campaign;
mod cautions;
mod coarse;
mod columns;
mod complete;
mod effects;
mod elsewhere;
mod exchanged;
mod facets;
mod fit;
mod follows;
mod foresight;
mod input;
mod leg_path;
mod leg_readings;
mod linearised;
mod lines;
mod measured;
mod observability;
mod otherwise;
mod place;
mod placed;
mod prediction;
mod preference;
mod problem;
mod record;
mod remedies;
mod repeats;
mod residuals;
mod result;
mod rows;
mod said;
mod sandwich;
mod seen_errors;
mod selection;
mod settle;
mod slip;
mod state;
mod timing;
mod turning;
mod uncertainty;
mod unexplained;
mod words;

pub use asked::{Answer, Asked, Known, OPEN, SEEN, Suspect, answers, ask, bent};
pub use campaign::{Campaign, Failure};
pub use complete::{count, explicit_terms, order_of};
pub use fit::identify;
pub use foresight::foresee;
pub use input::{Options, RunInput};
pub use linearised::{LinearSample, Linearised};
pub use lines::displaced_mm;
pub use measured::MeasuredRun;
pub use observability::{Gather, POINTS, POSES, Seen, Sight, TOLERANCE, ideal_poses};
pub use place::terms;
pub use prediction::{Prediction, predict, predict_with_prior, rehearse, stated_noise};
pub use preference::preference;
pub use problem::{About, Problem, Unknown};
pub use record::{Apart, Record};
pub use remedies::{Driven, remedies};
pub use repeats::{CHANGED, Repeat, deviation, of_one_test, repeats};
pub use residuals::{ArcResiduals, arcs, rms_mm};
pub use result::{Estimate, Identification, IdentifiedRun, LittleExplained};
pub use rows::SEEN_UM;
pub use seen_errors::SeenErrors;
pub use selection::{Removal, Selection};
pub use state::IMPLAUSIBLE;
pub use words::sentence;
