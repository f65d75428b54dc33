//! The time map: from the instrument's clock to program time.
//!
//! Inside a *leg*, a part of the program that the machine drives without standing still, the map is straight. Between
//! two legs it stands: an operator lets it stand as long as he likes, and a dwell or a sharp corner takes a little
//! longer than the program says, because the control waits until its axes have arrived.

use std::ops::Range;

use nalgebra::Vector3;

use super::breaks::{Break, breaks, chords_s, middles_s};
use super::leg_chords::LegChords;
use super::ramp::{Mark, UNEQUAL_DELAY_S};
use crate::error::Result;
use crate::motion::Trajectory;
use crate::solve::{Truncation, Tsqr, solve, standard_deviations};

/// From log time to program time: with `raw = (1 + rate) · log - offset[leg]`,
/// `program = raw + pace · (raw - middle of the leg)`.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeMap {
    /// By how much the machine's clock runs faster than the instrument's, as a share of 1.
    pub rate: f64,
    /// Standard deviation of the rate.
    pub rate_sigma: f64,
    /// One a leg, s.
    pub offsets_s: Vec<f64>,
    /// Standard deviation of each offset, s; infinite where no sample tells it.
    pub offset_sigmas_s: Vec<f64>,
    /// Covariance of each offset with the rate, s.
    pub offset_rate_covariances_s: Vec<f64>,
    /// The chords of each leg.
    pub chords: Vec<LegChords>,
    /// By how much the machine drives faster than this feed, as a share of 1; standstills have their own time.
    pub pace: f64,
    /// Standard deviation of the pace.
    pub pace_sigma: f64,
    /// How far the pace plausibly is from the feed that engagement and release tell.
    pub pace_plausible: f64,
    /// Where the pace is held, instead of being looked for.
    pub pace_held: Option<f64>,
    /// Covariance of each offset with the pace, s.
    pub offset_pace_covariances_s: Vec<f64>,
    /// Covariance of rate and pace.
    pub rate_pace_covariance: f64,
    /// Time constant with which all slides follow the program alike, s: `T dx/dt = commanded - x`. That they do so late
    /// is in the offsets; what it does beside is to smooth the path and to shrink radii.
    pub following_s: f64,
    /// Standard deviation of that, s.
    pub following_sigma_s: f64,
    /// By how much the path that is driven lies outside of the one that the blocks describe, mm.
    pub cut_mm: f64,
    /// By which share the control rounds the corners of chords out: 0 drives each to its end, 1 goes the mean over one. What is
    /// estimated may be a little less than none or more than all.
    pub rounded: f64,
    /// Standard deviation of that.
    pub rounded_sigma: f64,
    /// By which share corners are rounded out at which slides turn: `rounded` where the fit was told it by its last step, else 0. A slide
    /// that comes to stand on a chord that does not move it turns half a chord sooner, however little of its corner is rounded out.
    pub turns_rounded: f64,
    /// How much later than the mean of those that move each slide follows, s.
    pub delays_s: Vector3<f64>,
    /// Standard deviation of that, s.
    pub delay_sigmas_s: Vector3<f64>,
    /// By which share of `following_s` the time constant of each slide is longer; that it is late by it is in `delays_s`.
    pub longer: Vector3<f64>,
    /// Share by which the real feed differs from the programmed one times the stated override.
    pub override_excess: f64,
    /// Standard deviation of that share; 0 where it was not estimated.
    pub override_sigma: f64,
    /// What a standstill takes beyond what the program says, on average, and how much that plausibly differs, s.
    pub excess_s: [f64; 2],
    /// Where one leg ends and the next begins.
    breaks: Vec<Break>,
    /// The middle of each leg, s of program time: there the pace changes nothing.
    middles_s: Vec<f64>,
    /// About this log time the rate turns, s: where offset and rate are least correlated.
    pub pivot_s: f64,
}

