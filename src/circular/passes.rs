//! One way over an arc: its readings by angle.

use std::f64::consts::TAU;

use super::thresholds::{FEWEST, LARGEST, SHORTEST_RAD, WHOLE_RAD, WIDEST_GAP_RAD};
use crate::align::{Circle, Section};
use crate::identify::{IdentifiedRun, Record};

/// What was done to readings before a value was made of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter {
    /// A point is the mean of so many readings; 1 where nothing was done.
    pub readings: usize,
    /// Time of a point, s.
    pub period_s: f64,
}

/// One way over an arc.
#[derive(Debug, Clone)]
pub(super) struct Pass {
    pub(super) run: String,
    /// Index of the run.
    pub(super) run_index: usize,
    pub(super) name: String,
    pub(super) mounting: usize,
    pub(super) circle: Circle,
    pub(super) forward: bool,
    pub(super) direction: &'static str,
    pub(super) feed_mm_s: f64,
    pub(super) nominal_mm: f64,
    /// Where the data arc begins on the circle, rad.
    pub(super) start_rad: f64,
    /// Angle of the data arc, rad.
    pub(super) sweep_rad: f64,
    /// Middle of the data arc, rad.
    pub(super) middle_rad: f64,
    /// Which records of the run the readings are.
    pub(super) records: Vec<usize>,
    /// Angle on the circle of each reading, rad, from 0 to below a turn.
    pub(super) angle_rad: Vec<f64>,
    /// What was read, mm.
    pub(super) read_mm: Vec<f64>,
    /// What the fit computes for it, mm.
    pub(super) computed_mm: Vec<f64>,
    /// The largest angle on the arc without a reading, rad.
    pub(super) gap_rad: f64,
    /// Readings that the fit did not believe.
    pub(super) rejected: usize,
    pub(super) filter: Filter,
}

impl Pass {
    /// Whether it goes round, with readings all the way.
    pub(super) fn is_whole(&self) -> bool {
        self.sweep_rad > WHOLE_RAD && self.gap_rad < WIDEST_GAP_RAD
    }

    /// Such as `XY CCW of run1`.
    pub(super) fn words(&self) -> String {
        format!("{} of {}", self.name, self.run)
    }

    /// A section of a run, with the readings on it; in words why it has no circular deviation.
    pub(super) fn of(
        (run_index, run): (usize, &IdentifiedRun),
        index: usize,
        records: &[(usize, &Record)],
    ) -> Result<Self, &'static str> {
        let alignment = &run.alignment;
        let section = &alignment.sections[index];
        let mut pass = Self {
            run: run.name.clone(),
            run_index,
            name: section.name.clone(),
            mounting: run.mounting,
            circle: section.circle,
            forward: section.forward,
            direction: section.direction(),
            feed_mm_s: section.feed_mm_s,
            nominal_mm: run.nominal_mm,
            start_rad: 0.0,
            sweep_rad: 0.0,
            middle_rad: 0.0,
            records: Vec::new(),
            angle_rad: Vec::new(),
            read_mm: Vec::new(),
            computed_mm: Vec::new(),
            gap_rad: TAU,
            rejected: 0,
            filter: Filter {
                readings: alignment.averaged.max(1),
                period_s: alignment.sample_period_s,
            },
        };
        pass.driven(run, section)?;
        // A mean that reaches beyond the end of the arc is of the feed-in too.
        let half_s = if alignment.averaged > 1 { 0.5 * alignment.sample_period_s } else { 0.0 };
        for (number, record) in records {
            let sample = &record.sample;
            let whole = [-half_s, half_s].iter().all(|s| section.is_data(sample.program_s + s));
            if !whole || !record.is_on_arc() {
                continue;
            }
            if record.rejected() {
                pass.rejected += 1;
                continue;
            }
            let ball_mm = sample.pose.position_mm - alignment.coincidence_mm();
            pass.records.push(*number);
            pass.angle_rad.push(section.circle.angle_rad(&ball_mm));
            pass.read_mm.push(sample.deviation_mm);
            pass.computed_mm.push(record.computed_mm);
        }
        if pass.read_mm.len() < FEWEST {
            return Err("has too few readings");
        }
        pass.gap_rad = pass.gap();
        Ok(pass)
    }

    /// Where the data arc lies, as commanded.
    fn driven(&mut self, run: &IdentifiedRun, section: &Section) -> Result<(), &'static str> {
        let alignment = &run.alignment;
        let [begins_s, ends_s] = section.data_s;
        let balls_mm: Vec<_> = (0..=LOOKS)
            .map(|look| {
                // Not at its very ends, where the block before or after it has begun.
                let share = 1e-9 + (1.0 - 2e-9) * f64::from(look) / f64::from(LOOKS);
                let at_s = begins_s + share * (ends_s - begins_s);
                alignment.trajectory.at(at_s).position_mm - alignment.coincidence_mm()
            })
            .collect();
        if let Circle::Other { normal, .. } = &section.circle
            && balls_mm.iter().any(|ball| ball.dot(normal).abs() > LARGEST * ball.norm())
        {
            return Err("lies on a small circle, where the bar does not point along the radius");
        }
        let angles: Vec<f64> = balls_mm.iter().map(|ball| section.circle.angle_rad(ball)).collect();
        // A hair below a turn is its beginning.
        let start_rad = angles.first().copied().unwrap_or(0.0);
        self.start_rad = if TAU - start_rad < HAIR_RAD { 0.0 } else { start_rad };
        let turned = |two: &[f64]| (two[1] - two[0] + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        let swept: f64 = angles.windows(2).map(turned).sum();
        self.sweep_rad = swept.abs();
        self.middle_rad = (self.start_rad + 0.5 * swept).rem_euclid(TAU);
        if self.sweep_rad < SHORTEST_RAD { Err("is shorter than 90 degrees") } else { Ok(()) }
    }

    /// The largest angle between neighbouring readings, of a part of a circle without that outside of it.
    fn gap(&self) -> f64 {
        let begins_rad = self.middle_rad - 0.5 * self.sweep_rad;
        let mut along: Vec<f64> =
            self.angle_rad.iter().map(|angle| (angle - begins_rad).rem_euclid(TAU)).collect();
        along.sort_by(f64::total_cmp);
        let between = along.windows(2).map(|two| two[1] - two[0]).fold(0.0, f64::max);
        match (along.first(), along.last()) {
            (Some(first), Some(last)) if self.sweep_rad > WHOLE_RAD => {
                between.max(first + TAU - last)
            }
            _ => between,
        }
    }
}

/// Less than the last decimal of a program turns a start by, rad.
const HAIR_RAD: f64 = 1e-6;
/// So often the way over a data arc is looked at.
const LOOKS: u32 = 256;
