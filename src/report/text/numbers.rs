//! Numbers as text and as JSON: fixed decimals, never a minus before a zero, never "not a number".

use std::fmt::Write as _;

/// A share that rounds to nothing is told as nothing.
const NOTHING: f64 = 5e-4;

/// A number with fixed decimals; what rounds to zero has no sign.
pub(in crate::report) fn fixed(value: f64, decimals: usize) -> String {
    let mut text = String::new();
    push_fixed(&mut text, value, decimals);
    text
}

/// The same behind a text.
pub(in crate::report) fn push_fixed(text: &mut String, value: f64, decimals: usize) {
    let from = text.len();
    // Writing to a text does not fail.
    let _ = write!(text, "{value:.decimals$}");
    let zero = |bare: &str| bare.chars().all(|c| c == '0' || c == '.');
    if text[from..].strip_prefix('-').is_some_and(zero) {
        text.remove(from);
    }
}

/// A number with fixed decimals and its sign, but a zero without.
pub(in crate::report) fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    let zero = text.chars().all(|c| c == '0' || c == '.');
    if text.starts_with('-') || zero { text } else { format!("+{text}") }
}

/// The same with a minus as wide as a plus, for the report: columns of numbers stay straight.
pub(in crate::report) fn typeset(text: &str) -> String {
    text.replace('-', "−")
}

/// How many decimals show `digits` significant digits of a number.
pub(in crate::report) fn decimals(value: f64, digits: i32) -> usize {
    if value == 0.0 || !value.is_finite() {
        return digits.max(1) as usize - 1;
    }
    (digits - 1 - value.abs().log10().floor() as i32).clamp(0, 9) as usize
}

/// What is finite, with a zero that has no sign.
pub(in crate::report) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value + 0.0)
}

/// A plain count with thin groups of three: 41 860.
pub(in crate::report) fn count(value: usize) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

/// `1 run`, `5 runs`.
pub(in crate::report) fn many(number: usize, one: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{} {one}s", count(number)) }
}

/// A share as percent; what is not quite all is not told as all.
pub(in crate::report) fn percent(share: f64) -> String {
    fixed((1000.0 * share.clamp(-1.0, 1.0)).floor() / 10.0, 1)
}

/// A share as percent, nothing where chance made it negative.
pub(in crate::report) fn share(of: f64) -> String {
    if of < NOTHING { "0 %".into() } else { format!("{} %", fixed(100.0 * of, 1)) }
}

/// A share without the dust of rounding.
pub(in crate::report) fn without_dust(observed: f64) -> f64 {
    finite(observed).map_or(0.0, |share| share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign() {
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(-0.0, 0), "0");
        assert_eq!(fixed(-0.0006, 3), "-0.001");
        assert_eq!(signed(0.0004, 3), "0.000");
        assert_eq!(signed(1.25, 1), "+1.2");
        assert_eq!(finite(-0.0).map(f64::is_sign_negative), Some(false));
        assert_eq!(finite(f64::NAN), None);
    }

    #[test]
    fn significant_digits_are_counted_from_the_first() {
        for (value, places) in [(0.012_345, 4), (-123.45, 0), (1_234_567.0, 0), (0.0, 2), (9.87, 2)]
        {
            assert_eq!(decimals(value, 3), places, "{value}");
        }
    }

    #[test]
    fn counts_are_grouped_from_five_digits_on() {
        assert_eq!(count(8372), "8372");
        assert_eq!(count(41_860), "41\u{a0}860");
        assert_eq!(many(1, "run"), "1 run");
        assert_eq!(many(5, "run"), "5 runs");
    }
}
