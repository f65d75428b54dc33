//! The rows of a log, each a reading or an error.

use std::ops::Range;
use std::path::Path;

use jiff::civil::Date;

use super::bounds::{BEYOND, LARGEST_DEVIATION_MM, LATEST_S, MOST_READINGS};
use super::clock::Clock;
use super::columns::{Header, find_column};
use super::day;
use super::number::{Fault, Numbers, is_nines, is_no_reading};
use super::plain::{Plain, PlainRows};
use super::reading::Reading;
use super::text::{Line, quote, split};
use super::unit_line::UnitLine;
use crate::error::{Error, Result};
use crate::plan::log_format::{Delimiter, Format, LengthUnit, ReadingKind, TimeColumn, TimeUnit};

/// So many words for no reading are told apart.
const MOST_WORDS: usize = 8;
const OTHER_WORDS: &str = "...";

const PLAIN_READING: &str = "a reading is a plain number; where the bar is out of range, leave \
    the field empty";
const PLAIN_ANGLE: &str =
    "an angle is a plain number of degrees, from the first axis of the plane towards the second";
/// Overshoot and several turns.
const LARGEST_DEG: f64 = 100_000.0;
const PLAIN_TIME: &str = "a time is a plain number; where the times are of no use but the rate is \
    constant, give `sample_rate_hz` instead of `time_column` in the test file";
const LATER: &str = "times must increase from line to line: were two captures joined, or are the \
    times too coarse? at a constant rate, `sample_rate_hz` instead of `time_column` in the test \
    file does without them";

/// Where the time of a row comes from.
enum Times {
    Column { index: usize, unit: TimeUnit },
    Rate { hz: f64 },
    Angle { index: usize },
}

/// A log whose header is understood.
pub(super) struct Table<'a> {
    file: &'a Path,
    delimiter: Delimiter,
    /// Fields of the header, and so of every row.
    width: usize,
    /// Rows of a sheet end with their last cell, and may have others beside the table.
    is_sheet: bool,
    times: Times,
    reading: usize,
    format: &'a Format,
}

impl<'a> Table<'a> {
    pub(super) fn new(
        file: &'a Path,
        header: Header<'a>,
        format: &'a Format,
        is_sheet: bool,
    ) -> Result<Self> {
        let Header { line: header, delimiter } = header;
        let mut fields = Vec::new();
        split(header.text, delimiter, &mut fields);
        let find = |name: &str| find_column(file, header, &fields, name);
        Ok(Self {
            file,
            delimiter,
            width: fields.len(),
            is_sheet,
            times: match &format.time {
                TimeColumn::Named { name, unit } => {
                    Times::Column { index: find(name)?, unit: *unit }
                }
                TimeColumn::Rate { hz } => Times::Rate { hz: *hz },
                TimeColumn::Angle { name } => Times::Angle { index: find(name)? },
            },
            reading: find(&format.reading.name)?,
            format,
        })
    }

    /// The names of its columns.
    pub(super) fn names(&self, header: Line) -> Vec<String> {
        let mut fields = Vec::new();
        split(header.text, self.delimiter, &mut fields);
        fields.into_iter().map(|field| header.text[field].to_owned()).collect()
    }

    /// The rows below the header of a text, where all of them are plain; nothing else is different from [`rows`](Self::rows).
    pub(super) fn plain_rows(&self, text: &str, header: Line) -> Option<Rows> {
        let Times::Column { index, unit } = self.times else { return None };
        if self.is_sheet {
            return None;
        }
        let end = (header.text.as_ptr() as usize - text.as_ptr() as usize) + header.text.len();
        let (_, below) = text.get(end..)?.split_once('\n')?;
        let plain = Plain {
            delimiter: self.delimiter,
            width: self.width,
            time: index,
            time_unit: unit,
            reading: self.reading,
            format: self.format,
        };
        let PlainRows { readings, no_readings: words } = plain.rows(below, header.number)?;
        let mut no_readings = Vec::new();
        for word in words {
            count(word, &mut no_readings);
        }
        Some(Rows { readings, angles_deg: Vec::new(), no_readings, began: None, of_day: false })
    }

