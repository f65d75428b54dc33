//! A run that is aligned, and its samples.

use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::clipped::{self, Limit};
use super::engaged::{Engaged, Slip};
use super::engagement::Engagement;
use super::following::{Following, HAIR_S};
use super::mean_path::MeanPath;
use super::ramp::Mark;
use super::section::Section;
use super::time_map::TimeMap;
use super::window;
use crate::log::{Log, Reading};
use crate::machine::Pose;
use crate::model::{Averaged, Motion};
use crate::motion::{Reversals, Times, Trajectory};

/// By no more than rounding it does not move, mm.
const STANDS_MM: f64 = 1e-9;

/// Readings that are laid one after the other; others are beside them.
const AT_ONCE: usize = 1024;

/// What part of the program a sample was taken in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// On a section of the sphere; its index.
    Arc(usize),
    /// On a feed-in or feed-out.
    Ramp,
    /// In a dwell, or at rest at the end of a block.
    Dwell,
    /// In an operator's pause.
    Stop,
}

/// One reading with the place at which it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time on the instrument's clock, s.
    pub log_s: f64,
    /// Line of the log; of a mean its first one.
    pub line: usize,
    /// Program time, s, operator's pauses counted as zero.
    pub program_s: f64,
    /// Standard deviation of the program time, s.
    pub time_sigma_s: f64,
    /// Length minus nominal length, mm.
    pub deviation_mm: f64,
    /// Axis positions and senses.
    pub pose: Pose,
    /// How the machine moved there.
    pub motion: Motion,
    /// Where in the program.
    pub part: Part,
    /// Index of the leg of the time map.
    pub leg: usize,
    /// Index of the block of the trajectory.
    pub block: usize,
}

/// One run: a log laid over a program.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// The program with its times, at the estimated feed override.
    pub trajectory: Trajectory,
    /// From log time to program time.
    pub time_map: TimeMap,
    /// Engagements and releases.
    pub marks: Vec<Mark>,
    /// The engagements that the program makes.
    pub engagements: Vec<Engagement>,
    /// The arcs.
    pub sections: Vec<Section>,
    /// Period of the samples, s.
    pub sample_period_s: f64,
    /// How many readings of the log a sample is the mean of; at its edges and gaps it may be fewer.
    pub averaged: usize,
    /// Which slides move on the arcs.
    pub moving: [bool; 3],
    /// How far the chords of the arcs are off them, mm; 0 of a program of arcs.
    pub chord_sag_mm: f64,
    /// Radius of the sphere, mm.
    pub radius_mm: f64,
    /// When the program began, on the log's clock, s: half way between what the log allows where an
    /// operator's pause hides it.
    pub began_log_s: f64,
    /// Standard deviation of that, s.
    pub began_sigma_s: f64,
    /// When else the log shows the bar engaged for as long, on its own clock, s: other runs.
    pub other_runs_s: Vec<[f64; 2]>,
    /// What the reader of the log found by itself; see [`Log::notes`](crate::log::Log::notes).
    pub log_notes: Vec<String>,
    /// Readings that were cut off at one value; they take no part.
    pub clipped: Vec<Reading>,
    /// Steps that were taken out of the readings after them: the bar slipped.
    pub slips: Vec<Slip>,
    pub(super) reversals: Reversals,
    /// The path of each leg in its mean, once it was looked up.
    pub(super) means: Vec<Arc<Option<MeanPath>>>,
    pub(super) coincidence_mm: Vector3<f64>,
    /// Readings in engagements, as they are in the log.
    pub(super) engaged: Engaged,
    /// Their means over windows: see [`Alignment::averaged`].
    pub(super) windows: Arc<Vec<Reading>>,
}

impl Alignment {
    /// The readings, in a fast log their means, where the time map, as it is now, lays them.
    pub fn samples(&self) -> Vec<Sample> {
        self.samples_by(&self.following(0.0))
    }

    /// The same, by how slides [follow](Self::following) as the time map is now.
    pub fn samples_by(&self, following: &Following) -> Vec<Sample> {
        let laid =
            |windows: &[Reading]| self.laid(windows.iter().copied(), self.averaged > 1, following);
        self.windows.par_chunks(AT_ONCE).flat_map_iter(laid).collect()
    }

    /// Without what was cut off at some limits, the times as they are.
    pub(super) fn without(self, log: &Log, limits: &[Limit]) -> Self {
        let (log, cut) = clipped::without(log, limits);
        let engaged = self.engaged.of(&log);
        let readings: Vec<Reading> = engaged.readings(&self.slips).collect();
        let windows = window::means(&readings, self.averaged, log.sample_period_s());
        let clipped = [self.clipped, cut].concat();
        Self { engaged, windows: Arc::new(windows), clipped, ..self }
    }

