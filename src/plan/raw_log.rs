//! How a log is written, as the test file says it.

use serde::Deserialize;
use toml::Spanned;

use super::log_format::{
    DEFAULT_TIME, Format, LengthUnit, ReadingColumn, ReadingKind, TimeColumn, TimeUnit,
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

    pub(super) fn check(self, nominal_mm: f64, text: &Text<'_>) -> Result<Format> {
        let unknown_unit = |written: &Spanned<String>, names: &[&str]| {
            Error::input(format!("unknown unit `{}`", written.get_ref()))
                .at(text.place(written.span()))
                .hint(format!("write one of `{}`", names.join("`, `")))
        };
        let defaults = Format::default();
        let rate_hz = self.sample_rate_hz(text)?;
        let time_suffix = |name: &str| name.rsplit('_').next().and_then(TimeUnit::parse);
        let time_unit = match &self.time_unit {
            None => self.time_column.as_deref().and_then(time_suffix).unwrap_or(TimeUnit::Second),
            Some(unit) => TimeUnit::parse(unit.get_ref())
                .ok_or_else(|| unknown_unit(unit, &TimeUnit::NAMES))?,
        };
        let name = self.reading_column.unwrap_or(defaults.reading.name);
        // A column such as `length_mm` says its unit itself.
        let suffix = name.rsplit('_').next().and_then(LengthUnit::parse);
        let unit = match &self.reading_unit {
            None => suffix.unwrap_or(LengthUnit::Micrometre),
            Some(unit) => LengthUnit::parse(unit.get_ref())
                .ok_or_else(|| unknown_unit(unit, &LengthUnit::NAMES))?,
        };
        // A log with a time column keeps it; a rate alone means that there is none.
        let time = match (self.time_column, rate_hz) {
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
        Ok(Format { time, reading, delimiter: None })
    }
}
