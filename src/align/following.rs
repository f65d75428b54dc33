//! Slides that follow the program with a lag of the first order.
//!
//! `T dx/dt = c - x` with the commanded `c` has the solution `x(t) = ∫ c(t - T s) exp(-s) ds`, a mean over what was
//! commanded before. Its mean delay is `T`, which an offset of the time takes in; what is left is
//!
//! `x(t + T) = ∫ c(t + T (1 - s)) exp(-s) ds`,
//!
//! the path with its corners rounded, and on a circle of radius R at the speed v a radius smaller by `(v T)² / 2 R`.

use nalgebra::Vector3;

use crate::motion::Trajectory;

/// Abscissas and weights of Gauss and Laguerre for six points (Abramowitz and Stegun, Table 25.9): exact for
/// polynomials of degree 11, and near enough for the roof of a chord that takes longer than `T`.
const POINTS: [(f64, f64); 6] = [
    (0.222_846_604_179, 0.458_964_673_950),
    (1.188_932_101_673, 0.417_000_830_772),
    (2.992_736_326_059, 0.113_373_382_074),
    (5.775_143_569_105, 0.010_399_197_453),
    (9.837_467_418_383, 0.000_261_017_203),
    (15.982_873_980_602, 0.000_000_898_548),
];
/// A lag that moves no corner by more than rounding of the program, s.
const NONE_S: f64 = 1e-5;

/// Where slides are that follow with a time constant, mm; its delay is not counted. The time is near that of a block, by
/// its index.
pub(super) fn at(
    trajectory: &Trajectory,
    program_s: f64,
    near: usize,
    following_s: f64,
) -> Vector3<f64> {
    if following_s < NONE_S {
        return trajectory.position_near_mm(program_s, near);
    }
    // The last points weigh less than a part in a thousand.
    POINTS[..5].iter().fold(Vector3::zeros(), |sum, (s, weight)| {
        let then_s = program_s + following_s * (1.0 - s);
        sum + *weight / WEIGHTS * trajectory.position_near_mm(then_s, near)
    })
}

/// Sum of the weights that are used.
const WEIGHTS: f64 = 0.999_999_101_452;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_delay_is_one_and_a_parabola_is_bent_by_its_second_moment() {
        let mean = |f: &dyn Fn(f64) -> f64| {
            POINTS[..5].iter().map(|(s, weight)| weight / WEIGHTS * f(*s)).sum::<f64>()
        };
        assert!((mean(&|_| 1.0) - 1.0).abs() < 1e-9);
        assert!((mean(&|s| s) - 1.0).abs() < 2e-5);
        // c = t²: x(t + T) = t² + T².
        assert!((mean(&|s| (1.0 - s).powi(2)) - 1.0).abs() < 3e-4);
    }
}
