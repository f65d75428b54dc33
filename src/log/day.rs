//! The day on which a log was taken, where the file says it so that it can be read in one way only.

use jiff::ToSpan as _;
use jiff::civil::{Date, date};

/// Bars that log are younger.
const EARLIEST: Date = date(1980, 1, 1);
/// Day 0 of Excel; it counts a 29 February 1900 that never was, which matters to no log.
const DAY_ZERO_OF_EXCEL: Date = date(1899, 12, 30);
/// Excel knows no later day.
const LAST_OF_EXCEL: i32 = 2_958_465;

/// A day as clocks of loggers, Excel and Ballbar 20 write it: `2026-11-23`, `2026/11/23`, `23.11.2026`, `20261123`, `46349`.
///
/// `11/23/2026` is passed over: what would be the 11th of another month elsewhere is no day to file results under.
pub(super) fn parse(written: &str) -> Option<Date> {
    let written = written.trim().trim_end_matches(['T', 't', ',']);
    let parts: Vec<&str> = written.split(['-', '/', '.']).collect();
    let day = match parts[..] {
        [year, month, day] if year.len() == 4 => of(year, month, day)?,
        [day, month, year] if year.len() == 4 && written.matches('.').count() == 2 => {
            of(year, month, day)?
        }
        [digits] if digits.is_ascii() && digits.len() == 8 => {
            of(&digits[..4], &digits[4..6], &digits[6..])?
        }
        [serial] if serial.len() == 5 => {
            let days =
                serial.parse::<i32>().ok().filter(|days| (0..LAST_OF_EXCEL).contains(days))?;
            DAY_ZERO_OF_EXCEL.checked_add(days.days()).ok()?
        }
        _ => return None,
    };
    (day >= EARLIEST).then_some(day)
}

fn of(year: &str, month: &str, day: &str) -> Option<Date> {
    Date::new(year.parse().ok()?, month.parse().ok()?, day.parse().ok()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_that_can_be_read_in_one_way_is_one() {
        for written in [
            "2026-11-23",
            "2026/11/23",
            "23.11.2026",
            "20261123",
            "46349",
            "2026-11-23T",
            "23.11.2026,",
        ] {
            assert_eq!(parse(written), Some(date(2026, 11, 23)), "{written}");
        }
        for written in [
            "",
            "11/23/2026",
            "23.11.26",
            "2026-13-01",
            "1.3.",
            "00001",
            "é-ü-ö",
            "2026112é",
            "0000-00-00",
        ] {
            assert_eq!(parse(written), None, "{written}");
        }
    }
}
