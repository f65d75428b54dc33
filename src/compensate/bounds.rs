//! What numbers of an error model may be.

use crate::solve::Matrix;

/// Something that may be, or why it may not.
pub(super) type Checked<T> = std::result::Result<T, String>;

/// A number between the negative and the positive of the largest.
pub(super) fn finite(value: f64, largest: f64, what: &str) -> Checked<f64> {
    if value.abs() <= largest {
        return Ok(value);
    }
    Err(format!("`{what}` is {value}; it goes from -{largest} to {largest}"))
}

/// A number from 0.
pub(super) fn least(value: f64, largest: f64, what: &str) -> Checked<f64> {
    if (0.0..=largest).contains(&value) {
        return Ok(value);
    }
    Err(format!("`{what}` is {value}; it goes from 0 to {largest}"))
}

/// No variance of a parameter is larger, mm² and rad².
const LARGEST_VARIANCE: f64 = 1e6;
/// So much larger than 1 a correlation may be by rounding.
const ROUNDING: f64 = 1e-6;

/// A covariance by its lower triangle, row after row.
pub(super) fn covariance(lower: &[f64], count: usize, what: &str) -> Checked<Matrix> {
    if lower.len() != count * (count + 1) / 2 {
        return Err(format!("`{what}` is no lower triangle of {count} parameters"));
    }
    let at = |i: usize, k: usize| {
        let (row, column) = if i >= k { (i, k) } else { (k, i) };
        lower[row * (row + 1) / 2 + column]
    };
    for i in 0..count {
        let variance = least(at(i, i), LARGEST_VARIANCE, what)?;
        for k in 0..i {
            let most = (variance * at(k, k)).sqrt() * (1.0 + ROUNDING);
            if at(i, k).is_nan() || at(i, k).abs() > most {
                return Err(format!("`{what}` has a correlation beyond 1"));
            }
        }
    }
    Ok(Matrix::from_fn(count, count, at))
}