    /// Some of these samples, by their indices in order.
    pub fn some_samples_by(&self, some: &[usize], following: &Following) -> Vec<Sample> {
        let laid = |some: &[usize]| {
            let windows = some.iter().map(|k| self.windows[*k]);
            self.laid(windows, self.averaged > 1, following)
        };
        some.par_chunks(AT_ONCE).flat_map_iter(laid).collect()
    }

    /// Every reading where the time map, as it is now, lays it.
    pub fn every_reading(&self) -> Vec<Sample> {
        self.laid(self.engaged.readings(&self.slips), false, &self.following(0.0))
    }

    /// Where the readings of a log that are exactly this, mm, are laid: those while the bar was engaged, and the others.
    pub(super) fn readings_at(&self, log: &Log, at_mm: f64) -> (Vec<Sample>, Vec<Sample>) {
        let is_at = |reading: &&Reading| {
            reading.deviation_mm.is_some_and(|mm| mm.total_cmp(&at_mm).is_eq())
        };
        let engaged = |sample: &Sample| {
            self.engagements.iter().any(|e| (e.start_s..=e.end_s).contains(&sample.program_s))
        };
        let readings = log.readings().iter().filter(is_at).copied();
        self.laid(readings, false, &self.following(0.0)).into_iter().partition(engaged)
    }

    /// The values that readings on arcs were cut off at, mm, each with how many.
    pub fn cut_off(&self) -> Vec<(f64, usize)> {
        let mut cut_mm: Vec<f64> = self
            .laid_clipped()
            .into_iter()
            .filter(|sample| matches!(sample.part, Part::Arc(_)))
            .map(|sample| sample.deviation_mm)
            .collect();
        cut_mm.sort_by(f64::total_cmp);
        let equal = |a: &f64, b: &f64| a.total_cmp(b).is_eq();
        cut_mm.chunk_by(equal).map(|of| (of[0], of.len())).collect()
    }

    /// Readings that were cut off where the time map lays them.
    fn laid_clipped(&self) -> Vec<Sample> {
        self.laid(self.clipped.iter().copied(), false, &self.following(0.0))
    }

    /// Readings where the time map lays them, means of a window with the bow of the path in it taken off.
    fn laid(
        &self,
        readings: impl Iterator<Item = Reading>,
        means: bool,
        following: &Following,
    ) -> Vec<Sample> {
        let (trajectory, time_map) = (&self.trajectory, &self.time_map);
        let averaged = if means { self.window() } else { Averaged::SINGLE };
        let mut samples = Vec::with_capacity(readings.size_hint().0);
        // Of the reading before.
        let mut near = 0;
        for Reading { time_s: log_s, deviation_mm, line } in readings {
            let Some(deviation_mm) = deviation_mm else { continue };
            let moment = time_map.at(log_s);
            // In a pause the senses are still those of the motion before it.
            let before_s = if moment.in_stop { 1e-6 } else { 0.0 };
            let mut state = trajectory.at_near(moment.program_s - before_s, near);
            near = state.block;
            let moves = state.velocity_mm_s.norm() > 1e-9;
            let part = if moment.in_stop {
                Part::Stop
            } else if !moves {
                Part::Dwell
            } else {
                match self
                    .sections
                    .partition_point(|s| s.start_s <= moment.program_s)
                    .checked_sub(1)
                    .filter(|&index| moment.program_s < self.sections[index].end_s)
                {
                    Some(index) => Part::Arc(index),
                    None => Part::Ramp,
                }
            };
            let blur_s =
                if matches!(part, Part::Arc(_)) { time_map.chords[moment.leg].blur_s } else { 0.0 };
            let of_chords = self.chord_sag_mm > 0.0 && matches!(part, Part::Arc(_));
            let at = (moment.program_s, state.block);
            let [followed_mm, _] = following.at(trajectory, at.0, at.1);
            let bow_mm = if !means || !moves || blur_s > 0.0 {
                0.0
            } else if of_chords {
                self.bow_of_chords_mm(following, at, &followed_mm, &state.velocity_mm_s)
            } else {
                self.bow_mm(following, moment.program_s, state.block)
            };
            if !moment.in_stop {
                // Delays are those of the time map, all of them.
                let path_mm = followed_mm + time_map.unlike_s().component_mul(&state.velocity_mm_s);
                let onto_mm = if blur_s > 0.0 {
                    let speed_mm_s = state.velocity_mm_s.norm();
                    self.onto_mean_mm(&path_mm, &moment, blur_s, following, speed_mm_s)
                } else if of_chords
                    && time_map.chords[moment.leg].there_are()
                    && time_map.rounded.abs() > 0.0
                {
                    let now = (moment.leg, moment.program_s, state.block);
                    let rounding_mm = self.rounded_from_mm(following, now, &followed_mm, bow_mm);
                    self.along(&followed_mm) * (time_map.rounded * rounding_mm)
                } else {
                    Vector3::zeros()
                };
                let late_mm = time_map.delays_s.component_mul(&state.velocity_mm_s);
                state.position_mm = path_mm + onto_mm - late_mm;
            }
            samples.push(Sample {
                log_s,
                line,
                program_s: moment.program_s,
                time_sigma_s: time_map.sigma_s(log_s, moment.leg),
                deviation_mm: deviation_mm - bow_mm,
                pose: Pose { position_mm: state.position_mm, sense: state.sense },
                motion: Motion {
                    velocity_mm_s: state.velocity_mm_s,
                    // By the clock of the bar: a feed that is not as stated makes the program longer, and no time constant.
                    elapsed_s: log_s - self.began_log_s,
                    program_s: moment.program_s,
                    reversals: self.reversals.last(
                        moment.program_s,
                        &state.position_mm,
                        time_map.turns_rounded,
                    ),
                    corner: trajectory.corner(moment.program_s, state.block),
                    averaged,
                    ..Motion::REST
                },
                part,
                leg: moment.leg,
                block: state.block,
            });
        }
        samples
    }

