//! Losses that keep a few wild residuals from deciding the fit.
//!
//! An M-estimate minimises `sum rho(u)`, `u = r / sigma`, by least squares with the weights
//! `w(u) = rho'(u) / u`, taken from the residuals of the step before.
//!
//! | loss | `rho(u)` | `w(u)` | for large `u` |
//! | --- | --- | --- | --- |
//! | off | `u^2 / 2` | 1 | counts fully |
//! | Huber, `|u| <= k` | `u^2 / 2` | 1 | |
//! | Huber, beyond | `k |u| - k^2 / 2` | `k / |u|` | counts, bounded |
//! | Tukey, `|u| <= c` | `c^2/6 (1 - (1 - u^2/c^2)^3)` | `(1 - u^2/c^2)^2` | |
//! | Tukey, beyond | `c^2 / 6` | 0 | does not count |
//!
//! With `k` = 1.345 and `c` = 4.685 the estimate of a mean keeps 95 % of its efficiency on clean normal
//! data: Holland and Welsch, *Robust regression using iteratively reweighted least-squares*,
//! Communications in Statistics A6 (1977) 813-827.
//!
//! Huber's loss is convex: the minimum is the same from every start. Tukey's is not: start it from a
//! Huber fit, else it may settle on a wrong half of the data.

use serde::{Deserialize, Serialize};

/// Tuning constant of Huber's loss, 95 % efficiency at the normal distribution.
pub const HUBER: f64 = 1.345;

/// Tuning constant of Tukey's biweight, 95 % efficiency at the normal distribution.
pub const TUKEY: f64 = 4.685;

/// Median absolute value of the standard normal distribution, inverted: `1 / 0.67449`.
pub const NORMAL_PER_MEDIAN: f64 = 1.482_602_218_505_602;

/// What a residual costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Loss {
    /// Its square: ordinary least squares.
    #[default]
    Off,
    /// Its square up to 1.345 sigma, its magnitude beyond.
    Huber,
    /// Tukey's biweight: nothing more beyond 4.685 sigma.
    Tukey,
}

impl Loss {
    /// All, by the names that files and the command line use.
    pub const NAMED: [(&str, Self); 3] =
        [("off", Self::Off), ("huber", Self::Huber), ("tukey", Self::Tukey)];

    /// `rho(u)` of a residual in units of its standard deviation.
    pub fn rho(self, u: f64) -> f64 {
        match self {
            Self::Off => u * u / 2.0,
            Self::Huber if u.abs() <= HUBER => u * u / 2.0,
            Self::Huber => HUBER * (u.abs() - HUBER / 2.0),
            Self::Tukey => {
                let inside = (1.0 - (u / TUKEY).powi(2)).max(0.0);
                TUKEY * TUKEY / 6.0 * (1.0 - inside.powi(3))
            }
        }
    }

    /// The derivative `rho'(u)`, the influence of a residual in units of its standard deviation.
    pub fn influence(self, u: f64) -> f64 {
        match self {
            Self::Off => u,
            Self::Huber => u.clamp(-HUBER, HUBER),
            Self::Tukey => u * self.weight(u),
        }
    }

    /// The weight `w(u) = rho'(u) / u`, between 0 and 1, of a residual in units of its standard
    /// deviation.
    ///
    /// A row is multiplied by the square root of it
    /// ([`Tsqr::push_weighted`](super::Tsqr::push_weighted)).
    pub fn weight(self, u: f64) -> f64 {
        match self {
            Self::Off => 1.0,
            Self::Huber if u.abs() <= HUBER => 1.0,
            Self::Huber => HUBER / u.abs(),
            Self::Tukey => (1.0 - (u / TUKEY).powi(2)).max(0.0).powi(2),
        }
    }
}

/// The standard deviation of residuals from their median magnitude, `1.4826 median |r|`, in the unit of
/// the residuals; nothing without residuals. Half of them may be arbitrarily wrong.
///
/// Magnitudes are taken from zero and not from the median of the residuals, because the weights are,
/// too: an offset that the model leaves is misfit, and has to widen the scale. The order of the slice is
/// changed.
pub fn robust_scale(residuals: &mut [f64]) -> Option<f64> {
    for r in residuals.iter_mut() {
        *r = r.abs();
    }
    let half = residuals.len() / 2;
    if residuals.is_empty() {
        return None;
    }
    let (below, &mut upper, _) = residuals.select_nth_unstable_by(half, f64::total_cmp);
    let lower = match below.iter().copied().max_by(f64::total_cmp) {
        Some(lower) if below.len() == half && half * 2 == residuals.len() => lower,
        _ => upper,
    };
    Some(NORMAL_PER_MEDIAN * f64::midpoint(lower, upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Loss; 3] = [Loss::Off, Loss::Huber, Loss::Tukey];

    #[test]
    fn weight_is_the_derivative_of_the_loss_over_the_residual() {
        for loss in ALL {
            for i in -120..120_i32 {
                let u = (f64::from(i) + 0.5) / 20.0;
                let h = 1e-5;
                let slope = (loss.rho(u + h) - loss.rho(u - h)) / (2.0 * h);
                assert!((slope - loss.influence(u)).abs() < 1e-5, "{loss:?} {u}");
                assert!((slope / u - loss.weight(u)).abs() < 1e-4, "{loss:?} {u}");
            }
        }
    }

    /// Efficiency of a mean on normal data: `E[psi']^2 / E[psi^2]`, with `E[psi'] = E[u psi]`.
    #[test]
    fn constants_keep_95_percent_of_the_efficiency() {
        let efficiency = |loss: Loss| {
            let (mut slope, mut square, mut total) = (0.0, 0.0, 0.0);
            for i in -100_000..=100_000_i32 {
                let u = f64::from(i) * 1e-4;
                let density = (-u * u / 2.0).exp();
                slope += density * u * loss.influence(u);
                square += density * loss.influence(u).powi(2);
                total += density;
            }
            slope * slope / square / total
        };
        assert!((efficiency(Loss::Off) - 1.0).abs() < 1e-9);
        assert!((efficiency(Loss::Huber) - 0.95).abs() < 1e-3);
        assert!((efficiency(Loss::Tukey) - 0.95).abs() < 1e-3);
    }

    #[test]
    fn losses_are_even_and_ordered() {
        for loss in ALL {
            assert!(loss.rho(0.0).abs() < 1e-15 && (loss.weight(0.0) - 1.0).abs() < 1e-15);
            assert!((loss.rho(3.0) - loss.rho(-3.0)).abs() < 1e-15);
        }
        assert!(Loss::Off.weight(9.0) > Loss::Huber.weight(9.0));
        assert!(Loss::Tukey.weight(9.0) < f64::MIN_POSITIVE);
    }

    #[test]
    fn scale_is_the_median_of_the_magnitudes() {
        assert_eq!(robust_scale(&mut []), None);
        let scale = |values: &mut [f64]| robust_scale(values).unwrap() / NORMAL_PER_MEDIAN;
        assert!((scale(&mut [-2.0]) - 2.0).abs() < 1e-15);
        assert!((scale(&mut [1.0, -3.0, 1e9]) - 3.0).abs() < 1e-15);
        assert!((scale(&mut [1.0, -2.0, 4.0, 1e9]) - 3.0).abs() < 1e-15);
        assert!((scale(&mut [-3.0, -1.0]) - 2.0).abs() < 1e-15);
    }
}
