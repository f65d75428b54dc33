//! From the content of a file to a [`Log`], or to the line that is wrong.

use std::path::Path;

use super::columns::{CHOOSE_COLUMNS, same_name};
use super::encoding::as_text;
use super::reading::Log;
use super::table::Table;
use super::text::Line;
use crate::error::{Error, Place, Result};
use crate::input;
use crate::plan::log_format::{Format, ReadingKind, TimeColumn};

/// Rates outside are slips of the pen, and inside `k / hz` is finite and increases for any `k`.
const RATES_HZ: std::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// Reads a log.
pub fn read(file: &Path, format: &Format) -> Result<Log> {
    read_plain(&input::read(file, "log")?, file, format)
}

/// Reads a log from the content of a file; `file` is only named in messages and in the log.
pub fn read_bytes(bytes: &[u8], file: &Path, format: &Format) -> Result<Log> {
    read_plain(&input::unpacked(bytes, file, "log")?, file, format)
}

fn read_plain(bytes: &[u8], file: &Path, format: &Format) -> Result<Log> {
    check_format(format)?;
    let text = as_text(bytes, file)?;
    let mut lines = (1..).zip(text.lines()).map(|(number, text)| Line { number, text });

    let header = lines.find(|line| !line.is_comment() && !line.is_blank()).ok_or_else(|| {
        Error::input("the log is empty").at(Place::file(file)).hint("was the capture saved?")
    })?;
    let table = Table::new(file, header, format)?;
    let readings = table.rows(lines)?;

    let unusable =
        |what: String, hint: String| Err(Error::input(what).at(Place::file(file)).hint(hint));
    if readings.len() < 2 {
        return unusable(
            match readings.len() {
                0 => "the log has a header but no samples".to_owned(),
                _ => "the log is too short: it has one sample".to_owned(),
            },
            "a log needs two samples or more: was the capture started, and saved whole?".to_owned(),
        );
    }
    if readings.iter().all(|r| r.deviation_mm.is_none()) {
        return unusable(
            format!("the bar is out of range in all {} samples", readings.len()),
            format!(
                "was the bar engaged? if the readings are in another column than `{}`, name it in \
                 the test file: `reading_column`",
                format.reading.name
            ),
        );
    }
    Ok(Log::new(file, readings))
}

/// The part of a format that no file can repair.
fn check_format(format: &Format) -> Result<()> {
    match &format.time {
        TimeColumn::Rate { hz } if !RATES_HZ.contains(hz) => {
            return Err(Error::input(format!("a log cannot have a rate of {hz} Hz"))
                .hint("`sample_rate_hz` is the number of samples in a second"));
        }
        TimeColumn::Named { name, .. } if same_name(name, &format.reading.name) => {
            return Err(Error::input(format!(
                "column `{}` cannot be both the time and the reading",
                name.trim()
            ))
            .hint(CHOOSE_COLUMNS));
        }
        _ => {}
    }
    match format.reading.kind {
        ReadingKind::Length { nominal_mm } if !(nominal_mm.is_finite() && nominal_mm > 0.0) => {
            Err(Error::input(format!("a bar cannot be {nominal_mm} mm long"))
                .hint("readings of kind \"length\" need the nominal length of the bar"))
        }
        _ => Ok(()),
    }
}
