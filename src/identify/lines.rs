//! What the parameters of a model do along the straight lines of a test, through the exact chain.

use nalgebra::Vector3;

use crate::machine::{Axis, Mounting, Pose};
use crate::model::{LocalFrame, Model, Motion};
use crate::solve::dot;

/// Points of a line: errors are cubics, and a range is looked for between the points.
const POINTS: i32 = 24;
/// A parameter is moved this far either way to see what it does, mm and rad.
const ASIDE: f64 = 1e-4;

/// Something that is asked, or a displacement: what one of each parameter makes of it, and what all of them do.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) by: Vec<f64>,
    pub(super) all: f64,
}

impl Row {
    fn zero(count: usize) -> Self {
        Self { by: vec![0.0; count], all: 0.0 }
    }

    /// With so many times another.
    pub(super) fn plus(mut self, of: &Self, factor: f64) -> Self {
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
pub(super) struct Lines<'a> {
    pub(super) model: &'a Model<'a>,
    pub(super) frame: &'a LocalFrame,
    pub(super) values: &'a [f64],
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

    fn ball_mm(&self, values: &[f64], pose: &Pose, along: Axis) -> f64 {
        displaced_mm(self.model, values, pose)[along.index()]
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
    pub(super) fn slope(&self, axis: Axis, along: Axis) -> Row {
        let reach_mm = self.frame.reach_mm[axis.index()];
        slope(&self.line(axis, along)).times(1.0 / reach_mm)
    }

    /// Its derivatives are those at the parameters as they are: a rotation that no length shows turns a play of 60 um.
    pub(super) fn step(&self, axis: Axis, along: Axis) -> Row {
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
    pub(super) fn range(&self, axis: Axis, along: Axis) -> Row {
        between_ends(self.straightened(axis, along))
    }

    /// The line about its least-squares line.
    pub(super) fn straightened(&self, axis: Axis, along: Axis) -> Vec<(f64, Row)> {
        let line = self.line(axis, along);
        let slope = slope(&line);
        line.into_iter().map(|(u, e)| (u, e.plus(&slope, -u))).collect()
    }

    pub(super) fn angle(&self, axis: Axis, about: Axis) -> Row {
        let at = |u: f64| self.turned(&self.pose(axis, u, 0.0), axis, about);
        between_ends(points().map(|u| (u, at(u))).collect())
    }

    pub(super) fn angular_step(&self, axis: Axis, about: Axis) -> Row {
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

/// Where the tool is at rest through the exact chain, seen from the point of the workpiece that it touches there, mm; effects
/// that are held beside the parameters count.
pub fn displaced_mm(model: &Model, values: &[f64], pose: &Pose) -> Vector3<f64> {
    let touching = Mounting { coincidence_mm: pose.position_mm, ..model.mountings()[0] };
    let errors = model.errors(values, pose, &Motion::REST, 0);
    model.machine().ball_vector_mm(&touching, &pose.position_mm, &errors)
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

/// Difference of the two points where a curve is farthest above and below.
fn between_ends(line: Vec<(f64, Row)>) -> Row {
    let count = line.first().map_or(0, |(_, e)| e.by.len());
    let ends: Vec<Row> = line.into_iter().map(|(_, e)| e).collect();
    let highest = ends.iter().max_by(|a, b| a.all.total_cmp(&b.all));
    let lowest = ends.iter().min_by(|a, b| a.all.total_cmp(&b.all));
    match (highest, lowest) {
        (Some(highest), Some(lowest)) => highest.clone().plus(lowest, -1.0),
        _ => Row::zero(count),
    }
}
