//! Linear least squares over any number of rows: what the data see, what they cannot, and how surely.
//!
//! This room knows rows, columns and their indices. It knows nothing of machines, and it is the only one
//! that knows the linear algebra library.
//!
//! # The problem
//!
//! Rows `J` (`m x n`, `m` large, `n` up to a few hundred), a right-hand side `e` and the unknown `x`:
//!
//! ```text
//! e = J x + noise,     minimise |W^(1/2) (J x - e)|
//! ```
//!
//! | step | in | out |
//! | --- | --- | --- |
//! | [`Tsqr`] | rows, weighed by the caller | [`Triangle`]: `R^T R = J^T J`, in constant memory |
//! | [`Spectrum`] | the triangle | singular values of the *scaled* columns, rank, null space |
//! | [`Triangle::choose`] | the triangle, an order of the columns | [`Choice`]: which columns to keep |
//! | [`solve()`] | triangle, [`Truncation`] | [`Solution`]: `x`, residual, covariance, observed fractions |
//! | [`Bordered`] | triangles of blocks that share some unknowns and have others of their own | the same, linear in the blocks |
//! | [`Loss`], [`robust_scale`] | residuals | weights of the next step |
//! | [`Basis`] | a further column | what the fit leaves of it |
//! | [`minimax()`] | few columns, values | the fit whose largest residual is the smallest |
//! | [`NoiseModel`], [`BackwardFilter`] | residuals of contiguous segments | rows `L^T J`, for [`Solution::covariance_sandwich`] |
//!
//! A nonlinear model takes Gauss-Newton steps: push the Jacobian and the residuals at the present
//! coefficients, solve, add `x`, repeat.
//!
//! # Uncertainty
//!
//! With `A = J D^-1` the columns scaled to unit length and `A = U S V^T`,
//!
//! ```text
//! x          = D^-1 V_r S_r^-1 U_r^T e
//! G          = D^-1 V_r S_r^-2 V_r^T D^-1                = (J^T J)^+
//! covariance = sigma^2 G                                 rows independent, all of standard deviation sigma
//! covariance = G (J^T Sigma J) G                         rows with the covariance Sigma
//! ```
//!
//! These hold under assumptions that no formula can check for the caller:
//!
//! - the model is right: what it cannot express is noise with mean zero;
//! - the columns are exact; only the right-hand side is noisy;
//! - near the solution the model is linear over the size of the uncertainty;
//! - for the first form, the rows are independent. Samples along one arc never are, so the second is
//!   the rule here, with a [`NoiseModel`] of the residuals;
//! - robust weights are treated as if they had been known beforehand.
//!
//! # Rank deficiency and gauge freedom
//!
//! Dependent columns are the normal case, not an accident: a displacement of the machine and the same
//! displacement of the workpiece cannot be told apart by a length between them. Moving `x` along the
//! null space of `J` changes no residual, as a gauge changes no observation. The solution fixes it by
//! keeping `r` directions and having no part along the others: `|D x|` is minimal. That choice depends
//! on the scaling `D`, and so on which rows were measured; another choice fits as well.
//!
//! What does not depend on it: residuals; predictions `c . x` for any `c` in the row space of `J`, and
//! their variance `c^T G c`; and coefficients with [`Solution::observed_fraction`] 1. A coefficient with
//! a smaller fraction has a value and a variance in this gauge only. Its variance is *small*, 0 at the
//! fraction 0, because the solution never moves it; it says nothing about the truth. The honest things
//! to report are its fraction and the [`NullDirection`]s that it is part of.
//!
//! Which directions to keep is the caller's [`Truncation`]. On exact dependences the singular values
//! drop to a few `1e-16` of the largest and any tolerance between finds the rank; where only small
//! effects tell columns apart there is no gap, and the noise has to decide ([`Truncation::Effect`]).
//!
//! A prior on a coefficient is one more row ([`Tsqr::push_prior`]); none is ever added unasked.
//!
//! # Numerics
//!
//! `J^T J` is never formed. With forty columns that share all but 1e-7 of their variance, the
//! coefficients are right to 3e-12 this way and to 6e-6 by the normal equations. All sums run in a fixed order on
//! one thread: the same rows give the same bits on every run of one machine. Numbers that are not finite
//! are refused where they come in.

mod backward_filter;
mod basis;
mod bordered;
mod bordered_solution;
mod choice;
mod cholesky;
mod coloured;
mod fold;
mod least_squares;
mod matrix;
mod minimax;
mod noise;
mod null_space;
mod robust;
mod spectrum;
mod svd;
mod triangle;
mod tsqr;
mod vector;
mod whiten;
mod widest;

pub use backward_filter::BackwardFilter;
pub use basis::Basis;
pub use bordered::Bordered;
pub use bordered_solution::{BorderedCovariance, BorderedSolution, Unknowns};
pub use choice::Choice;
pub use cholesky::{Cholesky, low_rank_factor};
pub use coloured::{ArcOfMeans, Colour, Likely, Means, likely};
pub use least_squares::{Solution, correlation, solve, standard_deviations};
pub use matrix::Matrix;
pub use minimax::{Minimax, MinimaxRows, minimax};
pub use noise::{Autocovariances, NoiseModel};
pub use null_space::NullDirection;
pub use robust::{HUBER, Loss, NORMAL_PER_MEDIAN, TUKEY, robust_scale};
pub use spectrum::{Spectrum, Truncation, VANISHED};
pub use triangle::Triangle;
pub use tsqr::Tsqr;
pub use vector::{dot, median};
pub use widest::add_rows;
