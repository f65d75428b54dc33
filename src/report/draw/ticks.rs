//! Round numbers for axes, rings and magnifications: the series 1, 2, 5.

/// The smallest number of the series `.., 1, 2, 5, 10, 20, ..` that is not below a positive number.
pub(in crate::report) fn round_up(value: f64) -> f64 {
    let decade = 10.0_f64.powf(value.log10().floor());
    // A hair of tolerance: 5.0000000001 is a five that was computed.
    [1.0, 2.0, 5.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|n| *n >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// The largest number of the series that is not above a positive number.
pub(in crate::report) fn round_down(value: f64) -> f64 {
    let decade = 10.0_f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|n| *n <= value * (1.0 + 1e-9))
        .unwrap_or(decade)
}

/// Ticks of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Ticks {
    /// Where they are, ascending.
    pub(in crate::report) values: Vec<f64>,
    /// Decimals that tell them apart.
    pub(in crate::report) decimals: usize,
}

/// At most about `most` ticks between two numbers.
pub(in crate::report) fn ticks(low: f64, high: f64, most: usize) -> Ticks {
    let span = high - low;
    if span.is_nan() || span <= 0.0 || !span.is_finite() {
        return Ticks { values: Vec::new(), decimals: 0 };
    }
    let step = round_up(span / most.max(1) as f64);
    let first = (low / step - 1e-6).ceil() as i64;
    let last = (high / step + 1e-6).floor() as i64;
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    Ticks { values: (first..=last).map(|k| k as f64 * step).collect(), decimals }
}

/// A range about zero that holds all values and ends on a round number; never empty.
pub(in crate::report) fn symmetric(values: impl Iterator<Item = f64>) -> f64 {
    let largest = values.filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()));
    let step = round_up((largest / 4.0).max(1e-6));
    (largest / step).ceil().max(1.0) * step
}

/// A range that holds all values and ends on ticks.
pub(in crate::report) fn enclosing(values: impl Iterator<Item = f64>, most: usize) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let span = (high - low).max(1e-9 * high.abs()).max(1e-9);
    let step = round_up(span / most.max(1) as f64);
    ((low / step).floor() * step, (high / step).ceil() * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn the_series_is_one_two_five() {
        let pairs =
            [(1.0, 1.0), (1.1, 2.0), (3.0, 5.0), (7.0, 10.0), (0.012, 0.02), (2000.0, 2000.0)];
        for (value, up) in pairs {
            assert!((round_up(value) / up - 1.0).abs() < 1e-9, "{value}");
        }
        for (value, down) in [(1.0, 1.0), (1.9, 1.0), (4.9, 2.0), (9999.0, 5000.0), (0.3, 0.2)] {
            assert!((round_down(value) / down - 1.0).abs() < 1e-9, "{value}");
        }
    }

    #[test]
    fn ticks_stay_inside_and_are_told_apart() {
        let axis = ticks(-0.31, 0.52, 6);
        assert!(close(&axis.values, &[-0.2, 0.0, 0.2, 0.4]), "{axis:?}");
        assert_eq!(axis.decimals, 1);
        let axis = ticks(0.0, 900.0, 10);
        assert!(close(
            &axis.values,
            &[0.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0]
        ));
        assert_eq!(axis.decimals, 0);
        assert!(ticks(1.0, 1.0, 5).values.is_empty());
        assert!(ticks(f64::NAN, 1.0, 5).values.is_empty());
    }

    #[test]
    fn ranges_hold_their_values() {
        for largest in [0.13, 0.9, 17.0, 0.0] {
            assert!(symmetric([largest, -0.5 * largest].into_iter()) >= largest);
        }
        assert_eq!(enclosing([0.3, 4.2].into_iter(), 5), (0.0, 5.0));
        assert_eq!(enclosing(std::iter::empty(), 5), (0.0, 1.0));
    }
}
