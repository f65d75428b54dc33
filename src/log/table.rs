//! The rows of a log, each a reading or an error.

use std::ops::Range;
use std::path::Path;

use super::columns::find_column;
use super::reading::Reading;
use super::text::{Line, Numbers, quote, split};
use crate::error::{Error, Result};
use crate::plan::log_format::{
    Delimiter, Format, LengthUnit, ReadingColumn, ReadingKind, TimeColumn, TimeUnit,
};

/// No telescoping ball-bar reaches further than a few mm; beyond this the unit is wrong.
const LARGEST_DEVIATION_MM: f64 = 10.0;
/// Readings of a log: more than half an hour at 2000 a second, or a night at 100; what is made of them takes a hundred
/// times their memory.
const MOST_READINGS: usize = 4_000_000;
/// No clock has gone for longer, s: three hundred years, whichever day its times count from.
const LATEST_S: f64 = 1e10;

const PLAIN_READING: &str = "a reading is a plain number; where the bar is out of range, leave \
    the field empty";
const PLAIN_TIME: &str = "a time is a plain number; where the times are of no use but the rate is \
    constant, give `sample_rate_hz` instead of `time_column` in the test file";
const LATER: &str = "times must increase from line to line: were two captures joined, or are the \
    times too coarse? at a constant rate, `sample_rate_hz` instead of `time_column` in the test \
    file does without them";

/// Where the time of a row comes from.
enum Clock {
    Column { index: usize, unit: TimeUnit },
    Rate { hz: f64 },
}

/// A log whose header is understood.
pub(super) struct Table<'a> {
    file: &'a Path,
    delimiter: Delimiter,
    /// Fields of the header, and so of every row.
    width: usize,
    clock: Clock,
    reading: usize,
    column: &'a ReadingColumn,
}

impl<'a> Table<'a> {
    pub(super) fn new(file: &'a Path, header: Line<'a>, format: &'a Format) -> Result<Self> {
        if let Some(delimiter) = format.delimiter {
            return Self::with_delimiter(file, header, format, delimiter);
        }
        let attempts = Delimiter::ALL.map(|d| Self::with_delimiter(file, header, format, d));
        if let Some(table) = attempts.into_iter().find_map(Result::ok) {
            return Ok(table);
        }
        // The message should list the columns as the user sees them, not one long name.
        let mut fields = Vec::new();
        let likely = Delimiter::ALL.into_iter().max_by_key(|&d| {
            split(header.text, d, &mut fields);
            fields.len()
        });
        Self::with_delimiter(file, header, format, likely.unwrap_or(Delimiter::Comma))
    }

    fn with_delimiter(
        file: &'a Path,
        header: Line<'a>,
        format: &'a Format,
        delimiter: Delimiter,
    ) -> Result<Self> {
        let mut fields = Vec::new();
        split(header.text, delimiter, &mut fields);
        let find = |name: &str| find_column(file, header, &fields, name);
        Ok(Self {
            file,
            delimiter,
            width: fields.len(),
            clock: match &format.time {
                TimeColumn::Named { name, unit } => {
                    Clock::Column { index: find(name)?, unit: *unit }
                }
                TimeColumn::Rate { hz } => Clock::Rate { hz: *hz },
            },
            reading: find(&format.reading.name)?,
            column: &format.reading,
        })
    }

    pub(super) fn rows(&self, lines: impl Iterator<Item = Line<'a>>) -> Result<Vec<Reading>> {
        let mut readings: Vec<Reading> = Vec::new();
        let mut numbers = Numbers::new(self.delimiter);
        let mut fields = Vec::new();
        let mut earlier = "";
        for line in lines {
            if line.is_comment() || (line.is_blank() && !self.blank_is_row(line)) {
                continue;
            }
            split(line.text, self.delimiter, &mut fields);
            if fields.len() != self.width {
                return Err(self.wrong_width(line, &fields));
            }
            let time_s = match self.clock {
                Clock::Rate { hz } => readings.len() as f64 / hz,
                Clock::Column { index, unit } => {
                    let field = &fields[index];
                    let written = &line.text[field.clone()];
                    let fail = |what| line.error(self.file, field, what);
                    if written.is_empty() {
                        return Err(fail("the time is missing".to_owned()).hint(PLAIN_TIME));
                    }
                    let time_s = numbers
                        .parse(written, |value| unit.to_s(value))
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
            let deviation_mm = self.deviation_mm(line, &fields[self.reading], &mut numbers)?;
            readings.push(Reading { time_s, deviation_mm, line: line.number });
        }
        Ok(readings)
    }

    fn deviation_mm(
        &self,
        line: Line,
        field: &Range<usize>,
        numbers: &mut Numbers,
    ) -> Result<Option<f64>> {
        let written = &line.text[field.clone()];
        if written.is_empty() {
            return Ok(None);
        }
        let fail = |what| line.error(self.file, field, what);
        let ReadingColumn { unit, kind, inverted, .. } = self.column;
        let value_mm = numbers
            .parse(written, |value| unit.to_mm(value))
            .map_err(|fault| fail(fault.what).hint(fault.hint.unwrap_or(PLAIN_READING)))?;
        let (deviation_mm, kind) = match *kind {
            ReadingKind::Deviation => (value_mm, "\"deviation\"".to_owned()),
            ReadingKind::Length { nominal_mm } => {
                (value_mm - nominal_mm, format!("\"length\" (nominal {nominal_mm} mm)"))
            }
        };
        if deviation_mm.abs() <= LARGEST_DEVIATION_MM {
            return Ok(Some(if *inverted { -deviation_mm } else { deviation_mm }));
        }
        let hint =
            other_reading(*unit, self.column.kind, numbers.parse(written, |value| value).ok());
        let unit = unit.name();
        Err(fail(format!(
            "reading {written} {unit} is a deviation of {} mm, which no ball-bar reaches",
            short(deviation_mm)
        ))
        .hint(format!("`reading_unit` is \"{unit}\" and `reading` is {kind}: {hint}")))
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
            return line.error(self.file, &(end..end), what).hint(
                "was the log cut off here? a sample out of range keeps its delimiter: only its \
                 reading is empty",
            );
        }
        let error = line.error(self.file, &(fields[wanted].start..line.text.len()), what);
        match self.delimiter {
            Delimiter::Comma => error.hint(
                "every row must have the fields of the header; a decimal comma is read only where \
                 semicolons or tabs separate the fields",
            ),
            _ => error.hint("every row must have the fields of the header"),
        }
    }
}

/// What to write where a reading in this unit and of this kind is more than any bar can read.
fn other_reading(stated: LengthUnit, kind: ReadingKind, value: Option<f64>) -> String {
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
        lines.push("`reading = \"length\"`".to_owned());
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
