//! Times of day: what a logger writes that does not count seconds.
//!
//! Only differences matter here, so a date is not read: it only tells that midnight has passed. That spares every format of a
//! date that there is, and the question which of them `02.03.26` has. That of the first line is kept for who files the results.

use super::number::Fault;

/// The times of a log while they are times of day.
#[derive(Debug, Default)]
pub(super) struct Clock {
    /// What stood before the first time.
    first_date: String,
    last: Option<Last>,
    /// Whole days, or hours of a clock that shows none, since the first line, s.
    passed_s: f64,
}

#[derive(Debug)]
struct Last {
    date: String,
    time_s: f64,
}

/// A time of day as it is written.
#[derive(Debug, PartialEq)]
struct Written<'a> {
    /// What stands before it.
    date: &'a str,
    /// Since the clock began to count, s.
    time_s: f64,
    /// When it begins anew, s.
    turn_s: f64,
}

const DAY_S: f64 = 86_400.0;
const HOUR_S: f64 = 3600.0;
/// No capture runs for longer, hours; `36:00:00` is a duration of Excel.
const MOST_HOURS: f64 = 10_000.0;

const WRITE: &str =
    "a time of day is written as hh:mm:ss.fff, with or without a date before it, or as mm:ss.f";

impl Clock {
    /// Whether a field is a time of day, and not a number.
    pub(super) fn is_one(written: &str) -> bool {
        written.contains(':')
    }

    /// What stood before the first time: a date, if there is one.
    pub(super) fn first_date(&self) -> &str {
        &self.first_date
    }

    /// Seconds since the midnight before the first line.
    pub(super) fn parse(&mut self, written: &str) -> Result<f64, Fault> {
        let Written { date, time_s, turn_s } = read(written).ok_or_else(|| {
            Fault::new(format!("{} is not a time of day", super::text::quote(written))).hint(WRITE)
        })?;
        if let Some(last) = &self.last {
            let back_s = last.time_s - time_s;
            let new_date = last.date != date;
            // Without a date, a clock that goes back by more than half of its turn has gone on over its end.
            let passes =
                if date.is_empty() { back_s > 0.5 * turn_s } else { new_date && back_s > 0.0 };
            if new_date && !passes {
                return Err(Fault::new(format!(
                    "{} has another date than the line before, and its clock has not passed midnight",
                    super::text::quote(written)
                ))
                .hint("is a part of the log missing, or were two joined?"));
            }
            if passes {
                self.passed_s += turn_s;
            }
        }
        match &mut self.last {
            Some(last) if last.date == date => last.time_s = time_s,
            last => {
                if last.is_none() {
                    date.clone_into(&mut self.first_date);
                }
                *last = Some(Last { date: date.to_owned(), time_s });
            }
        }
        Ok(self.passed_s + time_s)
    }
}

/// `23.11.2026 08:00:00,123`, `2026-11-23T08:00:00.123+01:00`, `8:00:00.1 PM`, `00:12.3`.
fn read(written: &str) -> Option<Written<'_>> {
    let colon = written.find(':')?;
    let start = written[..colon]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + written[at..].chars().next().map_or(1, char::len_utf8));
    let date = written[..start].trim();
    let date = date.strip_suffix(['T', 't']).unwrap_or(date).trim();
    let (time, afternoon) = half_of_day(written[start..].trim());
    // A zone is the same in every line.
    let time = time.strip_suffix(['Z', 'z']).unwrap_or(time);
    let time = time.split(['+', '-', '\u{2212}']).next()?.trim();
    let parts: Vec<&str> = time.split(':').collect();
    let whole = |text: &str| {
        let digits = !text.is_empty() && text.len() < 6 && text.bytes().all(|b| b.is_ascii_digit());
        digits.then(|| text.parse::<f64>().ok()).flatten()
    };
    let sixty = |text: &str| whole(text).filter(|value| *value < 60.0);
    let (hours, minutes_s, seconds) = match parts.as_slice() {
        // Without decimals it could as well be hours and minutes.
        [minutes, seconds] if seconds.contains(['.', ',']) => {
            let time_s = 60.0 * sixty(minutes)? + seconds_s(seconds)?;
            return Some(Written { date, time_s, turn_s: HOUR_S });
        }
        [hours, minutes, seconds] => (whole(hours)?, 60.0 * sixty(minutes)?, seconds_s(seconds)?),
        [hours, minutes, seconds, milliseconds] if milliseconds.len() == 3 => {
            let time_s = sixty(seconds)? + whole(milliseconds)? / 1e3;
            (whole(hours)?, 60.0 * sixty(minutes)?, time_s)
        }
        _ => return None,
    };
    let hours = match afternoon {
        None => hours,
        Some(_) if !(1.0..=12.0).contains(&hours) => return None,
        Some(afternoon) => hours % 12.0 + if afternoon { 12.0 } else { 0.0 },
    };
    let most = if date.is_empty() { MOST_HOURS } else { 23.0 };
    (hours <= most).then_some(Written {
        date,
        time_s: HOUR_S * hours + minutes_s + seconds,
        turn_s: DAY_S,
    })
}