/// What a standstill takes beyond what the program says plausibly is within this, s: in-position checks, and a control
/// that brakes later or softer than its settings say.
pub(super) const EXCESS_S: f64 = 0.05;
/// And on average not longer than this, s.
const LONGEST_EXCESS_S: f64 = 0.1;
/// So far a control's feed plausibly is from its program's where nothing else says so: ramps that it drives otherwise.
const PACE: f64 = 1e-3;
/// Where the pace is known.
pub(super) const NO_PACE: f64 = 1e-9;

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
    /// A map with the rate 0 and unknown offsets; the machine stands still between engagements and in them.
    pub(super) fn new(trajectory: &Trajectory, engaged_s: Range<f64>, pivot_s: f64) -> Self {
        let breaks = breaks(trajectory, &engaged_s);
        let legs = breaks.len() + 1;
        Self {
            rate: 0.0,
            rate_sigma: 0.0,
            offsets_s: vec![0.0; legs],
            offset_sigmas_s: vec![f64::INFINITY; legs],
            offset_rate_covariances_s: vec![0.0; legs],
            pace: 0.0,
            pace_sigma: 0.0,
            pace_plausible: if trajectory.recorded_pauses_s().is_some() { NO_PACE } else { PACE },
            pace_held: None,
            offset_pace_covariances_s: vec![0.0; legs],
            rate_pace_covariance: 0.0,
            following_s: 0.0,
            following_sigma_s: 0.0,
            cut_mm: 0.0,
            rounded: 0.0,
            rounded_sigma: 0.0,
            turns_rounded: 0.0,
            delays_s: Vector3::zeros(),
            delay_sigmas_s: Vector3::zeros(),
            longer: Vector3::zeros(),
            middles_s: middles_s(&breaks, trajectory),
            chords: chords_s(&breaks, trajectory).into_iter().map(LegChords::that_last).collect(),
            override_excess: 0.0,
            override_sigma: 0.0,
            excess_s: [0.0, EXCESS_S],
            breaks,
            pivot_s,
        }
    }

    /// By how much longer than the one that they share the time constant of each slide is, s.
    pub fn unlike_s(&self) -> Vector3<f64> {
        self.following_s * self.longer
    }

    /// The leg that a program time lies in; at a break, the leg after it.
    pub fn leg_of(&self, program_s: f64) -> usize {
        self.breaks.partition_point(|at| at.program_s <= program_s)
    }

    /// How many operator's pauses there are before a leg.
    pub fn pauses_before(&self, leg: usize) -> usize {
        self.breaks[..leg].iter().filter(|at| at.operator).count()
    }

    /// Whether no operator's pause lies between two legs: then their offsets differ by little.
    pub fn hang_together(&self, first: usize, second: usize) -> bool {
        let between = first.min(second)..first.max(second);
        self.breaks[between].iter().all(|at| !at.operator)
    }

    /// By how much the offsets of two legs that hang together plausibly differ, and within what, s.
    pub fn stands_s(&self, first: usize, second: usize) -> [f64; 2] {
        let standstills = first.abs_diff(second) as f64;
        let [mean_s, sigma_s] = self.excess_s;
        [standstills * mean_s, standstills.sqrt() * sigma_s]
    }

    /// Program time of a log time on one leg, s, wherever the leg's bounds are.
    pub fn on_leg_s(&self, log_s: f64, leg: usize) -> f64 {
        let raw_s = self.raw_s(log_s, leg);
        raw_s + self.pace * (raw_s - self.middles_s[leg])
    }

    fn raw_s(&self, log_s: f64, leg: usize) -> f64 {
        log_s + self.rate * (log_s - self.pivot_s) - self.offsets_s[leg]
    }

    /// How far a log time lies from the middle of a leg, s: `d program / d pace`.
    pub fn from_middle_s(&self, log_s: f64, leg: usize) -> f64 {
        self.raw_s(log_s, leg) - self.middles_s[leg]
    }

    /// Rate, pace and offsets by least squares from the marks, with the rate's prior `0 ± clock_tolerance` and legs that
    /// hang together; those that no mark tells of stay unknown.
    ///
    /// No standstill is shorter than its program: all take what the marks leave for them, and where that is next to
    /// nothing, each takes next to nothing. What they may take may be the feed's as well, and the other way round: where
    /// the feed itself was found from these marks (`any_feed`), standstills may take anything that is plausible.
    pub(super) fn fit_marks(
        &mut self,
        marks: &[Mark],
        clock_tolerance: f64,
        any_feed: bool,
    ) -> Result<()> {
        self.excess_s = [0.0, EXCESS_S];
        self.fit_standing(marks, clock_tolerance, NO_PACE)?;
        let marked = |at: &Mark| self.leg_of(at.program_s);
        let spans =
            marks.windows(2).map(|two| (&two[0], &two[1], marked(&two[0])..marked(&two[1])));
        let (mut standstills, mut longer_s, mut lasts_s) = (0.0, 0.0, 0.0);
        for (first, second, legs) in spans {
            if legs.start < legs.end && self.hang_together(legs.start, legs.end) {
                standstills += (legs.end - legs.start) as f64;
                lasts_s += second.log_s - first.log_s;
                longer_s += second.log_s - first.log_s - (second.program_s - first.program_s);
            }
        }
        if standstills > 0.0 {
            let mean_s = longer_s / standstills;
            let clock_s = clock_tolerance * lasts_s / standstills;
            // What the clock and the ramps leave open.
            let open_s = clock_s + UNEQUAL_DELAY_S;
            let of_feed_s = if any_feed {
                EXCESS_S
            } else if (-open_s..LONGEST_EXCESS_S).contains(&mean_s) {
                // As different as they are long.
                let mean_s = mean_s.max(0.0);
                self.excess_s = [mean_s, (mean_s + open_s).min(EXCESS_S)];
                if mean_s < open_s { 0.0 } else { mean_s }
            } else {
                // No standstill explains that: it is the feed, or readings are missing.
                self.excess_s = [0.0, open_s.min(EXCESS_S)];
                0.0
            };
            let of_feed = of_feed_s * standstills / lasts_s.max(f64::EPSILON);
            self.pace_plausible = PACE.hypot(of_feed);
            // Durations that agree say that neither is otherwise.
            self.fit_standing(marks, clock_tolerance, of_feed.max(NO_PACE))?;
        }
        Ok(())
    }

    /// Log times that are program times: each leg is known as well as the angle of its arc, and one says nothing of the
    /// next.
    pub(super) fn set_by_angle(&mut self, marks: &[Mark]) {
        for mark in marks {
            let leg = self.leg_of(mark.program_s);
            self.offset_sigmas_s[leg] = mark.sigma_s;
            self.excess_s[1] = self.excess_s[1].max(2.0 * mark.sigma_s);
        }
    }

    /// Rate and offsets from the marks alone, whatever clock and feed are, with each standstill within this of the program's, s.
    pub(super) fn fit_marks_at_any_rate(&mut self, marks: &[Mark], standing_s: f64) -> Result<()> {
        self.excess_s = [0.0, standing_s];
        self.fit_standing(marks, 1.0, NO_PACE)
    }

    /// The clock's rate and the pace are 0 within these.
    fn fit_standing(
        &mut self,
        marks: &[Mark],
        clock_tolerance: f64,
        pace_sigma: f64,
    ) -> Result<()> {
        let legs = self.offsets_s.len();
        let (rate, pace) = (legs, legs + 1);
        let mut rows = Tsqr::new(legs + 2);
        let mut row = vec![0.0; legs + 2];
        for mark in marks {
            let leg = self.leg_of(mark.program_s);
            row.fill(0.0);
            row[leg] = 1.0;
            row[rate] = self.pivot_s - mark.log_s;
            row[pace] = self.middles_s[leg] - mark.program_s;
            rows.push_weighted(&row, mark.log_s - mark.program_s, 1.0 / mark.sigma_s);
        }
        for second in 1..legs {
            if self.hang_together(second - 1, second) {
                row.fill(0.0);
                (row[second - 1], row[second]) = (-1.0, 1.0);
                let [mean_s, sigma_s] = self.excess_s;
                rows.push_weighted(&row, mean_s, 1.0 / sigma_s);
            }
        }
        rows.push_prior(rate, 0.0, clock_tolerance);
        rows.push_prior(pace, 0.0, pace_sigma);
        let solution = solve(&rows.finish()?, Truncation::Relative(1e-12))?;
        let covariance = solution.covariance_unscaled();
        let sigmas = standard_deviations(&covariance);
        self.rate = solution.x()[rate];
        self.rate_sigma = sigmas[rate];
        self.pace = solution.x()[pace];
        self.pace_sigma = sigmas[pace];
        self.rate_pace_covariance = covariance[(rate, pace)];
        let marked: Vec<usize> = marks.iter().map(|mark| self.leg_of(mark.program_s)).collect();
        for leg in 0..legs {
            if marked.iter().any(|&other| self.hang_together(leg, other)) {
                self.offsets_s[leg] = solution.x()[leg];
                self.offset_sigmas_s[leg] = sigmas[leg];
                self.offset_rate_covariances_s[leg] = covariance[(leg, rate)];
                self.offset_pace_covariances_s[leg] = covariance[(leg, pace)];
            }
        }
        Ok(())
    }

    /// The same map with the rate 0, every leg set by the first mark of those that it hangs together with.
    pub(super) fn at_equal_rates(&self, marks: &[Mark]) -> Self {
        let mut map = Self { rate: 0.0, pace: 0.0, ..self.clone() };
        for mark in marks.iter().rev() {
            let marked = map.leg_of(mark.program_s);
            for leg in 0..map.offsets_s.len() {
                if map.hang_together(leg, marked) {
                    map.offsets_s[leg] = mark.log_s - mark.program_s;
                }
            }
        }
        map
    }

    /// Standard deviation of the program time of a log time on a leg, s.
    pub fn sigma_s(&self, log_s: f64, leg: usize) -> f64 {
        let offset = self.offset_sigmas_s[leg];
        if offset.is_infinite() {
            return offset;
        }
        // d program = - d offset + time d rate + from_middle d pace
        let (time_s, from_middle_s) = (log_s - self.pivot_s, self.from_middle_s(log_s, leg));
        let own = offset.powi(2)
            + (self.rate_sigma * time_s).powi(2)
            + (self.pace_sigma * from_middle_s).powi(2);
        let mixed = time_s * from_middle_s * self.rate_pace_covariance
            - time_s * self.offset_rate_covariances_s[leg]
            - from_middle_s * self.offset_pace_covariances_s[leg];
        let straight = own + 2.0 * mixed;
        straight.max(0.0).sqrt().hypot(self.chords[leg].ambiguity_s)
    }

    /// The moment of a log time.
    pub fn at(&self, log_s: f64) -> Moment {
        // Legs follow each other in log time as well, because no pause is shorter than nothing.
        for (leg, at) in self.breaks.iter().enumerate() {
            let program_s = self.on_leg_s(log_s, leg);
            let after_s = self.on_leg_s(log_s, leg + 1);
            let next_known = self.offset_sigmas_s[leg + 1].is_finite();
            // By both the machine moves: the better known one is believed.
            let overtaken = program_s < at.since_s
                && after_s >= at.program_s
                && self.offset_sigmas_s[leg + 1] < self.offset_sigmas_s[leg];
            if self.offset_sigmas_s[leg].is_finite() && program_s < at.program_s && !overtaken {
                return Moment { program_s, leg, in_stop: false };
            }
            if next_known && after_s < at.program_s {
                return Moment { program_s: at.program_s, leg: leg + 1, in_stop: true };
            }
        }
        let leg = self.breaks.len();
        match self.breaks.last() {
            // Nothing tells when the last leg began: the machine still stands, as far as is known.
            Some(at) if self.offset_sigmas_s[leg].is_infinite() => {
                Moment { program_s: at.program_s, leg, in_stop: true }
            }
            _ => Moment { program_s: self.on_leg_s(log_s, leg), leg, in_stop: false },
        }
    }

    /// How long the machine stood at each break beyond what the program says, s; `None` where a neighbouring leg has no
    /// samples.
    pub fn stood_s(&self) -> Vec<Option<f64>> {
        let known = |leg: usize| self.offset_sigmas_s[leg].is_finite().then(|| self.offsets_s[leg]);
        (0..self.breaks.len()).map(|at| Some(known(at + 1)? - known(at)?)).collect()
    }

    /// How long each operator's pause was, s; `None` where a neighbouring leg has no samples.
    pub fn pauses_s(&self) -> Vec<Option<f64>> {
        let each = self.breaks.iter().zip(self.stood_s());
        each.filter(|(at, _)| at.operator).map(|(_, stood_s)| stood_s).collect()
    }

    /// Log time at which a leg reaches a program time, s.
    pub fn log_time_s(&self, program_s: f64, leg: usize) -> f64 {
        let raw_s = (program_s + self.pace * self.middles_s[leg]) / (1.0 + self.pace);
        (raw_s + self.offsets_s[leg] + self.rate * self.pivot_s) / (1.0 + self.rate)
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

    /// Where one leg ends and the next begins.
    pub fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    /// Program time of every operator's pause, s.
    pub fn stops_s(&self) -> Vec<f64> {
        self.breaks.iter().filter(|at| at.operator).map(|at| at.program_s).collect()
    }
}
