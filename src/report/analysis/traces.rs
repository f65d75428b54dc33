//! Curves of the arcs, out of the identifications.

use nalgebra::Vector3;

use super::facts::Analysis;
use crate::align::{Circle, Part};
use crate::identify::{Apart, Identification, IdentifiedRun};
use crate::log::Log;

/// One arc of one run. The vectors run along the samples; rejected ones are left out.
#[derive(Debug)]
pub(super) struct Trace {
    /// Index of the repeat.
    pub(super) repeat: usize,
    /// Index of the run among those of the repeat.
    pub(super) run: usize,
    /// Its name.
    pub(super) run_name: String,
    /// Forward or backward.
    pub(super) forward: bool,
    /// When it was read, on the clock of the log, s.
    pub(super) log_s: Vec<f64>,
    /// Angle on the circle, rad, without jumps.
    pub(super) angle_rad: Vec<f64>,
    /// Reading without the set-up error, um.
    pub(super) measured_um: Vec<f64>,
    /// Prediction without the set-up error, um.
    pub(super) predicted_um: Vec<f64>,
    /// Residuals of the used samples: angle, rad, and residual, um.
    pub(super) residuals: Vec<(f64, f64)>,
    /// Indices at which a new piece begins, after a gap in the log.
    pub(super) breaks: Vec<usize>,
}

impl Trace {
    /// Pieces without a gap of the measured or the predicted curve.
    pub(super) fn pieces(&self, predicted: bool) -> Vec<Vec<(f64, f64)>> {
        let values = if predicted { &self.predicted_um } else { &self.measured_um };
        let all: Vec<(f64, f64)> =
            self.angle_rad.iter().copied().zip(values.iter().copied()).collect();
        let mut pieces = Vec::new();
        let mut from = 0;
        for &to in self.breaks.iter().chain(std::iter::once(&all.len())) {
            if to > from {
                pieces.push(all[from..to].to_vec());
            }
            from = to;
        }
        pieces
    }
}

/// A circle of a mounting and what was driven on it.
#[derive(Debug)]
pub(super) struct OnCircle {
    /// Its number, from 0, among all circles of the test.
    pub(super) number: usize,
    /// The circle.
    pub(super) circle: Circle,
    /// Index of the mounting.
    pub(super) mounting: usize,
    /// Its name, with that of the mounting where a test has several.
    pub(super) name: String,
    /// Nominal length of the bar, mm.
    pub(super) nominal_mm: f64,
    /// Its arcs, in the order of the repeats and of the program.
    pub(super) traces: Vec<Trace>,
}

impl OnCircle {
    /// Whether another one is the same in the same mounting.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.mounting == other.mounting && self.circle.is_same(&other.circle)
    }

    /// Whether anything was driven on its lower half.
    pub(super) fn whole(&self) -> bool {
        let lower = |angle: &f64| angle.sin() < -0.05;
        self.traces.iter().any(|trace| trace.angle_rad.iter().any(lower))
    }
}

/// All circles, mounting after mounting, each in the order in which they are first driven; the ways from
/// arc to arc are left out.
pub(super) fn circles(analysis: &Analysis, identifications: &[Identification]) -> Vec<OnCircle> {
    let mut circles: Vec<OnCircle> = Vec::new();
    for (repeat, identification) in identifications.iter().enumerate() {
        for (of_repeat, run) in identification.runs.iter().enumerate() {
            let set_up_um = set_up_um(analysis, identification, run);
            for (index, section) in run.alignment.sections.iter().enumerate() {
                if section.transit {
                    continue;
                }
                let mut trace = Trace {
                    repeat,
                    run: of_repeat,
                    run_name: run.name.clone(),
                    log_s: Vec::new(),
                    forward: section.forward,
                    angle_rad: Vec::new(),
                    measured_um: Vec::new(),
                    predicted_um: Vec::new(),
                    residuals: Vec::new(),
                    breaks: Vec::new(),
                };
                let mut last_s = f64::NEG_INFINITY;
                for record in &run.records {
                    let sample = &record.sample;
                    // What may be of the feed-in would be a spur beside the circle.
                    let on_arc = record.is_on_arc() || record.apart == Some(Apart::TimeUnknown);
                    if sample.part != Part::Arc(index)
                        || !on_arc
                        || record.rejected()
                        || !section.is_data(sample.program_s)
                    {
                        continue;
                    }
                    let ball = sample.pose.position_mm - run.alignment.coincidence_mm();
                    let angle_rad = unwound(
                        section.circle.angle_rad(&ball),
                        trace.angle_rad.last().copied(),
                        section.forward,
                    );
                    let off_um = set_up_um.dot(&ball) / ball.norm();
                    if sample.log_s - last_s > Log::GAP_PERIODS * run.alignment.sample_period_s
                        && !trace.angle_rad.is_empty()
                    {
                        trace.breaks.push(trace.angle_rad.len());
                    }
                    last_s = sample.log_s;
                    trace.log_s.push(sample.log_s);
                    trace.angle_rad.push(angle_rad);
                    trace.measured_um.push(sample.deviation_mm * 1e3 - off_um);
                    trace.predicted_um.push(record.computed_mm * 1e3 - off_um);
                    if record.used() {
                        trace.residuals.push((angle_rad, record.residual_mm * 1e3));
                    }
                }
                if trace.angle_rad.len() < 2 {
                    continue;
                }
                let same = |c: &&mut OnCircle| {
                    c.mounting == run.mounting && c.circle.is_same(&section.circle)
                };
                match circles.iter_mut().find(same) {
                    Some(circle) => circle.traces.push(trace),
                    None => circles.push(OnCircle {
                        number: 0,
                        circle: section.circle,
                        mounting: run.mounting,
                        name: analysis.in_mounting(&section.circle.name(), run.mounting),
                        nominal_mm: run.nominal_mm,
                        traces: vec![trace],
                    }),
                }
            }
        }
    }
    circles.sort_by_key(|circle| circle.mounting);
    circles.iter_mut().enumerate().for_each(|(number, circle)| circle.number = number);
    circles
}