    /// The readings that a sample is the mean of.
    pub fn window(&self) -> Averaged {
        let readings = self.averaged.max(1) as f64;
        Averaged { readings, period_s: self.sample_period_s / readings }
    }

    /// A sample of an arc as it would be a little later on its way, by how slides [follow](Self::following).
    pub fn later(&self, following: &Following, sample: &Sample, later_s: f64) -> Sample {
        let program_s = sample.program_s + later_s;
        let state = self.trajectory.at_near(program_s, sample.block);
        let late_s = self.time_map.delays_s - self.time_map.unlike_s();
        let late_mm = late_s.component_mul(&state.velocity_mm_s);
        let at_mm =
            |aside_s: f64| following.at(&self.trajectory, program_s + aside_s, state.block)[0];
        let path_mm = at_mm(0.0);
        let position_mm = path_mm - late_mm;
        // Round a corner that comes from fast and goes on slowly a slide turns later than round the middle of one.
        let moves_mm = at_mm(HAIR_S) - at_mm(-HAIR_S);
        let sense = state.sense.zip_map(&moves_mm, |sense, moves_mm| {
            if moves_mm.abs() > STANDS_MM { moves_mm.signum() } else { sense }
        });
        let motion = Motion {
            velocity_mm_s: state.velocity_mm_s,
            elapsed_s: sample.motion.elapsed_s + later_s,
            program_s,
            reversals: self.reversals.last(program_s, &position_mm, self.time_map.turns_rounded),
            corner: self.trajectory.corner(program_s, state.block),
            ..sample.motion
        };
        let pose = Pose { position_mm, sense };
        Sample { program_s, pose, motion, block: state.block, ..*sample }
    }

    /// By how much the mean of the commanded length over a window is longer than the length in its middle, mm.
    ///
    /// The mean of a curve of third degree is that of its values at the middle and [`Times::node_s`] either side of it.
    fn bow_mm(&self, following: &Following, program_s: f64, near: usize) -> f64 {
        let node_s = self.times(program_s).node_s();
        let length_mm = |at_s: f64| {
            let [path_mm, _] = following.at(&self.trajectory, at_s, near);
            (path_mm - self.coincidence_mm).norm()
        };
        let [before_mm, middle_mm, after_mm] =
            [-node_s, 0.0, node_s].map(|aside_s| length_mm(program_s + aside_s));
        (before_mm + after_mm - 2.0 * middle_mm) / 3.0
    }

    /// Program times of the readings of a sample about its own.
    pub fn times(&self, program_s: f64) -> Times {
        let count = self.averaged.max(1);
        Times::about(program_s, self.sample_period_s / count as f64, count)
    }

    /// How slides follow the program by the time map as it is now, the time constant that they share longer by some seconds;
    /// that they are late by it is in the offsets.
    pub fn following(&self, longer_s: f64) -> Following {
        let map = &self.time_map;
        let chords = self.chord_sag_mm > 0.0;
        Following::new(&self.trajectory, map.following_s + longer_s, &map.longer, chords)
    }

    /// Whether that is how slides follow which are said to follow so.
    pub fn follows(&self, following: &Following, longer_s: f64) -> bool {
        following.has(self.time_map.following_s + longer_s, &self.time_map.longer)
    }

    /// The unit vector from the workpiece ball to a place in machine coordinates.
    pub(super) fn along(&self, position_mm: &Vector3<f64>) -> Vector3<f64> {
        let ball_mm = position_mm - self.coincidence_mm;
        ball_mm.try_normalize(f64::EPSILON).unwrap_or_else(Vector3::zeros)
    }

    /// Machine coordinates at which the ball centres coincide, mm.
    pub fn coincidence_mm(&self) -> &Vector3<f64> {
        &self.coincidence_mm
    }

    /// Legs that have samples, in order.
    pub fn legs(&self) -> Vec<usize> {
        let mut legs: Vec<usize> =
            self.windows.iter().map(|reading| self.time_map.at(reading.time_s).leg).collect();
        legs.dedup();
        legs.sort_unstable();
        legs.dedup();
        legs
    }
}
