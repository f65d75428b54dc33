//! Numbers of a log, as programs and people write them.

use super::text::quote;
use crate::plan::log_format::{DecimalMark, Delimiter, Format};

/// Why a field is not a number.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) what: String,
    /// What to do about it, when that does not depend on the column.
    pub(super) hint: Option<&'static str>,
}

impl Fault {
    pub(super) fn new(what: String) -> Self {
        Self { what, hint: None }
    }

    pub(super) fn hint(self, hint: &'static str) -> Self {
        Self { hint: Some(hint), ..self }
    }
}

/// Reads the numbers of one log.
pub(super) struct Numbers {
    /// Whether a comma also separates fields: then only a quoted number can have one.
    comma_separates: bool,
    /// The decimal mark that the test file states, then that of the numbers so far. One log has one: where some numbers
    /// have a point, `1,234` is more likely to be a thousand than one and a bit.
    mark: Option<char>,
    plain: String,
}

impl Numbers {
    pub(super) fn new(delimiter: Delimiter, format: &Format) -> Self {
        Self {
            comma_separates: delimiter == Delimiter::Comma,
            mark: format.decimal_mark.map(DecimalMark::char),
            plain: String::new(),
        }
    }

    /// The number that is written, in the unit that `convert` gives it; always finite.
    pub(super) fn parse(
        &mut self,
        written: &str,
        convert: impl Fn(f64) -> f64,
    ) -> Result<f64, Fault> {
        if let Some(mark) = written.chars().find(|c| matches!(c, '.' | ',')) {
            if self.mark.is_none() && self.comma_separates && is_thousands(written) {
                return Err(Fault::new(format!(
                    "{} is a thousand and more, or has a decimal comma: the log does not tell",
                    quote(written)
                ))
                .hint("write `decimal_mark = \",\"` under `[log]` in the test file if the comma is the decimal mark, else export the log without separators of thousands"));
            }
            if *self.mark.get_or_insert(mark) != mark {
                return Err(Fault::new(format!(
                    "{} has another decimal mark than the numbers above",
                    quote(written)
                ))
                .hint("write every number with the same decimal mark and without separators of thousands; `decimal_mark` under `[log]` in the test file says which it is"));
            }
        }
        let mut plain = written;
        if !written.is_ascii() || self.mark == Some(',') {
            self.plain.clear();
            // `1,234.5` would become `1.234.5`, which is no number either.
            self.plain.extend(written.chars().map(|c| match c {
                ',' => '.',
                '\u{2212}' | '\u{2013}' => '-',
                other => other,
            }));
            plain = &self.plain;
        }
        let number = plain.parse::<f64>();
        let value =
            number.map_err(|_| Fault::new(format!("{} is not a number", quote(written))))?;
        let value = convert(value);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(Fault::new(format!("{} is not a finite number", quote(written))))
        }
    }
}

/// Whether a number with a comma may be thousands: no thousands begin with 0.
fn is_thousands(written: &str) -> bool {
    let digits = written.trim_start_matches(['+', '-', '\u{2212}', '\u{2013}']);
    digits.split_once(',').is_some_and(|(whole, rest)| {
        (1..=3).contains(&whole.len()) && !whole.starts_with('0') && rest.len() == 3
    })
}

/// Words that no reader takes for a number and that say that there is no reading.
const NO_READING: [&str; 26] = [
    "nan",
    "-nan",
    "+nan",
    "-nan(ind)",
    "nan(ind)",
    "inf",
    "-inf",
    "+inf",
    "infinity",
    "-infinity",
    "over",
    "overrange",
    "over range",
    "overflow",
    "under",
    "underrange",
    "under range",
    "underflow",
    "out of range",
    "outofrange",
    "ol",
    "n/a",
    "#n/a",
    "na",
    "null",
    "none",
];

/// Whether a field says that the bar is out of range: a word for it, dashes or stars.
pub(super) fn is_no_reading(written: &str) -> bool {
    let lower = written.to_lowercase();
    // As old C libraries print them: `1.#QNAN`, `-1.#IND`.
    let printed = lower.trim_start_matches('-').starts_with("1.#");
    let mut marks = written.chars();
    let first = marks.next().unwrap_or(' ');
    let dashes = "-\u{2212}\u{2013}\u{2014}*?<>_".contains(first) && marks.all(|c| c == first);
    printed || dashes || NO_READING.contains(&lower.as_str())
}

/// Whether a number is nothing but nines, four or more: what an instrument shows that has nothing to show.
pub(super) fn is_nines(written: &str) -> bool {
    let digits = || written.chars().filter(|c| !matches!(c, '+' | '-' | '\u{2212}' | '.' | ','));
    digits().count() >= 4 && digits().all(|c| c == '9')
}