    /// The readings, and what stood where there was none, each word with how often.
    pub(super) fn rows(&self, lines: impl Iterator<Item = Line<'a>>) -> Result<Rows> {
        let mut readings: Vec<Reading> = Vec::new();
        let mut no_readings = Vec::new();
        let mut numbers = Numbers::new(self.delimiter, self.format);
        let mut clock = Clock::default();
        let mut by_clock = None;
        let mut angles_deg = Vec::new();
        let mut fields = Vec::new();
        let mut earlier = "";
        let mut is_first = true;
        for line in lines {
            if line.is_comment() || (line.is_blank() && !self.blank_is_row(line)) {
                continue;
            }
            if std::mem::take(&mut is_first) && self.is_unit_line(line)? {
                continue;
            }
            split(line.text, self.delimiter, &mut fields);
            if self.is_sheet {
                let end = line.text.len();
                fields.resize(self.width.max(fields.len()), end..end);
                if self.is_beside(&fields) {
                    continue;
                }
            } else if fields.len() != self.width {
                return Err(self.wrong_width(line, &fields));
            }
            let time_s = match self.times {
                Times::Rate { hz } => readings.len() as f64 / hz,
                Times::Angle { index } => {
                    angles_deg.push(self.angle_deg(line, &fields[index], &mut numbers)?);
                    readings.len() as f64
                }
                Times::Column { index, unit } => {
                    let field = &fields[index];
                    let written = &line.text[field.clone()];
                    let fail = |what| line.error(self.file, field, what);
                    if written.is_empty() {
                        return Err(fail("the time is missing".to_owned()).hint(PLAIN_TIME));
                    }
                    let of_day = Clock::is_one(written);
                    if *by_clock.get_or_insert(of_day) != of_day {
                        let what =
                            format!("{} among times that are written otherwise", quote(written));
                        return Err(fail(what).hint(LATER));
                    }
                    let time_s = if of_day {
                        clock.parse(written)
                    } else {
                        numbers.parse(written, |value| unit.to_s(value))
                    };
                    let time_s = time_s
                        .map_err(|fault| fail(fault.what).hint(fault.hint.unwrap_or(PLAIN_TIME)))?;
                    if time_s.abs() > LATEST_S {
                        return Err(fail(format!(
                            "time {} {} is more than {LATEST_S} s",
                            quote(written),
                            unit.name()
                        ))
                        .hint("is `time_unit` right, and is this the column of the times?"));
                    }
                    if let Some(last) = readings.last().filter(|last| time_s <= last.time_s) {
                        let verb =
                            if time_s < last.time_s { "goes back behind" } else { "repeats" };
                        let unit = unit.name();
                        return Err(fail(format!(
                            "time {written} {unit} {verb} {earlier} {unit} of line {}",
                            last.line
                        ))
                        .hint(LATER));
                    }
                    earlier = written;
                    time_s
                }
            };
            if readings.len() == MOST_READINGS {
                return Err(line
                    .error(
                        self.file,
                        &(0..0),
                        format!("the log has more than {MOST_READINGS} readings"),
                    )
                    .hint("export fewer readings a second, or only the time of the program"));
            }
            let field = &fields[self.reading];
            let deviation_mm = self.deviation_mm(line, field, &mut numbers)?;
            if deviation_mm.is_none() && !field.is_empty() {
                count(&line.text[field.clone()], &mut no_readings);
            }
            readings.push(Reading { time_s, deviation_mm, line: line.number });
        }
        let began = day::parse(clock.first_date());
        let of_day = by_clock == Some(true);
        Ok(Rows { readings, angles_deg, no_readings, began, of_day })
    }

