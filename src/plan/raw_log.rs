//! How a log is written, as the test file says it.

use serde::Deserialize;
use toml::Spanned;

use super::log_format::{
    ClockwiseOrder, DEFAULT_TIME, DecimalMark, Format, LengthUnit, OutOfRange, ReadingColumn,
    ReadingKind, TextEncoding, TimeColumn, TimeUnit,
};
use crate::error::{Error, Result};
use crate::toml_text::Text;

/// Bounds of a sample rate, Hz: the times of a log with four decimals still tell 5000 a second apart.
const SLOWEST_HZ: f64 = 0.01;
const FASTEST_HZ: f64 = 5000.0;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLog {
    time_column: Option<String>,
    time_unit: Option<Spanned<String>>,
    sample_rate_hz: Option<Spanned<f64>>,
    reading_column: Option<String>,
    reading_unit: Option<Spanned<String>>,
    reading: Option<RawReading>,
    reading_sign: Option<Spanned<i64>>,
    encoding: Option<Spanned<String>>,
    skip_lines: Option<Spanned<f64>>,
    decimal_mark: Option<Spanned<String>>,
    out_of_range: Option<Spanned<toml::Value>>,
    sheet: Option<String>,
    angle_column: Option<Spanned<String>>,
    plane: Option<Spanned<String>>,
    data_arc_deg: Option<Spanned<f64>>,
    clockwise_order: Option<ClockwiseOrder>,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum RawReading {
    Deviation,
    Length,
}

impl RawLog {
    pub(super) fn sample_rate_hz(&self, text: &Text<'_>) -> Result<Option<f64>> {
        let within = |rate| text.within(rate, "sample_rate_hz", SLOWEST_HZ, FASTEST_HZ);
        self.sample_rate_hz.as_ref().map(within).transpose()
    }

    pub(super) fn check(self, nominal_mm: f64, range_mm: f64, text: &Text<'_>) -> Result<Format> {
        let unknown_unit = |written: &Spanned<String>, names: &[&str]| {
            Error::input(format!("unknown unit `{}`", written.get_ref()))
                .at(text.place(written.span()))
                .hint(format!("write one of `{}`", names.join("`, `")))
        };
        let defaults = Format::default();
        let encoding = self.encoding.as_ref().map(|name| encoding(name, text)).transpose()?;
        let decimal_mark =
            self.decimal_mark.as_ref().map(|mark| decimal_mark(mark, text)).transpose()?;
        let out_of_range =
            self.out_of_range.as_ref().map(|of| out_of_range(of, text)).transpose()?;
        let skip_lines =
            self.skip_lines.as_ref().map(|lines| skip_lines(lines, text)).transpose()?;
        let rate_hz = self.sample_rate_hz(text)?;
        let time_unit = match &self.time_unit {
            None => self
                .time_column
                .as_deref()
                .and_then(TimeUnit::of_column)
                .unwrap_or(TimeUnit::Second),
            Some(unit) => TimeUnit::parse(unit.get_ref())
                .ok_or_else(|| unknown_unit(unit, &TimeUnit::NAMES))?,
        };
        let name = self.reading_column.unwrap_or(defaults.reading.name);
        // A column such as `length_mm` says its unit itself.
        let unit = match &self.reading_unit {
            None => LengthUnit::of_column(&name).unwrap_or(LengthUnit::Micrometre),
            Some(unit) => LengthUnit::parse(unit.get_ref())
                .ok_or_else(|| unknown_unit(unit, &LengthUnit::NAMES))?,
        };
        // A log with a time column keeps it; a rate alone means that there is none.
        let stated_unit = self.reading_unit.is_some().then_some(unit);
        let plane = self.plane.as_ref().map(|name| plane(name, text)).transpose()?;
        let arc = |arc| text.within(arc, "data_arc_deg", ARCS_DEG[0], ARCS_DEG[1]);
        let data_arc_deg = self.data_arc_deg.as_ref().map(arc).transpose()?;
        if let Some(given) = self.angle_column.as_ref().filter(|_| self.time_column.is_some()) {
            return Err(Error::input("a log has angles or times, not both")
                .at(text.place(given.span()))
                .hint("leave `angle_column` out: times tell more"));
        }
        let angle = self.angle_column.map(Spanned::into_inner);
        let time = match (self.time_column, rate_hz) {
            _ if angle.is_some() => TimeColumn::Angle { name: angle.unwrap_or_default() },
            (Some(name), _) => TimeColumn::Named { name, unit: time_unit },
            (None, Some(hz)) => TimeColumn::Rate { hz },
            (None, None) => TimeColumn::Named { name: DEFAULT_TIME.to_owned(), unit: time_unit },
        };
        let kind = match self.reading {
            Some(RawReading::Length) => ReadingKind::Length { nominal_mm },
            _ => ReadingKind::Deviation,
        };
        let inverted = match &self.reading_sign {
            None => false,
            Some(sign) => {
                match (sign.get_ref(), kind) {
                    (1, _) => false,
                    (-1, ReadingKind::Deviation) => true,
                    (-1, ReadingKind::Length { .. }) => {
                        return Err(Error::input("a length cannot have a sign of -1")
                        .at(text.place(sign.span()))
                        .hint("leave `reading_sign` out: it is for readings of kind \"deviation\""));
                    }
                    (other, _) => {
                        return Err(Error::input(format!("`reading_sign` cannot be {other}"))
                        .at(text.place(sign.span()))
                        .hint(
                            "write -1 where the readings fall as the bar grows, else leave it out",
                        ));
                    }
                }
            }
        };
        let reading = ReadingColumn { name, unit, kind, inverted };
        Ok(Format {
            time,
            reading,
            encoding,
            skip_lines: skip_lines.unwrap_or(0),
            decimal_mark,
            out_of_range: out_of_range.unwrap_or_default(),
            range_mm,
            plane,
            data_arc_deg,
            clockwise: self.clockwise_order,
            stated_unit,
            sheet: self.sheet,
            delimiter: None,
        })
    }
}

fn encoding(name: &Spanned<String>, text: &Text<'_>) -> Result<TextEncoding> {
    TextEncoding::parse(name.get_ref()).ok_or_else(|| {
        Error::input(format!("unknown encoding `{}`", name.get_ref()))
            .at(text.place(name.span()))
            .hint("write `utf-8`, `utf-16le`, `utf-16be`, `windows-1252` or another name of the WHATWG Encoding Standard")
    })
}

fn decimal_mark(mark: &Spanned<String>, text: &Text<'_>) -> Result<DecimalMark> {
    DecimalMark::parse(mark.get_ref()).ok_or_else(|| {
        Error::input(format!("`{}` is no decimal mark", mark.get_ref()))
            .at(text.place(mark.span()))
            .hint("write `.` or `,`")
    })
}

/// No program writes more than that before its table.
const MOST_SKIPPED: f64 = 100_000.0;

fn skip_lines(lines: &Spanned<f64>, text: &Text<'_>) -> Result<usize> {
    let count = text.within(lines, "skip_lines", 0.0, MOST_SKIPPED)?;
    if count.fract() > 0.0 {
        return Err(Error::input(format!("`skip_lines` cannot be {count}"))
            .at(text.place(lines.span()))
            .hint("give a whole number of lines"));
    }
    Ok(count as usize)
}

/// So many words and numbers for one thing are a mistake.
const MOST_OUT_OF_RANGE: usize = 100;

/// A word or a number, or a list of them.
fn out_of_range(written: &Spanned<toml::Value>, text: &Text<'_>) -> Result<OutOfRange> {
    let each = match written.get_ref() {
        toml::Value::Array(each) => each.as_slice(),
        one => std::slice::from_ref(one),
    };
    let mut found = OutOfRange::default();
    if each.len() > MOST_OUT_OF_RANGE {
        return Err(Error::input(format!(
            "`out_of_range` has more than {MOST_OUT_OF_RANGE} entries"
        ))
        .at(text.place(written.span()))
        .hint("one or two are usual"));
    }
    for value in each {
        match value {
            toml::Value::String(word) => found.words.push(word.trim().to_owned()),
            toml::Value::Integer(number) => found.numbers.push(*number as f64),
            toml::Value::Float(number) => found.numbers.push(*number),
            _ => {
                return Err(Error::input("`out_of_range` is a word, a number, or a list of them")
                    .at(text.place(written.span()))
                    .hint("write what stands in the log where the bar is out of range, such as `out_of_range = [\"OVER\", 9999.9]`"));
            }
        }
    }
    Ok(found)
}

/// A part of an arc that makes a circle, deg.
pub(crate) const ARCS_DEG: [f64; 2] = [10.0, 360.0];

/// The axes of a plane, in the order in which angles count from the one to the other.
fn plane(name: &Spanned<String>, text: &Text<'_>) -> Result<[usize; 2]> {
    match name.get_ref().to_lowercase().as_str() {
        "xy" => Ok([0, 1]),
        "yz" => Ok([1, 2]),
        "zx" => Ok([2, 0]),
        _ => Err(Error::input(format!("`{}` is no plane", name.get_ref()))
            .at(text.place(name.span()))
            .hint("write `xy`, `yz` or `zx`")),
    }
}
