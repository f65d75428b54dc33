//! The error model as it stands in `analysis.json`.

use std::sync::Arc;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::bounds::{Checked, covariance, finite, least};
use super::error_model::{ErrorModel, Held};
use crate::identify;
use crate::machine::{Axis, Machine, Mounting, Pivot};
use crate::model::{Empirical, Form, HeldEffect, LocalFrame, Seat, Shape, Variable};
use crate::solve::Matrix;
use crate::toml_text::FARTHEST_MM;

/// Parameters at the most: 72 of the machine, three a mounting, and those of effects.
const MOST_PARAMETERS: usize = 600;
/// Mountings, terms, effects and knots at the most.
const MOST: usize = 1000;
/// Repeats of one test do not differ by more than this many times their noise: a metre, of a nanometre.
const MOST_TIMES: f64 = 1e9;
/// No parameter is larger, mm and rad.
const LARGEST: f64 = 1e3;

/// The error model as plain numbers; the schema is documented in `docs/analysis-schema.md`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    /// Middle of the test, machine coordinates, mm.
    middle_mm: [f64; 3],
    /// How far from there X, Y, Z went, mm.
    reach_mm: [f64; 3],
    /// Where each slide turns, as it was found.
    pivots: Vec<Pivot>,
    /// Where the balls were, as it was found.
    mountings: Vec<StoredMounting>,
    /// The terms.
    terms: Vec<String>,
    /// Their parameters.
    parameters: Vec<StoredParameter>,
    /// Covariance of the values by the noise: its lower triangle, row after row.
    noise_covariance: Vec<f64>,
    /// The same of what the test cannot tell from other plausible faults.
    open_covariance: Vec<f64>,
    /// The part of that by how the control may have driven; analyses from before it was told apart have none.
    #[serde(default)]
    driven_covariance: Vec<f64>,
    /// Effects beside the parameters.
    effects: Vec<StoredEffect>,
    /// By how many times their noise the repeats differ, where the machine changed between them.
    #[serde(default)]
    changed: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct StoredMounting {
    name: String,
    coincidence_mm: [f64; 3],
    tool_ball_mm: [f64; 3],
    bar_length_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct StoredParameter {
    name: String,
    /// In mm and rad.
    value: f64,
    /// Standard deviation of what was plausible for it, mm and rad.
    plausible: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct StoredEffect {
    /// A cause, as `simulate` and the terms name it; a curve has the four keys that follow.
    term: Option<String>,
    on: Option<String>,
    over: Option<String>,
    #[serde(default)]
    by_direction: bool,
    #[serde(default)]
    knots: Vec<f64>,
    /// mm and rad.
    amplitudes: Vec<f64>,
    /// Standard deviation of its size, as a share of it.
    uncertain: f64,
}

impl Stored {
    /// The numbers of a model.
    pub fn of(model: &ErrorModel) -> Self {
        let named = model.mountings.iter().zip(&model.bar_lengths_mm);
        let each = model.parameters.iter().zip(&model.values);
        Self {
            middle_mm: model.frame.middle_mm.into(),
            reach_mm: model.frame.reach_mm.into(),
            pivots: Axis::ALL.map(|axis| model.machine.slide(axis).pivot).into(),
            mountings: named
                .map(|((name, of), bar_length_mm)| StoredMounting {
                    name: name.clone(),
                    coincidence_mm: of.coincidence_mm.into(),
                    tool_ball_mm: of.tool_ball_mm.into(),
                    bar_length_mm: *bar_length_mm,
                })
                .collect(),
            terms: model.terms.clone(),
            parameters: each
                .map(|(parameter, value)| StoredParameter {
                    name: parameter.name.clone(),
                    value: value + 0.0,
                    plausible: parameter.plausible,
                })
                .collect(),
            noise_covariance: triangle(&model.noise),
            open_covariance: triangle(&model.open),
            driven_covariance: triangle(&model.driven),
            effects: model.held.iter().map(StoredEffect::of).collect(),
            changed: model.changed,
        }
    }

    /// The model of a machine, or why these numbers are none of it.
    pub(super) fn of_machine(&self, machine: Machine) -> Checked<ErrorModel> {
        let count = self.parameters.len();
        let lists = [self.pivots.len(), self.mountings.len(), self.terms.len(), self.effects.len()];
        if count == 0 || count > MOST_PARAMETERS || lists.iter().any(|of| *of > MOST) {
            return Err(format!(
                "it has no parameters, more than {MOST_PARAMETERS}, or a list of more than {MOST}"
            ));
        }
        let Ok(pivots) = <[Pivot; 3]>::try_from(self.pivots.as_slice()) else {
            return Err("it has not three `pivots`".into());
        };
        let turned = |machine: Machine, axis: Axis| machine.with_pivot(axis, pivots[axis.index()]);
        let machine = Axis::ALL.into_iter().fold(machine, turned);
        let (mut mountings, mut bar_lengths_mm) = (Vec::new(), Vec::new());
        for of in &self.mountings {
            let balls = Mounting {
                coincidence_mm: place(&of.coincidence_mm, "coincidence_mm")?,
                tool_ball_mm: place(&of.tool_ball_mm, "tool_ball_mm")?,
            };
            mountings.push((of.name.clone(), balls));
            bar_lengths_mm.push(least(of.bar_length_mm, FARTHEST_MM, "bar_length_mm")?);
        }
        let middle_mm = place(&self.middle_mm, "middle_mm")?;
        let reach_mm = place(&self.reach_mm, "reach_mm")?;
        let balls: Vec<Mounting> = mountings.iter().map(|(_, of)| *of).collect();
        let ends_mm = [middle_mm - reach_mm, middle_mm + reach_mm];
        let frame = LocalFrame::around(&machine, &balls, ends_mm.into_iter())
            .ok_or("it has no `mountings`")?;
        let apart = (frame.middle_mm - middle_mm).amax().max((frame.reach_mm - reach_mm).amax());
        if reach_mm.min() < 0.0 || apart > SAME_MM {
            return Err("`middle_mm` and `reach_mm` are not those of its mountings".into());
        }
        let frame = Arc::new(frame);
        let names: Vec<String> = mountings.iter().map(|(name, _)| name.clone()).collect();
        let terms = identify::terms(&self.terms, Some(&frame), &machine, &names)
            .map_err(|error| error.what.clone())?;
        let mut parameters: Vec<_> = terms.iter().flat_map(|term| term.parameters()).collect();
        let named = parameters.iter().zip(&self.parameters).all(|(own, of)| own.name == of.name);
        if !named || parameters.len() != count {
            return Err("its parameters are not those of its terms on this machine".into());
        }
        let mut values = Vec::new();
        for (own, of) in parameters.iter_mut().zip(&self.parameters) {
            values.push(finite(of.value, LARGEST, &of.name)?);
            own.plausible = match of.plausible {
                Some(sigma) => Some(least(sigma, LARGEST, &of.name)?),
                None => None,
            };
        }
        Ok(ErrorModel {
            machine,
            mountings,
            bar_lengths_mm,
            frame,
            terms: self.terms.clone(),
            parameters,
            values,
            noise: covariance(&self.noise_covariance, count, "noise_covariance")?,
            open: covariance(&self.open_covariance, count, "open_covariance")?,
            driven: match self.driven_covariance.as_slice() {
                [] => Matrix::zeros(count, count),
                driven => covariance(driven, count, "driven_covariance")?,
            },
            held: self.effects.iter().map(StoredEffect::checked).collect::<Checked<_>>()?,
            changed: match self.changed {
                Some(times) => Some(least(times, MOST_TIMES, "changed")?),
                None => None,
            },
        })
    }
}

/// Two places that differ by less were rounded, mm.
const SAME_MM: f64 = 1e-6;

impl StoredEffect {
    fn of(held: &Held) -> Self {
        let amplitudes = held.effect.amplitudes.clone();
        let none = Self {
            term: None,
            on: None,
            over: None,
            by_direction: false,
            knots: Vec::new(),
            amplitudes,
            uncertain: held.uncertain,
        };
        match &held.effect.form {
            Form::Cause(shape) => Self { term: Some(shape.term_name()), ..none },
            Form::Empirical(curve) => Self {
                on: Some(curve.seat.to_string()),
                over: Some(curve.variable.to_string()),
                by_direction: curve.with_sense,
                knots: curve.knots.clone(),
                ..none
            },
        }
    }

    fn checked(&self) -> Checked<Held> {
        let form = match &self.term {
            Some(term) => Form::Cause(Shape::parse(term).map_err(|error| error.what.clone())?),
            None => Form::Empirical(self.curve()?),
        };
        if self.amplitudes.len() != form.term().parameter_count() {
            return Err("an effect has not one of `amplitudes` for each of its numbers".into());
        }
        let amplitudes = self.amplitudes.iter().map(|a| finite(*a, LARGEST, "amplitudes"));
        let amplitudes = amplitudes.collect::<Checked<_>>()?;
        let effect = HeldEffect { form, amplitudes, run: None, earlier_s: 0.0 };
        Ok(Held { effect, uncertain: least(self.uncertain, 1.0, "uncertain")? })
    }

    fn curve(&self) -> Checked<Empirical> {
        let unknown = |what: &str| format!("an effect has no `term`, and no curve {what}");
        let seat = self.on.as_deref().and_then(Seat::parse).ok_or_else(|| unknown("`on`"))?;
        let variable =
            self.over.as_deref().and_then(Variable::parse).ok_or_else(|| unknown("`over`"))?;
        let ascending = self.knots.windows(2).all(|pair| pair[0] < pair[1]);
        let count = self.knots.len();
        if !ascending || !(2..=MOST).contains(&count) {
            return Err(format!("the `knots` of a curve must ascend, 2 to {MOST} of them"));
        }
        for knot in &self.knots {
            finite(*knot, FARTHEST_MM, "knots")?;
        }
        let (with_sense, knots) = (self.by_direction, self.knots.clone());
        Ok(Empirical { seat, variable, with_sense, knots })
    }
}

fn place(of: &[f64; 3], what: &str) -> Checked<Vector3<f64>> {
    for number in of {
        finite(*number, FARTHEST_MM, what)?;
    }
    Ok(Vector3::from(*of))
}

/// The lower triangle, row after row.
fn triangle(of: &Matrix) -> Vec<f64> {
    (0..of.rows()).flat_map(|i| of.row(i)[..=i].iter().map(|c| c + 0.0)).collect()
}
