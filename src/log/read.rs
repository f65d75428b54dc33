//! From the content of a file to a [`Log`], or to the line that is wrong.

use std::path::Path;

use super::b5r::{self, BallbarFile};
use super::ballbar_log;
use super::by_angle::{self, ByAngle, Said, Turn};
use super::columns::{CHOOSE_COLUMNS, by_name, find_header, lines_for_the_test, same_name};
use super::content::{Content, Layout, Table, Written};
use super::encoding::as_text;
use super::reading::{Log, Reading};
use super::table::{self, Rows};
use super::text::lines;
use super::workbook;
use crate::error::{Error, Place, Result};
use crate::input;
use crate::plan::log_format::{ClockwiseOrder, Format, ReadingKind, TimeColumn};

/// Rates outside are slips of the pen, and inside `k / hz` is finite and increases for any `k`.
const RATES_HZ: std::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// Reads a log.
pub fn read(file: &Path, format: &Format) -> Result<Log> {
    as_log(content(&input::read(file, "log")?, file, format, Columns::AsStated)?, file, format)
}

/// Reads a log from the content of a file; `file` is only named in messages and in the log.
pub fn read_bytes(bytes: &[u8], file: &Path, format: &Format) -> Result<Log> {
    let bytes = input::unpacked(bytes, file, "log")?;
    as_log(content(&bytes, file, format, Columns::AsStated)?, file, format)
}

/// Reads whatever holds readings, for who wants to see what is in it; without a format the columns are those whose names say
/// their units, and a table by angle need not say its plane.
pub fn look_into(file: &Path, format: Option<&Format>) -> Result<Content> {
    let default = Format::default();
    let columns = if format.is_some() { Columns::AsStated } else { Columns::ByName };
    content(&input::read(file, "log")?, file, format.unwrap_or(&default), columns)
}

/// The log that a file of Ballbar 20 is, by a format.
pub fn log_of(found: &BallbarFile, file: &Path, format: &Format) -> Result<Log> {
    check_format(format)?;
    ballbar_log::as_log(found, file, format)
}

fn as_log(content: Content, file: &Path, format: &Format) -> Result<Log> {
    let Table { log, turns, layout } = match content {
        Content::Ballbar(found) => return log_of(&found, file, format),
        Content::Table(table) => *table,
    };
    if !matches!(layout.format.time, TimeColumn::Angle { .. }) {
        return Ok(log);
    }
    let plane = format.plane.ok_or_else(|| {
        Error::input("a log by angle does not say its plane")
            .at(Place::file(file))
            .hint("write `plane = \"xy\"` (or `yz`, `zx`) under `[log]` in the test file")
    })?;
    let said = Said::default();
    Ok(log.with_angles(ByAngle { plane, turns, feed_mm_s: None, nominal_mm: None, said }))
}

/// Which columns are read.
#[derive(Clone, Copy, PartialEq)]
enum Columns {
    /// Those of the format.
    AsStated,
    /// Those, or else the ones whose names say their units.
    ByName,
}

fn content(bytes: &[u8], file: &Path, format: &Format, columns: Columns) -> Result<Content> {
    check_format(format)?;
    let is_sheet = workbook::is_archive(bytes) || workbook::is_compound(bytes);
    let (text, written) = if is_sheet {
        let (text, sheet) = workbook::as_text(bytes, file, format.sheet.as_deref())?;
        (text.into(), Written::Sheet(sheet))
    } else {
        let (text, encoding) = as_text(bytes, file, format)?;
        (text, Written::Text(encoding))
    };
    if b5r::is_xml(&text) {
        return Ok(Content::Ballbar(Box::new(b5r::parse(&text, file)?)));
    }
    let lines = || lines(&text).skip(format.skip_lines);
    let with_units = || by_name(lines(), format);
    let by_name = match columns {
        Columns::ByName => with_units(),
        Columns::AsStated => None,
    };
    let format = by_name.as_ref().unwrap_or(format);
    let mut lines = lines();
    let header = find_header(file, &mut lines, format)?;
    let table = table::Table::new(file, header, format, is_sheet).map_err(|error| {
        // The line below the names may say what the names do not.
        let found = (error.hint.as_deref() == Some(CHOOSE_COLUMNS)).then(with_units).flatten();
        match found {
            Some(found) => {
                let lines = lines_for_the_test(&found).join("`, `");
                let hint = format!(
                    "write `{lines}` under `[log]` in the test file, or the columns that you mean"
                );
                Error { hint: Some(hint), ..error }
            }
            None => error,
        }
    })?;
    let rows = match table.plain_rows(&text, header.line) {
        Some(rows) => rows,
        None => table.rows(lines)?,
    };
    let Rows { mut readings, angles_deg, no_readings, began, of_day } = rows;
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
    let rising = format.clockwise == Some(ClockwiseOrder::Rising);
    let turns =
        if rising { by_angle::rising_turns(&angles_deg) } else { by_angle::turns(&angles_deg) };
    let Some(turns) = turns else {
        return unusable(
            if rising {
                "the angles do not rise".to_owned()
            } else {
                "two readings that follow each other have the same angle".to_owned()
            },
            "a log by angle has one line for each angle, in the order of `clockwise_order`; one with times is better".to_owned(),
        );
    };
    if rising {
        as_driven(&turns, &mut readings);
    }
    let layout = Layout {
        written,
        header_line: header.line.number,
        delimiter: header.delimiter,
        columns: table.names(header.line),
        of_day,
        format: format.clone(),
    };
    let log = Log::new(file, readings, notes).begun(began);
    Ok(Content::Table(Box::new(Table { log, turns, layout })))
}

/// Puts readings that stand by rising angle into the order in which they were driven; the times of a log by angle only count.
fn as_driven(turns: &[Turn], readings: &mut [Reading]) {
    for turn in turns.iter().filter(|turn| !turn.counter_clockwise) {
        let of_turn = &mut readings[turn.readings.clone()];
        let times_s: Vec<f64> = of_turn.iter().map(|reading| reading.time_s).collect();
        of_turn.reverse();
        for (reading, time_s) in of_turn.iter_mut().zip(times_s) {
            reading.time_s = time_s;
        }
    }
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