/// A time without its `AM` or `PM`, and whether it was `PM`.
fn half_of_day(time: &str) -> (&str, Option<bool>) {
    for (suffix, afternoon) in [("am", false), ("pm", true), ("a.m.", false), ("p.m.", true)] {
        let at = time.len().saturating_sub(suffix.len());
        if time.get(at..).is_some_and(|end| end.eq_ignore_ascii_case(suffix)) {
            return (time[..at].trim(), Some(afternoon));
        }
    }
    (time, None)
}

/// Seconds with decimals, below 60 (61 where a leap second is written).
fn seconds_s(written: &str) -> Option<f64> {
    let (whole, decimals) = written.split_once(['.', ',']).unwrap_or((written, "0"));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    if whole.len() > 2 || decimals.len() > 12 || !digits(whole) || !digits(decimals) {
        return None;
    }
    format!("{whole}.{decimals}").parse().ok().filter(|seconds: &f64| *seconds < 61.0)
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // what is read is exact or wrong
mod tests {
    use super::*;

    fn times(lines: &[&str]) -> Vec<f64> {
        let mut clock = Clock::default();
        lines
            .iter()
            .map(|line| clock.parse(line).unwrap_or_else(|f| panic!("{line}: {}", f.what)))
            .collect()
    }

    #[test]
    fn every_way_to_write_a_time_of_day() {
        for (written, date, time_s) in [
            ("08:00:00.25", "", 28_800.25),
            ("8:00:01", "", 28_801.0),
            ("08:00:00,5", "", 28_800.5),
            ("08:00:00:125", "", 28_800.125),
            ("2026-11-23T08:00:00.5Z", "2026-11-23", 28_800.5),
            ("2026-11-23 08:00:00.5+01:00", "2026-11-23", 28_800.5),
            ("23.11.2026 08:00:00,5", "23.11.2026", 28_800.5),
            ("11/23/2026 8:00:00.5 PM", "11/23/2026", 72_000.5),
            ("12:00:00.5 AM", "", 0.5),
            ("12:00:00.5 pm", "", 43_200.5),
            ("01:02.5", "", 62.5),
            ("36:00:00", "", 129_600.0),
        ] {
            let read = read(written).unwrap_or_else(|| panic!("{written}"));
            assert_eq!((read.date, read.time_s), (date, time_s), "{written}");
        }
        for written in
            ["08:00", "25:00:00 PM", "1:60:00", "1:00:61.5", "::", "1:2:3:4", "µ1:2", "1:00:0x"]
        {
            assert!(read(written).is_none(), "{written}");
        }
    }

    #[test]
    fn midnight_passes_once() {
        assert_eq!(
            times(&["23:59:59.5", "00:00:00.5", "00:00:01"]),
            [86_399.5, 86_400.5, 86_401.0]
        );
        assert_eq!(times(&["1.3. 23:59:59", "2.3. 00:00:01"]), [86_399.0, 86_401.0]);
        // As Excel shows tenths: the hours are gone.
        assert_eq!(times(&["59:59.9", "00:00.1"]), [3599.9, 3600.1]);
        let mut clock = Clock::default();
        assert!(clock.parse("1.3. 08:00:00").is_ok());
        assert!(clock.parse("2.3. 08:00:01").is_err_and(|fault| fault.what.contains("midnight")));
    }
}
