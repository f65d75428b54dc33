//! What people ask of a machine, at the place of the test: scales, squarenesses, reversals, straightness, angles.
//!
//! With `e(h, b)` the displacement of the tool against the workpiece, along the programmed directions, that the
//! parameters `x` make, everything is asked along straight lines of the range `c ± r` of the test, the other slides
//! at `c`, `u = (h - c) / r`, and is taken through the exact chain; its derivatives are those where nothing errs, `a`.
//!
//! | asked | is |
//! | --- | --- |
//! | scale of H | slope of `e_H` along H: least squares over the line, mean of both senses |
//! | scale mismatch of H and I | scale of H less scale of I |
//! | squareness of H and I | slope of `e_I` along H plus slope of `e_H` along I: above 0, less than 90° between the positive directions |
//! | reversal of H | step of `e_H` from negative to positive motion |
//! | lateral play of H in I | the same step of `e_I` |
//! | straightness of H in I, positioning of H | range of `e_I` along H, of `e_H`, about its least-squares line |
//! | angle of H about I | range of the rotation of the slide H about I |
//! | angular reversal of H about I | step of that rotation from negative to positive motion |
//!
//! A range is linear about where its two ends are. `noise² = a' C a` with the covariance `C` by the noise;
//! `all² = noise² + |a' L|²`, where column `k` of `L` is what one plausible deviation of fault `k` does to the estimates.

use super::lines::{Lines, Row};
use crate::machine::Axis;
use crate::model::{Component, LocalFrame, Model, ParameterId};
use crate::solve::{Matrix, dot};

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Scale of an axis, mm/mm.
    Scale(Axis),
    /// Scale of an axis less that of another, mm/mm.
    ScaleMismatch(Axis, Axis),
    /// Squareness of two axes, mm/mm.
    Squareness(Axis, Axis),
    /// Reversal of an axis, mm.
    Reversal(Axis),
    /// Lateral play of an axis in the direction of another, mm.
    LateralPlay(Axis, Axis),
    /// Positioning error of an axis without its scale, mm.
    Positioning(Axis),
    /// Straightness of an axis in the direction of another, mm.
    Straightness(Axis, Axis),
    /// Rotation of a slide about a direction over the test, rad.
    Angle(Axis, Axis),
    /// Step of that rotation at a reversal, rad.
    AngularReversal(Axis, Axis),
}

/// An answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// What was asked.
    pub asked: Asked,
    /// The value, mm/mm, mm or rad.
    pub value: f64,
    /// Standard deviation by the noise: what repeats would scatter.
    pub noise: f64,
    /// Standard deviation by the noise and by what these runs cannot tell from other plausible faults; `None` where
    /// nothing was taken for plausible.
    pub all: Option<f64>,
    /// Standard deviation of what is plausible for it before anything is measured; `None` as above.
    pub plausible: Option<f64>,
    /// What would look the same, the most first: only what makes more than a tenth of what is open.
    pub alike: Vec<Suspect>,
    /// The part of `noise` that all repeats have in common, one number for each independent combination of the numbers
    /// of effects: their squares add up to its square.
    pub in_common: Vec<f64>,
}

/// Something that may look like what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suspect {
    /// A fault of the machine, or of its set-up.
    Fault(ParameterId),
    /// The control drives otherwise than planned.
    Control,
    /// An effect that nobody has explained has a part in it.
    Unexplained,
}

/// Faults that make less than this share of what is left open are not told.
const SHARE: f64 = 0.1;

impl Answer {
    /// The same, of which repeats scatter by so much: no one of them is known better.
    #[must_use]
    pub fn scattering(self, deviation: f64) -> Self {
        let noise = self.noise.max(deviation);
        let with = |all: f64| noise.hypot((all * all - self.noise * self.noise).max(0.0).sqrt());
        Self { all: self.all.map(with), noise, ..self }
    }

    /// Whether these runs leave so much more open than noise does that people should know.
    pub fn is_open(&self) -> bool {
        self.all.is_some_and(|all| all > OPEN * self.noise)
    }
}

/// Where more than this times the noise is left open, it is said.
pub const OPEN: f64 = 3.0;

/// A test that tells less than this share of what was plausible of something does not see it.
pub const SEEN: f64 = 0.1;

/// What is known of the parameters of a model.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// Their values, in the order of the model.
    pub values: &'a [f64],
    /// Their covariance by the noise.
    pub covariance: &'a Matrix,
    /// See [`Identification::left_open`](super::Identification::left_open).
    pub left_open: Option<&'a Matrix>,
    /// See [`Identification::unexplained`](super::Identification::unexplained).
    pub unexplained: usize,
    /// See [`Identification::effects`](super::Identification::effects).
    pub effects: Option<&'a Matrix>,
}

/// All that stands by itself of what can be asked of what moved, in the order of [`Asked`].
pub fn answers(model: &Model, frame: &LocalFrame, of: &Known) -> Vec<Answer> {
    let axes: Vec<Axis> =
        Axis::ALL.into_iter().filter(|axis| frame.reach_mm[axis.index()] > 0.0).collect();
    let others = |axis: Axis| axes.iter().copied().filter(move |other| *other != axis);
    let mut asked: Vec<Asked> = axes.iter().map(|axis| Asked::Scale(*axis)).collect();
    for (k, &first) in axes.iter().enumerate() {
        asked.extend(axes[k + 1..].iter().map(|second| Asked::Squareness(first, *second)));
    }
    asked.extend(axes.iter().map(|axis| Asked::Reversal(*axis)));
    for &axis in &axes {
        asked.extend(others(axis).map(|other| Asked::LateralPlay(axis, other)));
    }
    asked.extend(axes.iter().map(|axis| Asked::Positioning(*axis)));
    for &axis in &axes {
        asked.extend(others(axis).map(|other| Asked::Straightness(axis, other)));
    }
    for &axis in &axes {
        asked.extend(Axis::ALL.map(|about| Asked::Angle(axis, about)));
    }
    for &axis in &axes {
        asked.extend(Axis::ALL.map(|about| Asked::AngularReversal(axis, about)));
    }
    ask(model, frame, of, &asked)
}

