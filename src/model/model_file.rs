//! The model file: what a diagnosis has made of the model, for other commands to start from.
//!
//! ```toml
//! terms = ["EXX1", "EXt", "cyclic:on=EXX,period_mm=9.9999"]   # for identify, analyse, diagnose and plan
//! [coefficients]                                              # mm and rad, mean of the repeats: for simulate
//! EXX1 = -7.2e-6
//! [set_up]                                                    # mm
//! EXt = -0.0031
//! [[hide]]                                                    # what joined the model, with its numbers
//! cause = "cyclic"
//! on = "EXX"
//! amplitude_um = 1.201
//! period_mm = 9.9999
//! phase_rad = 0.703
//! [[curve]]                                                   # what is described and not explained
//! on = "EXX"
//! over = "position of X"                                      # see Variable
//! by_direction = false
//! knots = [-130.0, 0.0, 170.0]                                # in the unit of the variable
//! values = [0.0, 1.2e-3, 0.0]                                 # mm or rad
//! ```

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::coefficient::{Coefficient, SetUp};
use super::effect::Effect;
use super::seat::Seat;
use super::variable::{Empirical, Variable};
use crate::error::{Error, Result};
use crate::toml_text::{self, Text, short};

/// What a model file says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelFile {
    /// Terms to estimate, those of effects among them.
    pub terms: Vec<String>,
    /// Coefficients, mm and rad.
    pub coefficients: Vec<(String, f64)>,
    /// Set-up errors of the balls, mm.
    pub set_up: Vec<(String, f64)>,
    /// Effects with their numbers.
    pub effects: Vec<Effect>,
    /// Curves with their values at the knots, mm or rad.
    pub curves: Vec<(Empirical, Vec<f64>)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawModel {
    terms: Vec<String>,
    #[serde(default)]
    coefficients: BTreeMap<String, Spanned<f64>>,
    #[serde(default)]
    set_up: BTreeMap<String, Spanned<f64>>,
    #[serde(default)]
    hide: Vec<Spanned<toml::Table>>,
    #[serde(default)]
    curve: Vec<Spanned<RawCurve>>,
}

/// A curve as it stands in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCurve {
    on: String,
    over: String,
    #[serde(default)]
    by_direction: bool,
    knots: Vec<f64>,
    values: Vec<f64>,
}

/// Effects, and curves, of one machine: a diagnosis adds a dozen of each at the most.
const MOST_FOUND: usize = 100;

impl ModelFile {
    /// Reads and checks a model file.
    pub fn read(file: &Path) -> Result<Self> {
        Self::parse(&toml_text::read(file)?, file)
    }

    /// Checks the text of a model file; `file` is for messages.
    pub fn parse(source: &str, file: &Path) -> Result<Self> {
        let text = Text { source, file };
        let raw: RawModel = text.parse()?;
        for (count, beyond, what) in [
            (raw.hide.len(), raw.hide.get(MOST_FOUND).map(Spanned::span), "effects"),
            (raw.curve.len(), raw.curve.get(MOST_FOUND).map(Spanned::span), "curves"),
        ] {
            let hint = "take the model file as a diagnosis wrote it";
            text.at_most(count, MOST_FOUND, what, beyond, hint)?;
        }
        let effects = raw
            .hide
            .iter()
            .map(|table| effect(table.get_ref()).map_err(|e| e.at(text.place(table.span()))))
            .collect::<Result<_>>()?;
        let curves = raw
            .curve
            .into_iter()
            .map(|curve| {
                let place = text.place(curve.span());
                check_curve(curve.into_inner()).map_err(|error| error.at(place))
            })
            .collect::<Result<_>>()?;
        Ok(Self {
            terms: raw.terms,
            coefficients: named(
                raw.coefficients,
                |name| Coefficient::parse(name).is_some(),
                &text,
            )?,
            set_up: named(raw.set_up, |name| SetUp::parse(name).is_some(), &text)?,
            effects,
            curves,
        })
    }

