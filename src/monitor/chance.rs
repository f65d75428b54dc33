//! How far chance goes.

use super::thresholds::BY_CHANCE;

/// Standard deviations that one of so many independent normal numbers exceeds in [`BY_CHANCE`] of all cases.
///
/// `P(|z| > t) < sqrt(2 / pi) exp(-t² / 2) / t` (Mills), solved for `t`: on the safe side by less than 0.04.
pub(super) fn exceeded_by_chance(count: usize) -> f64 {
    let each = BY_CHANCE / count.max(1) as f64;
    let mut t: f64 = 3.0;
    for _ in 0..20 {
        t = (2.0 * ((2.0 / std::f64::consts::PI).sqrt() / (each * t)).ln()).max(1.0).sqrt();
    }
    t
}

/// The same of numbers whose standard deviation was estimated with so many degrees of freedom.
///
/// D. L. Wallace, Bounds on normal approximations to Student's and the chi-square distributions, Ann. Math. Statist. 30
/// (1959): `z = (8 v + 1) / (8 v + 3) sqrt(v ln(1 + t² / v))`; on the safe side, by 4 % at 3 degrees of freedom.
pub(super) fn of_student(normal: f64, freedom: usize) -> f64 {
    let v = freedom.max(1) as f64;
    let z = normal * (8.0 * v + 3.0) / (8.0 * v + 1.0);
    (v * ((z * z / v).exp() - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles from tables.
    #[test]
    fn quantiles_of_tables() {
        for (count, t) in [(1, 2.5758), (10, 3.2905), (100, 3.8906)] {
            let own = exceeded_by_chance(count);
            assert!((0.0..0.05).contains(&(own - t)), "{count}: {own}");
        }
        // Two-sided 1 % of Student's distribution.
        for (freedom, t) in [(3, 5.841), (5, 4.032), (10, 3.169), (30, 2.750)] {
            let own = of_student(2.5758, freedom);
            assert!((0.0..0.04).contains(&(own / t - 1.0)), "{freedom}: {own}");
        }
    }
}