/// Answers, in the order in which they are asked.
pub fn ask(model: &Model, frame: &LocalFrame, of: &Known, asked: &[Asked]) -> Vec<Answer> {
    let lines = Lines { model, frame, values: of.values };
    asked.iter().map(|asked| answer(*asked, &asked.row(&lines), model, of)).collect()
}

/// What an axis errs by in a direction along its line, about the least-squares line and in the mean of both senses: from
/// one end of the range to the other, mm.
pub fn bent(
    model: &Model,
    frame: &LocalFrame,
    values: &[f64],
    [axis, along]: [Axis; 2],
) -> Vec<[f64; 2]> {
    let lines = Lines { model, frame, values };
    let reach_mm = frame.reach_mm[axis.index()];
    let middle_mm = frame.middle_mm[axis.index()];
    let at = |(u, e): (f64, Row)| [middle_mm + u * reach_mm, e.all];
    lines.straightened(axis, along).into_iter().map(at).collect()
}

fn answer(asked: Asked, row: &Row, model: &Model, of: &Known) -> Answer {
    let weights = &row.by;
    let by_noise = of.covariance.times_vector(weights);
    let noise = dot(weights, &by_noise).max(0.0).sqrt();
    let open = of.left_open.map(|open| open.transposed().times_vector(weights));
    let square: f64 = open.iter().flatten().map(|o| o * o).sum();
    let mut alike: Vec<(usize, f64)> = open.iter().flatten().copied().enumerate().collect();
    alike.retain(|(_, o)| o * o > SHARE * square);
    alike.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let all = open.is_some().then(|| noise.hypot(square.sqrt()));
    let each = weights.iter().zip(model.parameters());
    let before = each.map(|(weight, parameter)| weight * parameter.plausible.unwrap_or(0.0));
    let plausible = open.is_some().then(|| before.map(|b| b * b).sum::<f64>().sqrt());
    let suspect = |&(k, _): &(usize, f64)| {
        let explained = of.left_open.map_or(0, Matrix::columns) - of.unexplained;
        match model.parameters().get(k) {
            Some(parameter) => Suspect::Fault(parameter.id),
            None if k < explained => Suspect::Control,
            None => Suspect::Unexplained,
        }
    };
    let alike = alike.iter().map(suspect).collect();
    let in_common = of.effects.map(|effects| effects.transposed().times_vector(weights));
    let in_common = in_common.unwrap_or_default();
    Answer { asked, value: row.all, noise, all, plausible, alike, in_common }
}

impl Asked {
    fn row(self, lines: &Lines) -> Row {
        match self {
            Self::Scale(axis) => lines.slope(axis, axis),
            Self::ScaleMismatch(first, second) => {
                lines.slope(first, first).plus(&lines.slope(second, second), -1.0)
            }
            Self::Squareness(first, second) => {
                lines.slope(first, second).plus(&lines.slope(second, first), 1.0)
            }
            Self::Reversal(axis) => lines.step(axis, axis),
            Self::LateralPlay(axis, other) => lines.step(axis, other),
            Self::Positioning(axis) => lines.range(axis, axis),
            Self::Straightness(axis, other) => lines.range(axis, other),
            Self::Angle(axis, about) => lines.angle(axis, about),
            Self::AngularReversal(axis, about) => lines.angular_step(axis, about),
        }
    }

    /// What it is called, such as `squareness XY`.
    pub fn name(self) -> String {
        match self {
            Self::Scale(axis) => format!("scale {axis}"),
            Self::ScaleMismatch(first, second) => format!("scale mismatch {first}{second}"),
            Self::Squareness(first, second) => format!("squareness {first}{second}"),
            Self::Reversal(axis) => format!("reversal {axis}"),
            Self::LateralPlay(axis, other) => format!("lateral play {axis} in {other}"),
            Self::Positioning(axis) => format!("positioning {axis}"),
            Self::Straightness(axis, other) => format!("straightness {axis} in {other}"),
            Self::Angle(axis, about) => format!("angle {}", function(axis, about)),
            Self::AngularReversal(axis, about) => format!("reversal {}", function(axis, about)),
        }
    }

    /// The unit that people use, and how many of it one mm/mm, mm or rad is.
    pub fn unit(self) -> (&'static str, f64) {
        match self {
            Self::Scale(_) | Self::ScaleMismatch(..) | Self::Squareness(..) => ("um/m", 1e6),
            Self::Angle(..) | Self::AngularReversal(..) => ("urad", 1e6),
            _ => ("um", 1e3),
        }
    }
}

/// The name of ISO 230-1 for a rotation of a slide, such as `EBX`.
fn function(axis: Axis, about: Axis) -> String {
    let component = [Component::A, Component::B, Component::C][about.index()];
    format!("E{}{axis}", component.letter())
}