    /// The file's text.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# The model with what a diagnosis has found: `--model` of simulate, identify, analyse, diagnose, plan.\n",
        );
        let _ = writeln!(text, "terms = [");
        for term in &self.terms {
            let _ = writeln!(text, "    {},", toml::Value::from(term.as_str()));
        }
        let _ = writeln!(text, "]");
        for (head, values) in
            [("[coefficients]  # mm, rad", &self.coefficients), ("[set_up]  # mm", &self.set_up)]
        {
            let _ = writeln!(text, "\n{head}");
            for (name, value) in values {
                let _ = writeln!(text, "{name} = {value:e}");
            }
        }
        for effect in &self.effects {
            let _ = writeln!(text, "\n[[hide]]\ncause = {:?}", effect.cause.id);
            if effect.seat != Seat::Whole {
                let _ = writeln!(text, "on = \"{}\"", effect.seat);
            }
            for (name, value) in effect.written() {
                let _ = writeln!(text, "{name} = {value:?}");
            }
        }
        for (curve, values) in &self.curves {
            let numbers = |values: &[f64]| {
                let each: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
                each.join(", ")
            };
            let _ = writeln!(
                text,
                "\n[[curve]]  # empirical: described, not explained\non = \"{}\"\nover = \"{}\"\nby_direction = {}\nknots = [{}]  # {}\nvalues = [{}]  # mm or rad",
                curve.seat,
                curve.variable,
                curve.with_sense,
                numbers(&curve.knots),
                curve.variable.unit(),
                numbers(values)
            );
        }
        text
    }
}

/// The effect of a table with `cause`, `on` and numbers.
fn effect(table: &toml::Table) -> Result<Effect> {
    let text = |key: &str| table.get(key).and_then(toml::Value::as_str);
    let Some(cause) = text("cause") else {
        return Err(Error::input("an effect does not say its `cause`")
            .hint("`ballbar reference causes` lists them"));
    };
    let mut numbers = Vec::new();
    for (key, value) in table.iter().filter(|(key, _)| *key != "cause" && *key != "on") {
        let number = value.as_float().or_else(|| value.as_integer().map(|n| n as f64));
        let number = number.ok_or_else(|| {
            Error::input(format!("`{key}` must be a number"))
                .hint("`ballbar reference causes` lists them")
        })?;
        numbers.push((key.as_str(), number));
    }
    Effect::of(cause, text("on"), &numbers)
}

/// No machine is so far off, mm or rad.
pub(crate) const LARGEST_ERROR: f64 = 1e3;
/// So large may what a curve runs over be, in the unit of its knots: the longest time constant in seconds.
const LARGEST_KNOT: f64 = 1e7;
/// A diagnosis describes a curve with some ten.
const MOST_KNOTS: usize = 1000;

/// Numbers by names that are known, each of which a machine could have.
fn named(
    raw: BTreeMap<String, Spanned<f64>>,
    known: impl Fn(&str) -> bool,
    text: &Text<'_>,
) -> Result<Vec<(String, f64)>> {
    let checked = |(name, value): (String, Spanned<f64>)| {
        if !known(&name) {
            return Err(Error::input(format!("unknown name `{}`", name.escape_debug()))
                .at(text.place(value.span()))
                .hint("take the file as `ballbar diagnose` has written it"));
        }
        text.within(&value, &name, -LARGEST_ERROR, LARGEST_ERROR).map(|value| (name, value))
    };
    raw.into_iter().map(checked).collect()
}