    fn angle_deg(&self, line: Line, field: &Range<usize>, numbers: &mut Numbers) -> Result<f64> {
        let fail = |what| line.error(self.file, field, what).hint(PLAIN_ANGLE);
        let angle = numbers.parse(&line.text[field.clone()], |value| value);
        let angle_deg = angle.map_err(|fault| fail(fault.what))?;
        if angle_deg.abs() > LARGEST_DEG {
            return Err(fail(format!("an angle of {angle_deg} degrees")));
        }
        Ok(angle_deg)
    }

    /// Whether the first line below the names says the units of the columns, which must be those of the format.
    fn is_unit_line(&self, line: Line) -> Result<bool> {
        let units = UnitLine::of(line, self.delimiter).filter(|of| of.width() == self.width);
        let Some(units) = units else { return Ok(false) };
        let time = match self.times {
            Times::Column { index, .. } => Some(index),
            Times::Rate { .. } | Times::Angle { .. } => None,
        };
        units.agrees(self.file, self.format, time, self.reading).map(|()| true)
    }

    fn deviation_mm(
        &self,
        line: Line,
        field: &Range<usize>,
        numbers: &mut Numbers,
    ) -> Result<Option<f64>> {
        let written = &line.text[field.clone()];
        let out_of_range = &self.format.out_of_range;
        if written.is_empty() || is_no_reading(written) || out_of_range.has_word(written) {
            return Ok(None);
        }
        let fail = |what| line.error(self.file, field, what);
        let refused = |Fault { what, hint }| {
            let word = format!(
                "{PLAIN_READING}, or, if that is what {} means, write {} under `[log]` in the test file",
                quote(written),
                out_of_range_line(written)
            );
            let hint = hint.map_or(
                if written.len() > LONGEST_WORD { PLAIN_READING.to_owned() } else { word },
                str::to_owned,
            );
            fail(what).hint(hint)
        };
        let value = numbers.parse(written, |value| value).map_err(refused)?;
        if out_of_range.has_number(value) {
            return Ok(None);
        }
        let (unit, kind) = (self.format.reading.unit, self.format.reading.kind);
        let value_mm = unit.to_mm(value);
        let (deviation_mm, told) = match kind {
            ReadingKind::Deviation => (value_mm, "\"deviation\"".to_owned()),
            ReadingKind::Length { nominal_mm } => {
                (value_mm - nominal_mm, format!("\"length\" (nominal {nominal_mm} mm)"))
            }
        };
        if deviation_mm.abs() > BEYOND * self.format.range_mm && is_nines(written) {
            return Ok(None);
        }
        if deviation_mm.abs() <= LARGEST_DEVIATION_MM {
            return Ok(Some(if self.format.reading.inverted {
                -deviation_mm
            } else {
                deviation_mm
            }));
        }
        let hint = other_reading(&self.format.reading.name, unit, kind, Some(value));
        let unit = unit.name();
        Err(fail(format!(
            "reading {written} {unit} is a deviation of {} mm, which no ball-bar reaches",
            short(deviation_mm)
        ))
        .hint(format!(
            "`reading_unit` is \"{unit}\" and `reading` is {told}: {hint}; if the instrument writes {written} where the bar is out of range, write {} there",
            out_of_range_line(written)
        )))
    }

    /// Whether a row has nothing in the columns of the table.
    fn is_beside(&self, fields: &[Range<usize>]) -> bool {
        match self.times {
            Times::Column { index, .. } => {
                fields[index].is_empty() && fields[self.reading].is_empty()
            }
            Times::Rate { .. } => false,
            Times::Angle { index } => fields[index].is_empty() && fields[self.reading].is_empty(),
        }
    }

    /// Whether a line with nothing to see on it is a sample out of range.
    fn blank_is_row(&self, line: Line) -> bool {
        self.width == 1 || (self.delimiter == Delimiter::Tab && line.text.contains('\t'))
    }

