//! What people ask of a machine, at the place of the test: scales, squarenesses, reversals, straightness, angles.
//!
//! With `e(h, b)` the displacement of the tool against the workpiece, along the programmed directions, that the
//! parameters `x` make, everything is asked along straight lines of the range `c ± r` of the test, the other slides
//! at `c`, `u = (h - c) / r`, and is taken through the exact chain; its derivatives are those where nothing errs, `a`.
//!
//! | asked | is |
//! | --- | --- |
//! | scale of H | slope of `e_H` along H: least squares over the line, mean of both senses |
//! | squareness of H and I | slope of `e_I` along H plus slope of `e_H` along I: above 0, less than 90° between the positive directions |
//! | reversal of H | step of `e_H` from negative to positive motion |
//! | lateral play of H in I | the same step of `e_I` |
//! | straightness of H in I, positioning of H | range of `e_I` along H, of `e_H`, about its least-squares line |
//! | angle of H about I | range of the rotation of the slide H about I |
//! | angular reversal of H about I | step of that rotation from negative to positive motion |
//!
//! A range is linear about where its two ends are. `noise² = a' C a` with the covariance `C` by the noise;
//! `all² = noise² + |a' L|²`, where column `k` of `L` is what one plausible deviation of fault `k` does to the estimates.

use nalgebra::Vector3;

use crate::machine::{Axis, Mounting, Pose};
use crate::model::{Component, LocalFrame, Model, Motion, ParameterId};
use crate::solve::{Matrix, dot};

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Scale of an axis, mm/mm.
    Scale(Axis),
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
}

/// Points of a line: errors are cubics, and a range is looked for between the points.
const POINTS: i32 = 24;
/// A parameter is moved this far either way to see what it does, mm and rad.
const ASIDE: f64 = 1e-4;
/// Faults that make less than this share of what is left open are not told.
const SHARE: f64 = 0.1;

impl Answer {
    /// Whether these runs leave so much more open than noise does that people should know.
    pub fn is_open(&self) -> bool {
        self.all.is_some_and(|all| all > OPEN * self.noise)
    }
}

/// Where more than this times the noise is left open, it is said.
const OPEN: f64 = 3.0;

/// What is known of the parameters of a model.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// Their values, in the order of the model.
    pub values: &'a [f64],
    /// Their covariance by the noise.
    pub covariance: &'a Matrix,
    /// See [`Identification::left_open`](super::Identification::left_open).
    pub left_open: Option<&'a Matrix>,
    /// See [`Identification::effects`](super::Identification::effects).
    pub effects: Option<&'a Matrix>,
}

/// All that can be asked of what moved, in the order of [`Asked`].
pub fn answers(model: &Model, frame: &LocalFrame, of: &Known) -> Vec<Answer> {
    let lines = Lines { model, frame, values: of.values };
    let axes: Vec<Axis> =
        Axis::ALL.into_iter().filter(|axis| frame.reach_mm[axis.index()] > 0.0).collect();
    let others = |axis: Axis| axes.iter().copied().filter(move |other| *other != axis);
    let mut asked: Vec<(Asked, Row)> = Vec::new();
    for &axis in &axes {
        asked.push((Asked::Scale(axis), lines.slope(axis, axis)));
    }
    for (k, &first) in axes.iter().enumerate() {
        for &second in &axes[k + 1..] {
            let sum = lines.slope(first, second).plus(&lines.slope(second, first), 1.0);
            asked.push((Asked::Squareness(first, second), sum));
        }
    }
    for &axis in &axes {
        asked.push((Asked::Reversal(axis), lines.step(axis, axis)));
    }
    for &axis in &axes {
        asked.extend(others(axis).map(|o| (Asked::LateralPlay(axis, o), lines.step(axis, o))));
    }
    for &axis in &axes {
        asked.push((Asked::Positioning(axis), lines.range(axis, axis)));
    }
    for &axis in &axes {
        let straight = |o| (Asked::Straightness(axis, o), lines.range(axis, o));
        asked.extend(others(axis).map(straight));
    }
    for &axis in &axes {
        let angle = |o| (Asked::Angle(axis, o), lines.angle(axis, o));
        asked.extend(Axis::ALL.map(angle));
    }
    for &axis in &axes {
        let step = |o| (Asked::AngularReversal(axis, o), lines.angular_step(axis, o));
        asked.extend(Axis::ALL.map(step));
    }
    asked.into_iter().map(|(asked, row)| answer(asked, &row, model, of)).collect()
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
    let suspect = |&(k, _): &(usize, f64)| {
        let fault = model.parameters().get(k).map(|parameter| Suspect::Fault(parameter.id));
        fault.unwrap_or(Suspect::Control)
    };
    let alike = alike.iter().map(suspect).collect();
    let in_common = of.effects.map(|effects| effects.transposed().times_vector(weights));
    let in_common = in_common.unwrap_or_default();
    Answer { asked, value: row.all, noise, all, alike, in_common }
}

