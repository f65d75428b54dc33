//! Who measured what, when and with what: nothing of it changes a number but the temperatures, and those only one that is
//! told besides.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::error::{Error, Result};
use crate::toml_text::Text;

/// What a test file says of the day.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Record {
    /// For whom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub customer: Option<String>,
    /// Who ran it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operator: Option<String>,
    /// When, year-month-day.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// Serial number of the machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine_serial: Option<String>,
    /// Serial number of the bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bar_serial: Option<String>,
    /// When the bar was calibrated last, year-month-day.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bar_calibrated: Option<String>,
    /// Which compensation was active in the control.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compensation: Option<String>,
    /// Anything else.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The machine's scales.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<Warmth>,
    /// The bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bar: Option<Warmth>,
}

/// How warm a thing was and how it expands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Warmth {
    /// Its temperature, degrees Celsius.
    pub temperature_c: f64,
    /// Standard deviation of that, K.
    pub temperature_sigma_k: f64,
    /// Its coefficient of expansion, um/m/K.
    pub expansion_um_m_k: f64,
    /// Standard deviation of that, um/m/K.
    pub expansion_sigma_um_m_k: f64,
}

impl Warmth {
    /// By how much it is longer than at 20 degrees, and the standard deviation of that, um/m.
    pub fn longer_um_m(&self) -> [f64; 2] {
        let above_k = self.temperature_c - REFERENCE_C;
        let sigma = (self.expansion_um_m_k * self.temperature_sigma_k)
            .hypot(self.expansion_sigma_um_m_k * above_k);
        [self.expansion_um_m_k * above_k, sigma]
    }
}

/// Lengths are stated at this temperature (ISO 1), degrees Celsius.
const REFERENCE_C: f64 = 20.0;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRecord {
    customer: Option<Spanned<String>>,
    operator: Option<Spanned<String>>,
    date: Option<Spanned<toml::Value>>,
    machine_serial: Option<Spanned<String>>,
    bar_serial: Option<Spanned<String>>,
    bar_calibrated: Option<Spanned<toml::Value>>,
    compensation: Option<Spanned<String>>,
    note: Option<Spanned<String>>,
    machine_temperature_c: Option<Spanned<f64>>,
    machine_expansion_um_m_k: Option<Spanned<f64>>,
    bar_temperature_c: Option<Spanned<f64>>,
    bar_expansion_um_m_k: Option<Spanned<f64>>,
    temperature_sigma_k: Option<Spanned<f64>>,
    expansion_sigma_percent: Option<Spanned<f64>>,
}

/// Longer texts belong into a file of their own, bytes.
const LONGEST: usize = 1000;
/// Where machines and people can be, degrees Celsius.
const TEMPERATURES_C: [f64; 2] = [-20.0, 80.0];
/// From shrinking carbon fibre to plastics, um/m/K.
const EXPANSIONS_UM_M_K: [f64; 2] = [-10.0, 100.0];
/// Of a thermometer and of the place where it is put, K.
const SIGMAS_K: [f64; 2] = [0.0, 20.0];

impl RawRecord {
    pub(super) fn check(&self, text: &Text<'_>) -> Result<Record> {
        let words = |written: &Option<Spanned<String>>, key: &str| {
            let checked = written.as_ref().map(|written| words(written, key, text));
            checked.transpose().map(Option::flatten)
        };
        let day = |written: &Option<Spanned<toml::Value>>, key: &str| {
            written.as_ref().map(|written| day(written, key, text)).transpose()
        };
        let within = |value: &Option<Spanned<f64>>, key: &str, [low, high]: [f64; 2]| {
            value.as_ref().map(|value| text.within(value, key, low, high)).transpose()
        };
        let sigma_k = within(&self.temperature_sigma_k, "temperature_sigma_k", SIGMAS_K)?;
        let percent =
            within(&self.expansion_sigma_percent, "expansion_sigma_percent", [0.0, 100.0])?;
        let warmth = |temperature: &Option<Spanned<f64>>,
                      expansion: &Option<Spanned<f64>>,
                      [temperature_key, expansion_key]: [&str; 2]| {
            let temperature_c = within(temperature, temperature_key, TEMPERATURES_C)?;
            let expansion_um_m_k = within(expansion, expansion_key, EXPANSIONS_UM_M_K)?;
            match (temperature_c, expansion_um_m_k, temperature, expansion) {
                (Some(temperature_c), Some(expansion_um_m_k), _, _) => Ok(Some(Warmth {
                    temperature_c,
                    temperature_sigma_k: sigma_k.unwrap_or(0.5),
                    expansion_um_m_k,
                    expansion_sigma_um_m_k: expansion_um_m_k.abs() * percent.unwrap_or(10.0) / 100.0,
                })),
                (None, None, _, _) => Ok(None),
                (_, _, Some(alone), _) | (_, _, _, Some(alone)) => {
                    Err(Error::input("a temperature and an expansion say something only together")
                        .at(text.place(alone.span()))
                        .hint(format!("give both `{temperature_key}` and `{expansion_key}`, such as 11.5 for steel or 8.0 for glass scales")))
                }
                _ => Ok(None),
            }
        };
        Ok(Record {
            customer: words(&self.customer, "customer")?,
            operator: words(&self.operator, "operator")?,
            date: day(&self.date, "date")?,
            machine_serial: words(&self.machine_serial, "machine_serial")?,
            bar_serial: words(&self.bar_serial, "bar_serial")?,
            bar_calibrated: day(&self.bar_calibrated, "bar_calibrated")?,
            compensation: words(&self.compensation, "compensation")?,
            note: words(&self.note, "note")?,
            machine: warmth(
                &self.machine_temperature_c,
                &self.machine_expansion_um_m_k,
                ["machine_temperature_c", "machine_expansion_um_m_k"],
            )?,
            bar: warmth(
                &self.bar_temperature_c,
                &self.bar_expansion_um_m_k,
                ["bar_temperature_c", "bar_expansion_um_m_k"],
            )?,
        })
    }
}