    fn wrong_width(&self, line: Line, fields: &[Range<usize>]) -> Error {
        let (found, wanted) = (fields.len(), self.width);
        let plural = if found == 1 { "" } else { "s" };
        let what = format!("{found} field{plural} where the header has {wanted}");
        if found < wanted {
            let end = line.text.len();
            let hint = if self.delimiter == Delimiter::Blanks {
                "where blanks separate the fields, none can be empty: out of range needs a word, such as NaN"
            } else {
                "was the log cut off here? a sample out of range keeps its delimiter: only its \
                 reading is empty"
            };
            return line.error(self.file, &(end..end), what).hint(hint);
        }
        let error = line.error(self.file, &(fields[wanted].start..line.text.len()), what);
        match self.delimiter {
            Delimiter::Comma => error.hint(
                "every row must have the fields of the header; a decimal comma cannot \
                 separate the fields as well: export the log with semicolons or tabs between them, or with \
                 decimal points",
            ),
            _ => error.hint("every row must have the fields of the header"),
        }
    }
}

/// What a table holds.
pub(super) struct Rows {
    pub(super) readings: Vec<Reading>,
    /// The angle of each, where it has one in place of a time, deg.
    pub(super) angles_deg: Vec<f64>,
    /// What stood where there was no reading, and how often.
    pub(super) no_readings: Vec<(String, usize)>,
    /// The day of the first, where its time says it.
    pub(super) began: Option<Date>,
    /// Whether its times are times of day.
    pub(super) of_day: bool,
}

/// Words are short.
const LONGEST_WORD: usize = 20;

fn count(word: &str, counts: &mut Vec<(String, usize)>) {
    let known = counts.len() < MOST_WORDS || counts.iter().any(|(known, _)| known == word);
    let word = if known { word } else { OTHER_WORDS };
    match counts.iter_mut().find(|(known, _)| known == word) {
        Some((_, count)) => *count += 1,
        None => counts.push((word.to_owned(), 1)),
    }
}

/// The line of the test file that makes a word or a number no reading.
fn out_of_range_line(written: &str) -> String {
    if written.parse::<f64>().is_ok() {
        format!("`out_of_range = {written}`")
    } else {
        format!("`out_of_range = \"{written}\"`")
    }
}

/// What to write where a reading in this unit and of this kind is more than any bar can read.
fn other_reading(
    column: &str,
    stated: LengthUnit,
    kind: ReadingKind,
    value: Option<f64>,
) -> String {
    let reached = |unit: LengthUnit, nominal_mm: f64| {
        value.is_some_and(|value| (unit.to_mm(value) - nominal_mm).abs() <= LARGEST_DEVIATION_MM)
    };
    let nominal_mm = match kind {
        ReadingKind::Deviation => 0.0,
        ReadingKind::Length { nominal_mm } => nominal_mm,
    };
    let mut lines = Vec::new();
    if matches!(kind, ReadingKind::Length { .. }) && reached(stated, 0.0) {
        lines.push("`reading = \"deviation\"`".to_owned());
    }
    // Of the units that make it a reading, the one that changes it least.
    let possible = LengthUnit::ALL.into_iter().filter(|unit| reached(*unit, nominal_mm));
    if let Some(unit) = possible.max_by(|a, b| a.to_mm(1.0).total_cmp(&b.to_mm(1.0))) {
        lines.push(format!("`reading_unit = \"{}\"`", unit.name()));
    }
    // Bars are 50 to 1500 mm long, extensions included.
    let long = |value: f64| (50.0..=1500.0).contains(&stated.to_mm(value));
    if kind == ReadingKind::Deviation && value.is_some_and(long) {
        let line = "`reading = \"length\"`".to_owned();
        // The name of the column tells which is meant.
        let meant = column.to_lowercase().contains("length");
        lines.insert(if meant { 0 } else { lines.len() }, line);
    }
    if lines.is_empty() {
        return "choose another column: `reading_column`".to_owned();
    }
    format!("write {} under `[log]` in the test file", lines.join(", or "))
}

/// A length for a message: micrometres matter in it only when it is small.
fn short(mm: f64) -> String {
    if mm.abs() < 1e6 { format!("{mm:.3}") } else { format!("{mm:.3e}") }
}
