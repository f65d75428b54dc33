//! The scenario file: TOML in, a checked [`Scenario`] out.
//!
//! ```toml
//! seed = 1
//! sample_rate_hz = 10.0          # resolution_um, range_mm: where the test file is not to be believed
//! after_s = 5.0
//! feed_override_percent = 100.0
//! [coefficients]                 # mm and rad; what is not named is zero
//! EYYb = -3.1e-3
//! [set_up]                       # mm
//! EXt = 0.005
//! [noise]
//! white_um = 0.12
//! correlated_um = 0.1
//! correlation_s = 0.3
//! [motion]                       # how the control drives otherwise than the machine file says
//! acceleration_percent = 50.0    # acceleration_change_ms: where the machine file is not to be believed
//! standing_ms = [1.0, 20.0]      # what standstills take beyond their program
//! following_ms = [15.0, 15.0, 15.6]
//! [clock]
//! start_s = 3.0
//! ppm = -30.0
//! [pauses]
//! between_s = [5.0, 40.0]        # or fixed_s, one length for each M00
//! [dropouts]
//! per_s = 0.05
//! mean_s = 1.0
//! rows = "blank"                 # or "missing"
//! [[hide]]                       # as often as wanted: a cause and the keys of its text form
//! cause = "cyclic"
//! on = "EXX"
//! period_mm = 10.0
//! amplitude_um = 1.2
//! ```
//!
//! What is left out keeps its value from [`Scenario::default`]. `[coefficients]` and `[set_up]` are left
//! out or given as a whole: an empty `[coefficients]` is a machine without errors, and where there is none a plausible
//! machine may be drawn ([`Scenario::draw_machine`]).

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;

use super::control::Control;
use super::noise::Noise;
use super::scenario::{Coincidence, Dropouts, Pauses, Scenario};
use crate::error::{Error, Place, Result};
use crate::model::{Coefficient, Effect, ErrorFunctions, LARGEST_ERROR, SetUp};
use crate::plan::CORRELATIONS_S;
use crate::toml_text::{self, Text};

/// Effects of one machine.
const MOST_HIDDEN: usize = 100;
/// Four decimals of time still tell the samples of this rate apart.
const MOST_HZ: f64 = 5000.0;

impl Scenario {
    /// Reads and checks a scenario file.
    pub fn read(file: &Path) -> Result<Self> {
        Self::parse(&toml_text::read(file)?, file)
    }

    /// Checks the text of a scenario file; `file` is for messages.
    ///
    /// ```
    /// use ballbar::simulate::Scenario;
    ///
    /// let scenario = Scenario::parse("[coefficients]\nEYYb = -3.1e-3\n", "play.toml".as_ref())?;
    /// assert_eq!(scenario.named_values()[0], ("EYYb".to_owned(), -3.1e-3));
    /// let error = Scenario::parse("[coefficients]\nEYYB = 1e-3\n", "play.toml".as_ref()).unwrap_err();
    /// assert_eq!(error.hint.unwrap(), "write `EYYb`");
    /// # Ok::<(), ballbar::Error>(())
    /// ```
    pub fn parse(source: &str, file: &Path) -> Result<Self> {
        let text = Text { source, file };
        let raw: RawScenario = text.parse()?;
        raw.check(&text)
    }
}

type Values = BTreeMap<Spanned<String>, Spanned<f64>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawScenario {
    seed: Option<u64>,
    sample_rate_hz: Option<Spanned<f64>>,
    resolution_um: Option<Spanned<f64>>,
    range_mm: Option<Spanned<f64>>,
    after_s: Option<Spanned<f64>>,
    feed_override_percent: Option<Spanned<f64>>,
    coefficients: Option<Values>,
    set_up: Option<Values>,
    #[serde(default)]
    coincidence: Coincidence,
    #[serde(default)]
    noise: RawNoise,
    #[serde(default)]
    motion: RawMotion,
    #[serde(default)]
    clock: RawClock,
    pauses: Option<Spanned<RawPauses>>,
    dropouts: Option<RawDropouts>,
    #[serde(default)]
    hide: Vec<Spanned<RawEffect>>,
}

