//! The time map: from the instrument's clock to program time.

use super::ramp::Mark;
use crate::motion::{BlockKind, Trajectory};

/// From log time to program time: `program = (1 + rate) · log - offset[leg]`.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeMap {
    /// By how much the machine's clock runs faster than the instrument's, as a share of 1.
    pub rate: f64,
    /// Standard deviation of the rate.
    pub rate_sigma: f64,
    /// One a leg, s: the first leg ends at the first operator's pause.
    pub offsets_s: Vec<f64>,
    /// Standard deviation of each offset, s; infinite where no sample tells it.
    pub offset_sigmas_s: Vec<f64>,
    /// Covariance of each offset with the rate, s.
    pub offset_rate_covariances_s: Vec<f64>,
    /// Standard deviation that each offset has besides, because chords that look alike could be taken
    /// for each other, s.
    pub ambiguities_s: Vec<f64>,
    /// Share by which the real feed differs from the programmed one times the stated override.
    pub override_excess: f64,
    /// Standard deviation of that share; 0 where it was not estimated.
    pub override_sigma: f64,
    /// Program time of every operator's pause, s.
    stops_s: Vec<f64>,
    /// About this log time the rate turns, s: where offset and rate are least correlated.
    pub pivot_s: f64,
}

/// How long an operator's pause is where the log does not tell, s.
const UNKNOWN_S: f64 = 60.0;

/// A moment of the log in program time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Program time, s.
    pub program_s: f64,
    /// Index of the leg.
    pub leg: usize,
    /// Whether the machine stands in an operator's pause then.
    pub in_stop: bool,
}

impl TimeMap {
    /// A map with the rate 0 and unknown offsets.
    pub(super) fn new(trajectory: &Trajectory, pivot_s: f64) -> Self {
        let stops_s: Vec<f64> = trajectory
            .blocks()
            .iter()
            .filter(|block| block.kind == BlockKind::Stop)
            .map(|block| block.start_s)
            .collect();
        let legs = stops_s.len() + 1;
        Self {
            rate: 0.0,
            rate_sigma: 0.0,
            offsets_s: vec![0.0; legs],
            offset_sigmas_s: vec![f64::INFINITY; legs],
            offset_rate_covariances_s: vec![0.0; legs],
            ambiguities_s: vec![0.0; legs],
            override_excess: 0.0,
            override_sigma: 0.0,
            stops_s,
            pivot_s,
        }
    }

    /// The leg that a program time lies in; at a pause, the leg after it.
    pub fn leg_of(&self, program_s: f64) -> usize {
        self.stops_s.partition_point(|stop| *stop <= program_s)
    }

    /// Program time of a log time on one leg, s, wherever the leg's bounds are.
    pub fn on_leg_s(&self, log_s: f64, leg: usize) -> f64 {
        log_s + self.rate * (log_s - self.pivot_s) - self.offsets_s[leg]
    }

    /// Rate and offsets by weighted least squares from the marks, with the rate's prior
    /// `0 ± clock_tolerance`.
    pub(super) fn fit_marks(&mut self, marks: &[Mark], clock_tolerance: f64) {
        let legs = self.offsets_s.len();
        let mut sums = vec![(0.0, 0.0, 0.0); legs];
        for mark in marks {
            let weight = mark.sigma_s.powi(-2);
            let sum = &mut sums[self.leg_of(mark.program_s)];
            sum.0 += weight;
            sum.1 += weight * (mark.log_s - self.pivot_s);
            sum.2 += weight * (mark.log_s - mark.program_s);
        }
        let mut normal = clock_tolerance.powi(-2);
        let mut right = 0.0;
        for mark in marks {
            let sum = sums[self.leg_of(mark.program_s)];
            let weight = mark.sigma_s.powi(-2);
            let time = mark.log_s - self.pivot_s - sum.1 / sum.0;
            let longer = mark.log_s - mark.program_s - sum.2 / sum.0;
            normal += weight * time * time;
            right -= weight * time * longer;
        }
        self.rate = right / normal;
        self.rate_sigma = normal.sqrt().recip();
        for (leg, sum) in sums.iter().enumerate() {
            if sum.0 > 0.0 {
                let time = sum.1 / sum.0;
                self.offsets_s[leg] = sum.2 / sum.0 + self.rate * time;
                self.offset_sigmas_s[leg] = sum.0.sqrt().recip().hypot(self.rate_sigma * time);
                self.offset_rate_covariances_s[leg] = self.rate_sigma.powi(2) * time;
            }
        }
    }