fn check_curve(raw: RawCurve) -> Result<(Empirical, Vec<f64>)> {
    let refuse = |what: String| {
        Error::input(what).hint("take the curve as `ballbar diagnose` has written it")
    };
    let seat = Seat::parse(&raw.on)
        .ok_or_else(|| refuse(format!("a curve cannot act on `{}`", raw.on)))?;
    let variable = Variable::parse(&raw.over)
        .ok_or_else(|| refuse(format!("a curve cannot run over `{}`", raw.over)))?;
    let ascending = raw.knots.windows(2).all(|pair| pair[0] < pair[1]);
    if raw.knots.len() < 2 || raw.values.len() != raw.knots.len() || !ascending {
        return Err(refuse(
            "a curve needs ascending `knots`, two at the least, and a value for each".into(),
        ));
    }
    if raw.knots.len() > MOST_KNOTS {
        return Err(refuse(format!("a curve has {MOST_KNOTS} knots at the most")));
    }
    for (key, numbers, largest) in
        [("knots", &raw.knots, LARGEST_KNOT), ("values", &raw.values, LARGEST_ERROR)]
    {
        if let Some(far) = numbers.iter().find(|number| !(-largest..=largest).contains(*number)) {
            let got = short(*far);
            return Err(refuse(format!(
                "`{key}` of a curve must lie between -{largest} and {largest}, got `{got}`"
            )));
        }
    }
    let curve = Empirical { seat, variable, with_sense: raw.by_direction, knots: raw.knots };
    Ok((curve, raw.values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Axis;

    #[test]
    fn what_no_machine_has_is_refused_with_its_place() {
        let begin = "terms = [\"EXX1\"]\n";
        let curve = "[[curve]]\non = \"EXX\"\nover = \"position of X\"\n";
        for (rest, told) in [
            ("[coefficients]\nEXX9 = 1e-6", "unknown name `EXX9`"),
            ("[coefficients]\nEXt = 1e-6", "unknown name `EXt`"),
            ("[set_up]\nEXX1 = 1e-6", "unknown name `EXX1`"),
            ("[set_up]\nEXt = 1e300", "`EXt` must lie between -1000 and 1000, got `1e300`"),
            (
                &format!("{curve}knots = [0, 1e300]\nvalues = [0, 1]"),
                "`knots` of a curve must lie between -10000000 and 10000000, got `1e300`",
            ),
            (
                &format!("{curve}knots = [0, 1]\nvalues = [0, nan]"),
                "`values` of a curve must lie between -1000 and 1000, got `NaN`",
            ),
        ] {
            let error = ModelFile::parse(&format!("{begin}{rest}"), "m.toml".as_ref()).unwrap_err();
            assert_eq!(error.what, told);
            assert!(error.hint.is_some() && error.place.is_some_and(|place| place.line > 1));
        }
    }

    #[test]
    fn more_effects_or_curves_than_a_machine_has_are_refused_with_the_first_too_many() {
        let hide = "[[hide]]\ncause = \"cyclic\"\n".repeat(101);
        let curve = "[[curve]]\non = \"EXX\"\nover = \"x\"\nknots = []\nvalues = []\n".repeat(101);
        for (rest, told, line) in
            [(hide, "101 effects, and 100", 202), (curve, "101 curves, and 100", 502)]
        {
            let text = format!("terms = []\n{rest}");
            let error = ModelFile::parse(&text, "m.toml".as_ref()).unwrap_err();
            assert!(error.what.contains(told) && error.hint.is_some(), "{}", error.what);
            assert_eq!(error.place.map(|place| place.line), Some(line));
        }
    }

    #[test]
    fn terms_of_any_characters_and_none_read_back() {
        let none = ModelFile::default();
        assert_eq!(ModelFile::parse(&none.to_toml(), "m.toml".as_ref()).unwrap(), none);
        let model =
            ModelFile { terms: vec!["a\u{202e}\u{1b}\"\\b".into()], ..ModelFile::default() };
        assert_eq!(ModelFile::parse(&model.to_toml(), "m.toml".as_ref()).unwrap(), model);
    }

    #[test]
    fn a_model_file_reads_back() {
        let curve = Empirical {
            seat: Seat::parse("EXX").unwrap(),
            variable: Variable::Velocity(Axis::Z),
            with_sense: true,
            knots: vec![-8.0, 0.5, 8.0],
        };
        let model = ModelFile {
            terms: vec!["EXX1".into(), "cyclic:on=EXX,period_mm=9.9999".into()],
            coefficients: vec![("EXX1".into(), -7.2e-6)],
            set_up: vec![("EXt".into(), 0.005)],
            effects: vec![
                Effect::parse("drift:on=EZt,amplitude_um=6,time_constant_s=500").unwrap(),
            ],
            curves: vec![(curve, vec![0.0, 1e-3, -2.5e-4])],
        };
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("model.toml");
        std::fs::write(&file, model.to_toml()).unwrap();
        assert_eq!(ModelFile::read(&file).unwrap(), model);
        std::fs::write(&file, model.to_toml().replace("velocity of Z", "mood of Z")).unwrap();
        let error = ModelFile::read(&file).unwrap_err();
        assert!(error.what.contains("mood of Z") && error.place.is_some());
    }
}