/// Keys differ from cause to cause.
type RawEffect = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawNoise {
    white_um: Option<Spanned<f64>>,
    correlated_um: Option<Spanned<f64>>,
    correlation_s: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawMotion {
    acceleration_percent: Option<Spanned<f64>>,
    acceleration_change_ms: Option<Spanned<f64>>,
    standing_ms: Option<Spanned<[f64; 2]>>,
    following_ms: Option<Spanned<[f64; 3]>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawClock {
    start_s: Option<Spanned<f64>>,
    ppm: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPauses {
    fixed_s: Option<Spanned<Vec<f64>>>,
    between_s: Option<Spanned<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDropouts {
    per_s: Spanned<f64>,
    mean_s: Spanned<f64>,
    #[serde(default)]
    rows: RawRows,
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum RawRows {
    #[default]
    Blank,
    Missing,
}

impl RawScenario {
    fn check(self, text: &Text<'_>) -> Result<Scenario> {
        let mut scenario = Scenario::default();
        if let Some(seed) = self.seed {
            scenario.seed = seed;
        }
        if let Some(values) = &self.coefficients {
            scenario.errors = ErrorFunctions::default();
            scenario.has_errors = true;
            for (name, value) in values {
                let coefficient = known(name, text, Coefficient::parse, Coefficient::all())?;
                scenario.errors.set(coefficient, plausible(value, name.get_ref(), text)?);
            }
        }
        if let Some(values) = &self.set_up {
            scenario.has_set_up = true;
            for set_up in SetUp::all() {
                scenario.set_set_up(set_up, 0.0);
            }
            for (name, value) in values {
                let set_up = known(name, text, SetUp::parse, SetUp::all())?;
                scenario.set_set_up(set_up, plausible(value, name.get_ref(), text)?);
            }
        }
        scenario.coincidence = self.coincidence;
        scenario.control = self.motion.check(text)?;
        scenario.noise = self.noise.check(&scenario.noise, text)?;
        let within =
            |value: &Option<Spanned<f64>>, key: &str, default: f64, low: f64, high: f64| {
                value.as_ref().map_or(Ok(default), |value| text.within(value, key, low, high))
            };
        scenario.start_s = within(&self.clock.start_s, "start_s", scenario.start_s, -1e5, 1e5)?;
        scenario.clock_ppm = within(&self.clock.ppm, "ppm", scenario.clock_ppm, -1e4, 1e4)?;
        scenario.after_s = within(&self.after_s, "after_s", scenario.after_s, -1e5, 1e5)?;
        scenario.feed_override =
            within(&self.feed_override_percent, "feed_override_percent", 100.0, 1.0, 200.0)?
                / 100.0;
        let optional = |value: &Option<Spanned<f64>>, key: &str, low: f64, high: f64| {
            value.as_ref().map(|value| text.within(value, key, low, high)).transpose()
        };
        scenario.sample_rate_hz = optional(&self.sample_rate_hz, "sample_rate_hz", 1e-3, MOST_HZ)?;
        scenario.resolution_mm =
            optional(&self.resolution_um, "resolution_um", 1e-6, 1e3)?.map(|um| um * 1e-3);
        scenario.range_mm = optional(&self.range_mm, "range_mm", 1e-3, 1e3)?;
        if let Some(pauses) = &self.pauses {
            scenario.pauses = pauses.get_ref().check(text.place(pauses.span()), text)?;
        }
        if let Some(of) = &self.dropouts {
            scenario.dropouts = Some(Dropouts {
                per_s: text.within(&of.per_s, "per_s", 1e-6, 100.0)?,
                mean_s: text.within(&of.mean_s, "mean_s", 1e-3, 1e4)?,
                missing_rows: of.rows == RawRows::Missing,
            });
        }
        let beyond = self.hide.get(MOST_HIDDEN).map(Spanned::span);
        let hint = "nobody finds more than a dozen beside each other";
        text.at_most(self.hide.len(), MOST_HIDDEN, "hidden effects", beyond, hint)?;
        for table in &self.hide {
            hide(&mut scenario, table, text)?;
        }
        Ok(scenario)
    }
}

/// Hides the effect of a `[[hide]]`.
fn hide(scenario: &mut Scenario, table: &Spanned<RawEffect>, text: &Text<'_>) -> Result<()> {
    let mut words: BTreeMap<&str, (&str, Place)> = BTreeMap::new();
    let mut numbers: Vec<(&str, f64)> = Vec::new();
    for (key, value) in table.get_ref() {
        let name = key.get_ref().as_str();
        let is_word = name == "cause" || name == "on";
        match value.get_ref() {
            toml::Value::String(word) if is_word => {
                words.insert(name, (word, text.place(value.span())));
            }
            toml::Value::Float(number) if !is_word => numbers.push((name, *number)),
            toml::Value::Integer(number) if !is_word => numbers.push((name, *number as f64)),
            _ => {
                let expected = if is_word { "text in quotes" } else { "a number" };
                return Err(Error::input(format!("`{name}` must be {expected}"))
                    .at(text.place(value.span()))
                    .hint("in a `[[hide]]`, `cause` and `on` are text, all others are numbers"));
            }
        }
    }
    let Some((cause, cause_place)) = words.get("cause") else {
        return Err(Error::input("this `[[hide]]` has no `cause`")
            .at(text.place(table.span()))
            .hint("write `cause = \"cyclic\"`; `ballbar reference causes` lists them"));
    };
    let on = words.get("on");
    let effect = Effect::of(cause, on.map(|(word, _)| *word), &numbers);
    effect.and_then(|effect| scenario.hide(effect)).map_err(|error| {
        // The place of what the message is about; what is missing has only that of its cause.
        let mut entries = table.get_ref().iter();
        let number = entries.find_map(|(key, value)| {
            let name = key.get_ref();
            let unknown = error.what.ends_with(&format!(" has no `{name}`"));
            let wrong = error.what.starts_with(&format!("`{name}` of "));
            unknown.then(|| key.span()).or(wrong.then(|| value.span()))
        });
        let seat = on.filter(|(word, _)| error.what.ends_with(&format!(" act on `{word}`")));
        let place = number.map(|span| text.place(span)).or(seat.map(|(_, place)| place.clone()));
        error.at(place.unwrap_or_else(|| cause_place.clone()))
    })
}

impl RawNoise {
    fn check(&self, default: &Noise, text: &Text<'_>) -> Result<Noise> {
        let um = |value: &Option<Spanned<f64>>, key: &str, default_mm: f64| match value {
            Some(value) => Ok(text.within(value, key, 0.0, 1e3)? * 1e-3),
            None => Ok(default_mm),
        };
        Ok(Noise {
            white_mm: um(&self.white_um, "white_um", default.white_mm)?,
            correlated_mm: um(&self.correlated_um, "correlated_um", default.correlated_mm)?,
            correlation_s: match &self.correlation_s {
                Some(value) => {
                    text.within(value, "correlation_s", CORRELATIONS_S[0], CORRELATIONS_S[1])?
                }
                None => default.correlation_s,
            },
        })
    }
}

impl RawMotion {
    fn check(self, text: &Text<'_>) -> Result<Control> {
        let mut control = Control::AS_PLANNED;
        if let Some(percent) = &self.acceleration_percent {
            control.acceleration = text.within(percent, "acceleration_percent", 1.0, 1e4)? / 100.0;
        }
        if let Some(ms) = &self.acceleration_change_ms {
            let change_ms = text.within(ms, "acceleration_change_ms", 0.0, 1e3)?;
            control.acceleration_change_s = Some(change_ms * 1e-3);
        }
        if let Some(limits) = &self.standing_ms {
            let [low, high] = *limits.get_ref();
            if !(0.0..=high).contains(&low) || high > 1e4 {
                return Err(Error::input("standstills cannot be drawn between these limits")
                    .at(text.place(limits.span()))
                    .hint("give the shorter one first, in ms from 0 to 10000, such as `standing_ms = [1, 20]`"));
            }
            control.standing_s = [low * 1e-3, high * 1e-3];
        }
        if let Some(of) = &self.following_ms {
            if !of.get_ref().iter().all(|ms| (0.0..=1e3).contains(ms)) {
                return Err(Error::input("a time constant lies from 0 to 1000 ms")
                    .at(text.place(of.span()))
                    .hint(
                        "give one for each of X, Y, Z, such as `following_ms = [15, 15, 15.6]`",
                    ));
            }
            control.following_s = 1e-3 * Vector3::from(*of.get_ref());
        }
        Ok(control)
    }
}

impl RawPauses {
    fn check(&self, place: Place, text: &Text<'_>) -> Result<Pauses> {
        let possible = |seconds: &f64| (0.0..=1e5).contains(seconds);
        match (&self.fixed_s, &self.between_s) {
            (Some(fixed), None) if fixed.get_ref().iter().all(possible) => {
                Ok(Pauses::Fixed(fixed.get_ref().clone()))
            }
            (None, Some(limits))
                if limits.get_ref().iter().all(possible)
                    && limits.get_ref()[0] <= limits.get_ref()[1] =>
            {
                Ok(Pauses::Between(*limits.get_ref()))
            }
            (Some(fixed), None) => {
                Err(Error::input("a pause lasts from 0 to 100000 s").at(text.place(fixed.span())))
            }
            (None, Some(limits)) => {
                Err(Error::input("pauses cannot be drawn between these limits")
                    .at(text.place(limits.span()))
                    .hint("give the shorter one first, in seconds, such as `between_s = [5, 40]`"))
            }
            _ => Err(Error::input("pauses have either `fixed_s` or `between_s`").at(place).hint(
                "`fixed_s = [12.5]` gives the length of each M00, `between_s = [5, 40]` draws them",
            )),
        }
    }
}

/// A coefficient or set-up error that a machine could have.
fn plausible(value: &Spanned<f64>, name: &str, text: &Text<'_>) -> Result<f64> {
    text.within(value, name, -LARGEST_ERROR, LARGEST_ERROR)
}

/// The coefficient or set-up error of a key.
fn known<T: ToString>(
    key: &Spanned<String>,
    text: &Text<'_>,
    parse: impl Fn(&str) -> Option<T>,
    all: impl Iterator<Item = T>,
) -> Result<T> {
    let name = key.get_ref().as_str();
    if let Some(of) = parse(name) {
        return Ok(of);
    }
    let names: Vec<String> = all.map(|of| of.to_string()).collect();
    let same_but_case = names.iter().find(|known| known.eq_ignore_ascii_case(name));
    let error = Error::input(format!("unknown name `{name}`")).at(text.place(key.span()));
    Err(match same_but_case {
        Some(meant) => error.hint(format!("write `{meant}`")),
        None if Coefficient::parse(name).is_some() => {
            error.hint("coefficients belong into `[coefficients]`")
        }
        None if SetUp::parse(name).is_some() => error.hint("set-up errors belong into `[set_up]`"),
        None if names.len() > 6 => error.hint(
            "coefficients are named as in the paper: E, one of X Y Z A B C, the axis X Y Z, and one of 0 1 2 3 b, such as `EXX1` or `EYYb`",
        ),
        None => error.hint(format!("set-up errors are `{}`", names.join("`, `"))),
    })
}