/// A text that is not too long; `None` of one that says nothing.
fn words(written: &Spanned<String>, key: &str, text: &Text<'_>) -> Result<Option<String>> {
    let words = written.get_ref().trim();
    if words.len() > LONGEST {
        return Err(Error::input(format!("`{key}` has more than {LONGEST} bytes"))
            .at(text.place(written.span()))
            .hint("say it shorter"));
    }
    Ok((!words.is_empty()).then(|| words.to_owned()))
}

/// A day, with quotes or without.
fn day(written: &Spanned<toml::Value>, key: &str, text: &Text<'_>) -> Result<String> {
    let date = match written.get_ref() {
        toml::Value::Datetime(date) => date.date,
        toml::Value::String(words) => {
            words.trim().parse::<toml::value::Datetime>().ok().and_then(|date| date.date)
        }
        _ => None,
    };
    date.map(|date| date.to_string()).ok_or_else(|| {
        Error::input(format!("`{key}` is no day"))
            .at(text.place(written.span()))
            .hint(format!("write year, month and day: `{key} = 2026-11-23`"))
    })
}

#[cfg(test)]
mod tests {
    use super::Record;
    use crate::plan::Test;

    fn with(record: &str) -> crate::Result<Record> {
        let source = format!(
            "name = \"t\"\nmachine = \"m.toml\"\n[record]\n{record}\n[ball_bar]\nlength_mm = 150.0\n\
             [[mounting]]\nname = \"A\"\ncoincidence_mm = [0, 0, 0]\ntool_ball_mm = [0, 0, -200]\n"
        );
        Test::parse(&source, "t.toml".as_ref()).map(|test| test.record().clone())
    }

    #[test]
    fn days_with_quotes_and_without() {
        let day = |written: &str| with(&format!("date = {written}")).unwrap().date;
        for written in ["2026-11-23", "\"2026-11-23\"", "2026-11-23T08:00:00Z"] {
            assert_eq!(day(written).as_deref(), Some("2026-11-23"), "{written}");
        }
        assert_eq!(with("").unwrap(), Record::default());
        assert_eq!(with("operator = \" \"").unwrap().operator, None);
    }

    #[test]
    fn what_is_longer_when_it_is_warm() {
        let record = with(
            "machine_temperature_c = 25\nmachine_expansion_um_m_k = 10\ntemperature_sigma_k = 0.3\nexpansion_sigma_percent = 8",
        );
        let [longer, sigma] = record.unwrap().machine.unwrap().longer_um_m();
        assert!((longer - 50.0).abs() < 1e-12);
        // 10 um/m/K times 0.3 K, and 0.8 um/m/K times 5 K.
        assert!((sigma - 5.0).abs() < 1e-12, "{sigma}");
    }

    #[test]
    fn what_is_no_record_is_told_with_its_line() {
        for (written, told) in [
            ("date = \"23.11.2026\"", "`date` is no day"),
            ("bar_calibrated = 8", "`bar_calibrated` is no day"),
            ("bar_temperature_c = 200", "between -20 and 80"),
            ("bar_temperature_c = 22", "only together"),
            ("bar_expansion_um_m_k = 1", "only together"),
        ] {
            let error = with(written).unwrap_err();
            assert!(error.what.contains(told) && error.hint.is_some(), "{error}");
            assert_eq!(error.place.map(|place| place.line), Some(4));
        }
        assert!(with(&format!("note = \"{}\"", "x".repeat(1001))).is_err());
    }
}
