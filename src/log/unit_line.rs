//! A line below the names of the columns that says their units, such as `[s];[um]` or `ms,mm`.

use std::ops::Range;
use std::path::Path;

use super::text::{Line, quote, split};
use crate::error::Result;
use crate::plan::log_format::{Delimiter, Format, LengthUnit, TimeColumn, TimeUnit};

/// No unit is longer, in characters.
const LONGEST: usize = 8;

/// The units of a table's columns, as the line below their names has them.
pub(super) struct UnitLine<'a> {
    line: Line<'a>,
    fields: Vec<Range<usize>>,
}

impl<'a> UnitLine<'a> {
    /// A line of which every field is empty or a short word without figures, and one is a unit of length.
    pub(super) fn of(line: Line<'a>, delimiter: Delimiter) -> Option<Self> {
        let mut fields = Vec::new();
        split(line.text, delimiter, &mut fields);
        let units = Self { line, fields };
        let words = || units.fields.iter().map(|field| bare(&line.text[field.clone()]));
        let is_word = |word: &str| {
            word.chars().count() <= LONGEST && !word.contains(|c: char| c.is_ascii_digit())
        };
        let is_length = |word: &str| LengthUnit::parse(word).is_some();
        (words().all(is_word) && words().any(is_length)).then_some(units)
    }

    /// How many columns it has.
    pub(super) fn width(&self) -> usize {
        self.fields.len()
    }

    /// The unit of a column of times, by its index.
    pub(super) fn time(&self, index: usize) -> Option<TimeUnit> {
        TimeUnit::parse(self.word(index)?)
    }

    /// The unit of a column of readings, by its index.
    pub(super) fn length(&self, index: usize) -> Option<LengthUnit> {
        LengthUnit::parse(self.word(index)?)
    }

    fn word(&self, index: usize) -> Option<&'a str> {
        Some(bare(&self.line.text[self.fields.get(index)?.clone()]))
    }

    /// Whether the columns that are read have the units of a format.
    ///
    /// # Errors
    /// Where one has another, with the line to write: whoever took the wrong one would be off by a thousand.
    pub(super) fn agrees(
        &self,
        file: &Path,
        format: &Format,
        time: Option<usize>,
        reading: usize,
    ) -> Result<()> {
        let other = |index: usize, taken: &str, key: &str, unit: &str| {
            let field = &self.fields[index];
            let what = format!(
                "the log says {} below the name of this column, and the test file takes it for {taken}",
                quote(&self.line.text[field.clone()])
            );
            Err(self.line.error(file, field, what).hint(format!(
                "write `{key} = \"{unit}\"` under `[log]` in the test file, or take the line of units out of the log"
            )))
        };
        if let (Some(index), TimeColumn::Named { unit, .. }) = (time, &format.time) {
            match self.time(index) {
                Some(own) if own != *unit => {
                    return other(index, unit.name(), "time_unit", own.name());
                }
                _ => {}
            }
        }
        match self.length(reading) {
            Some(own) if own != format.reading.unit => {
                other(reading, format.reading.unit.name(), "reading_unit", own.name())
            }
            _ => Ok(()),
        }
    }
}

/// A word without the brackets around it.
fn bare(word: &str) -> &str {
    word.trim_matches(|c: char| c.is_whitespace() || "[](){}<>".contains(c))
}

#[cfg(test)]
mod tests {
    use super::super::{Content, Log, look_into, read_bytes};
    use super::*;
    use crate::plan::log_format::ReadingColumn;

    fn format(time: (&str, TimeUnit), reading: (&str, LengthUnit)) -> Format {
        let default = Format::default();
        let time = TimeColumn::Named { name: time.0.into(), unit: time.1 };
        let reading =
            ReadingColumn { name: reading.0.into(), unit: reading.1, ..default.reading.clone() };
        Format { time, reading, ..default }
    }

    fn read(text: &str, format: &Format) -> Result<Log> {
        read_bytes(text.as_bytes(), "run.csv".as_ref(), format)
    }

    const GERMAN: &str =
        "Zeit;Abweichung;Temperatur\n[ms];[\u{b5}m];\u{b0}C\n0,0;1,5;20\n100,0;2,5;20\n";

    #[test]
    fn a_line_of_units_below_the_names_is_no_reading() {
        let micrometres =
            format(("Zeit", TimeUnit::Millisecond), ("Abweichung", LengthUnit::Micrometre));
        let log = read(GERMAN, &micrometres).unwrap();
        let found: Vec<_> = log.readings().iter().map(|of| (of.time_s, of.deviation_mm)).collect();
        assert_eq!(found, [(0.0, Some(1.5e-3)), (0.1, Some(2.5e-3))]);
        let default = Format::default();
        for line in ["s,um", "(s),(um)", "\"s\",\"um\"", ",um"] {
            let text = format!("time_s,deviation_um\n{line}\n0,1\n1,2\n");
            assert_eq!(read(&text, &default).unwrap().readings().len(), 2, "{line}");
        }
    }

    #[test]
    fn another_unit_than_the_test_file_takes_is_refused_with_the_line_to_write() {
        for (time, reading, told) in [
            (TimeUnit::Second, LengthUnit::Micrometre, "`time_unit = \"ms\"`"),
            (TimeUnit::Millisecond, LengthUnit::Millimetre, "`reading_unit = \"um\"`"),
        ] {
            let error = read(GERMAN, &format(("Zeit", time), ("Abweichung", reading))).unwrap_err();
            assert!(error.hint.as_ref().is_some_and(|hint| hint.contains(told)), "{error}");
            assert_eq!(error.place.map(|place| place.line), Some(2));
        }
        // Whoever has said nothing is told all of it, and `show` reads it by itself.
        let error = read(GERMAN, &Format::default()).unwrap_err();
        let lines = "`time_column = \"Zeit\"`, `time_unit = \"ms\"`, `reading_column = \"Abweichung\"` under";
        assert!(error.hint.as_ref().is_some_and(|hint| hint.contains(lines)), "{error}");
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), GERMAN).unwrap();
        let Content::Table(table) = look_into(file.path(), None).unwrap() else { panic!("XML") };
        assert_eq!(table.layout.format.reading.unit, LengthUnit::Micrometre);
        assert_eq!(table.log.readings().len(), 2);
    }

    #[test]
    fn words_that_are_no_units_are_no_line_of_units() {
        let line = |text| Line { number: 2, text };
        for text in ["OVER,---", "0,1", "s,", "a long text beside,um", "mm2,s"] {
            assert!(UnitLine::of(line(text), Delimiter::Comma).is_none(), "{text}");
        }
    }
}