/// Something that is asked, or a displacement: what one of each parameter makes of it, and what all of them do.
#[derive(Debug, Clone)]
struct Row {
    by: Vec<f64>,
    all: f64,
}

impl Row {
    fn zero(count: usize) -> Self {
        Self { by: vec![0.0; count], all: 0.0 }
    }

    /// With so many times another.
    fn plus(mut self, of: &Self, factor: f64) -> Self {
        self.by.iter_mut().zip(&of.by).for_each(|(to, of)| *to += factor * of);
        self.all += factor * of.all;
        self
    }

    fn times(mut self, factor: f64) -> Self {
        self.by.iter_mut().for_each(|of| *of *= factor);
        self.all *= factor;
        self
    }
}

/// What the parameters do along the lines of a test.
struct Lines<'a> {
    model: &'a Model<'a>,
    frame: &'a LocalFrame,
    values: &'a [f64],
}

impl Lines<'_> {
    /// At `c` but for one slide, `u` of its range away, which has come there in a sense; the other senses are 0.
    fn pose(&self, axis: Axis, u: f64, sense: f64) -> Pose {
        let k = axis.index();
        let mut position_mm = self.frame.middle_mm;
        position_mm[k] += u * self.frame.reach_mm[k];
        Pose { position_mm, sense: sense * Vector3::ith(k, 1.0) }
    }

    /// Displacement at a pose. Effects that are held beside the parameters displace it whatever they are, and do not
    /// count.
    fn displaced(&self, pose: &Pose, along: Axis) -> Row {
        let direction = Vector3::ith(along.index(), 1.0);
        let at = self.model.situation_along(pose, &Motion::REST, 0, direction);
        let mut by = vec![0.0; self.values.len()];
        self.model.row(&at, &mut by);
        let nothing = vec![0.0; self.values.len()];
        let all = self.ball_mm(self.values, pose, along) - self.ball_mm(&nothing, pose, along);
        Row { by, all }
    }

    /// Where the tool is through the exact chain, seen from the point of the workpiece that it touches there, mm.
    fn ball_mm(&self, values: &[f64], pose: &Pose, along: Axis) -> f64 {
        let touching = Mounting { coincidence_mm: pose.position_mm, ..self.model.mountings()[0] };
        let errors = self.model.errors(values, pose, &Motion::REST, 0);
        let machine = self.model.machine();
        machine.ball_vector_mm(&touching, &pose.position_mm, &errors)[along.index()]
    }

    /// Its mean over both senses at every point of the line of an axis.
    fn line(&self, axis: Axis, along: Axis) -> Vec<(f64, Row)> {
        let at = |u: f64| {
            let [negative, positive] =
                [-1.0, 1.0].map(|sense| self.displaced(&self.pose(axis, u, sense), along));
            negative.plus(&positive, 1.0).times(0.5)
        };
        points().map(|u| (u, at(u))).collect()
    }

    /// Slope of the least-squares line: `3 / (2 r) ∫ e u du`.
    fn slope(&self, axis: Axis, along: Axis) -> Row {
        let reach_mm = self.frame.reach_mm[axis.index()];
        slope(&self.line(axis, along)).times(1.0 / reach_mm)
    }

    /// Its derivatives are those at the parameters as they are: a rotation that no length shows turns a play of 60 um.
    fn step(&self, axis: Axis, along: Axis) -> Row {
        let at =
            |values: &[f64], sense: f64| self.ball_mm(values, &self.pose(axis, 0.0, sense), along);
        let step = |values: &[f64]| at(values, 1.0) - at(values, -1.0);
        let mut beside = self.values.to_vec();
        let by = (0..beside.len()).map(|k| {
            let [less, more] = [-ASIDE, ASIDE].map(|aside| {
                beside[k] = self.values[k] + aside;
                step(&beside)
            });
            beside[k] = self.values[k];
            (more - less) / (2.0 * ASIDE)
        });
        let by = by.collect();
        Row { by, all: step(self.values) - step(&vec![0.0; self.values.len()]) }
    }

    /// What is farthest above less what is farthest below the least-squares line.
    fn range(&self, axis: Axis, along: Axis) -> Row {
        between_ends(self.line(axis, along), true)
    }

    fn angle(&self, axis: Axis, about: Axis) -> Row {
        let at = |u: f64| self.turned(&self.pose(axis, u, 0.0), axis, about);
        between_ends(points().map(|u| (u, at(u))).collect(), false)
    }

    fn angular_step(&self, axis: Axis, about: Axis) -> Row {
        let at = |sense: f64| self.turned(&self.pose(axis, 0.0, sense), axis, about);
        at(1.0).plus(&at(-1.0), -1.0)
    }

    /// Rotation of a slide about a direction at a pose: a sum over the parameters.
    fn turned(&self, pose: &Pose, axis: Axis, about: Axis) -> Row {
        let count = self.values.len();
        let mut unit = vec![0.0; count];
        let turned = |values: &[f64]| {
            let errors = self.model.errors(values, pose, &Motion::REST, 0);
            errors.slides[axis.index()].rotation_rad[about.index()]
        };
        let held = turned(&unit);
        let of = |k: usize| {
            unit[k] = 1.0;
            let change = turned(&unit) - held;
            unit[k] = 0.0;
            change
        };
        let by: Vec<f64> = (0..count).map(of).collect();
        Row { all: dot(&by, self.values), by }
    }
}

