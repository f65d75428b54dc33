//! From the content of a file to a [`Log`], or to the line that is wrong.

use std::path::Path;

use super::b5r::{self, BallbarFile};
use super::ballbar_log;
use super::by_angle::{self, ByAngle};
use super::columns::{CHOOSE_COLUMNS, find_header, same_name};
use super::encoding::as_text;
use super::reading::Log;
use super::table::{Rows, Table};
use super::text::lines;
use super::workbook;
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
    let is_sheet = workbook::is_archive(bytes) || workbook::is_compound(bytes);
    let text = if is_sheet {
        workbook::as_text(bytes, file, format.sheet.as_deref())?.into()
    } else {
        as_text(bytes, file, format)?
    };
    if b5r::is_xml(&text) {
        return ballbar_log::as_log(&b5r::parse(&text, file)?, file, format);
    }
    let mut lines = lines(&text).skip(format.skip_lines);
    let header = find_header(file, &mut lines, format)?;
    let Rows { readings, angles_deg, no_readings, began } =
        Table::new(file, header, format, is_sheet)?.rows(lines)?;
    let noted = |(word, count): (String, usize)| {
        format!("{count} reading(s) are `{word}` and count as out of range")
    };
    let notes = no_readings.into_iter().map(noted).collect();

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
    let log = Log::new(file, readings, notes).begun(began);
    if !matches!(format.time, TimeColumn::Angle { .. }) {
        return Ok(log);
    }
    match (by_angle::turns(&angles_deg), format.plane) {
        (Some(turns), Some(plane)) => {
            Ok(log.with_angles(ByAngle { plane, turns, feed_mm_s: None, nominal_mm: None }))
        }
        (None, _) => unusable(
            "two readings that follow each other have the same angle".to_owned(),
            "a log by angle has one line for each angle; one with times is better".to_owned(),
        ),
        (_, None) => unusable(
            "a log by angle does not say its plane".to_owned(),
            "write `plane = \"xy\"` (or `yz`, `zx`) under `[log]` in the test file".to_owned(),
        ),
    }
}

/// Reads what is in a file of Ballbar 20.
pub fn read_ballbar_file(file: &Path) -> Result<BallbarFile> {
    let bytes = input::read(file, "file")?;
    let text = as_text(&bytes, file, &Format::default())?;
    if !b5r::is_xml(&text) {
        return Err(Error::input("the file is no XML, so it is no .b5r of Ballbar 20")
            .at(Place::file(file))
            .hint("logs of other kinds are read with a test file: `ballbar analyse test.toml`"));
    }
    b5r::parse(&text, file)
}

/// The part of a format that no file can repair.
fn check_format(format: &Format) -> Result<()> {
    match &format.time {
        TimeColumn::Rate { hz } if !RATES_HZ.contains(hz) => {
            return Err(Error::input(format!("a log cannot have a rate of {hz} Hz"))
                .hint("`sample_rate_hz` is the number of samples in a second"));
        }
        TimeColumn::Named { name, .. } | TimeColumn::Angle { name }
            if same_name(name, &format.reading.name) =>
        {
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