    /// The same map with the rate 0, every leg set by its first mark.
    pub(super) fn at_equal_rates(&self, marks: &[Mark]) -> Self {
        let mut map = Self { rate: 0.0, ..self.clone() };
        for mark in marks.iter().rev() {
            let leg = map.leg_of(mark.program_s);
            map.offsets_s[leg] = mark.log_s - mark.program_s;
        }
        map
    }

    /// Standard deviation of the program time of a log time on a leg, s.
    pub fn sigma_s(&self, log_s: f64, leg: usize) -> f64 {
        let offset = self.offset_sigmas_s[leg];
        if offset.is_infinite() {
            return offset;
        }
        let time_s = log_s - self.pivot_s;
        let mixed = 2.0 * time_s * self.offset_rate_covariances_s[leg];
        let straight = offset * offset + (self.rate_sigma * time_s).powi(2) - mixed;
        straight.max(0.0).sqrt().hypot(self.ambiguities_s[leg])
    }

    /// The moment of a log time.
    pub fn at(&self, log_s: f64) -> Moment {
        // Legs follow each other in log time as well, because no pause is shorter than nothing.
        for (leg, stop_s) in self.stops_s.iter().enumerate() {
            let program_s = self.on_leg_s(log_s, leg);
            if self.offset_sigmas_s[leg].is_finite() && program_s < *stop_s {
                return Moment { program_s, leg, in_stop: false };
            }
            let after_s = self.on_leg_s(log_s, leg + 1);
            let next_known = self.offset_sigmas_s[leg + 1].is_finite();
            if next_known && after_s < *stop_s {
                return Moment { program_s: *stop_s, leg: leg + 1, in_stop: true };
            }
        }
        let leg = self.stops_s.len();
        match self.stops_s.last() {
            // Nothing tells when the last leg began: the machine still stands, as far as is known.
            Some(&program_s) if self.offset_sigmas_s[leg].is_infinite() => {
                Moment { program_s, leg, in_stop: true }
            }
            _ => Moment { program_s: self.on_leg_s(log_s, leg), leg, in_stop: false },
        }
    }

    /// How long each operator's pause was, s; `None` where a neighbouring leg has no samples.
    pub fn pauses_s(&self) -> Vec<Option<f64>> {
        let known = |leg: usize| self.offset_sigmas_s[leg].is_finite().then(|| self.offsets_s[leg]);
        (0..self.stops_s.len()).map(|stop| Some(known(stop + 1)? - known(stop)?)).collect()
    }

    /// Log time at which a leg reaches a program time, s.
    pub fn log_time_s(&self, program_s: f64, leg: usize) -> f64 {
        (program_s + self.offsets_s[leg] + self.rate * self.pivot_s) / (1.0 + self.rate)
    }

    /// When the program began, and its standard deviation, on the log's clock that begins at `first_s`, s.
    ///
    /// Before an operator's pause of unknown length no reading may tell: then it began after the log did
    /// and not later than if the pause had been none, anywhere between.
    pub(super) fn began(&self, first_s: f64) -> (f64, f64) {
        let known = self.offset_sigmas_s.iter().position(|sigma| sigma.is_finite()).unwrap_or(0);
        if known == 0 {
            return (self.log_time_s(0.0, 0), self.offset_sigmas_s[0].min(UNKNOWN_S));
        }
        let latest_s = self.log_time_s(0.0, known);
        let earliest_s = if first_s < latest_s { first_s } else { latest_s - UNKNOWN_S };
        (0.5 * (earliest_s + latest_s), (latest_s - earliest_s) / 12f64.sqrt())
    }

    /// Program time of every operator's pause, s.
    pub fn stops_s(&self) -> &[f64] {
        &self.stops_s
    }
}