/// Points of a line from one end to the other.
fn points() -> impl Iterator<Item = f64> {
    (-POINTS..=POINTS).map(|k| f64::from(k) / f64::from(POINTS))
}

/// `3/2 ∫ e u du` over a line by Simpson's rule, which is exact for what is a cubic in `u` with an error of the
/// fourth power of the distance of the points else.
fn slope(line: &[(f64, Row)]) -> Row {
    let count = line.first().map_or(0, |(_, e)| e.by.len());
    let step = 1.0 / f64::from(POINTS);
    let mut sum = Row::zero(count);
    for (k, (u, e)) in line.iter().enumerate() {
        let weight = match k {
            0 => 1.0,
            k if k + 1 == line.len() => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        sum = sum.plus(e, 1.5 * weight * step / 3.0 * u);
    }
    sum
}

/// Difference of the two points where a curve is farthest above and below; about its least-squares line if it is to be
/// `straightened`.
fn between_ends(line: Vec<(f64, Row)>, straightened: bool) -> Row {
    let count = line.first().map_or(0, |(_, e)| e.by.len());
    let slope = if straightened { slope(&line) } else { Row::zero(count) };
    let ends: Vec<Row> = line.into_iter().map(|(u, e)| e.plus(&slope, -u)).collect();
    let highest = ends.iter().max_by(|a, b| a.all.total_cmp(&b.all));
    let lowest = ends.iter().min_by(|a, b| a.all.total_cmp(&b.all));
    match (highest, lowest) {
        (Some(highest), Some(lowest)) => highest.clone().plus(lowest, -1.0),
        _ => Row::zero(count),
    }
}

impl Asked {
    /// What it is called, such as `squareness XY`.
    pub fn name(self) -> String {
        match self {
            Self::Scale(axis) => format!("scale {axis}"),
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
            Self::Scale(_) | Self::Squareness(..) => ("um/m", 1e6),
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