/// What the two directions of an arc are called: users of planes know them as those of G03 and G02.
pub(super) fn ways(circles: &[OnCircle]) -> [&'static str; 2] {
    let plane = |circle: &OnCircle| matches!(circle.circle, Circle::Plane(_));
    let planes = !circles.is_empty() && circles.iter().all(plane);
    if planes { ["CCW", "CW"] } else { ["forward", "backward"] }
}

/// An angle continued from the one before it; the first one near its natural end of the circle.
fn unwound(angle_rad: f64, before: Option<f64>, forward: bool) -> f64 {
    use std::f64::consts::TAU;
    match before {
        Some(before) => before + (angle_rad - before + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU,
        // Forward arcs begin at or after 0, backward arcs end there: a hair below 0 is 0, not 360.
        None if forward && angle_rad > TAU - 0.1 => angle_rad - TAU,
        None => angle_rad,
    }
}

/// Set-up error of the balls of a run, tool minus workpiece, um; zero along an axis where it is not estimated or
/// not determined, because then it is not known what to take off.
fn set_up_um(
    analysis: &Analysis,
    identification: &Identification,
    run: &IdentifiedRun,
) -> Vector3<f64> {
    let mounting = analysis.test.mountings.get(run.mounting).map_or("", |m| m.name.as_str());
    let value = |ball: char, axis: char| {
        let bare = format!("E{axis}{ball}");
        let estimate = identification
            .estimate(&bare)
            .or_else(|| identification.estimate(&format!("{bare}@{mounting}")));
        estimate.map(|e| (e.value * 1e3, e.observed))
    };
    let axes = ['X', 'Y', 'Z'];
    // What is not determined along one axis says nothing of the others: a plane never tells its normal. Where the machine
    // is described at the place of the test, what was plausible decides, and a plane is never told the whole of a shift.
    let along = |axis: char| {
        let both = [value('t', axis), value('w', axis)];
        let determined = |(_, observed): &(f64, f64)| *observed >= super::cautions::DETERMINED;
        let known = analysis.is_local() || both.iter().flatten().all(determined);
        let [tool, workpiece] = both.map(|of| of.map_or(0.0, |(value, _)| value));
        if known { tool - workpiece } else { 0.0 }
    };
    Vector3::from(axes.map(along))
}

/// Whether the set-up errors are taken off the curves.
pub(super) fn set_up_taken_off(analysis: &Analysis, identifications: &[Identification]) -> bool {
    identifications.iter().any(|identification| {
        identification.runs.iter().any(|run| set_up_um(analysis, identification, run).norm() > 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;
    use std::f64::consts::TAU;

    #[test]
    fn angles_run_on_through_a_full_turn() {
        let mut angle = unwound(TAU - 0.01, None, true);
        assert!(angle < 0.0);
        for step in 0..800 {
            angle = unwound((f64::from(step) * 0.01).rem_euclid(TAU), Some(angle), true);
        }
        assert!((angle - 7.99).abs() < 1e-9);
    }

    #[test]
    fn every_circle_has_both_directions_of_every_repeat() {
        let fixture = fixture::identified("hu40t");
        let circles = circles(&fixture.analysis, &fixture.identifications);
        assert_eq!(circles.len(), 6);
        for circle in &circles {
            assert_eq!(circle.traces.len(), 10, "{}", circle.circle.name());
            assert_eq!(circle.whole(), circle.circle == Circle::Equator);
            for trace in &circle.traces {
                assert!(trace.angle_rad.windows(2).all(|a| (a[1] - a[0]).abs() < 0.1));
            }
        }
    }
}
