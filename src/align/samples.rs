//! A run that is aligned, and its samples.

use nalgebra::Vector3;

use super::engagement::Engagement;
use super::following;
use super::ramp::Mark;
use super::section::Section;
use super::time_map::TimeMap;
use crate::log::Reading;
use crate::machine::Pose;
use crate::model::Motion;
use crate::motion::{Reversals, Trajectory};

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
    /// When the program began, on the log's clock, s: half way between what the log allows where an
    /// operator's pause hides it.
    pub began_log_s: f64,
    /// Standard deviation of that, s.
    pub began_sigma_s: f64,
    pub(super) reversals: Reversals,
    pub(super) coincidence_mm: Vector3<f64>,
    /// Readings in engagements.
    pub(super) readings: Vec<Reading>,
    /// Their means over windows: see [`Alignment::averaged`].
    pub(super) windows: Vec<Reading>,
}

impl Alignment {
    /// The readings, in a fast log their means, where the time map, as it is now, lays them.
    pub fn samples(&self) -> Vec<Sample> {
        self.laid(&self.windows)
    }

    /// Every reading where the time map, as it is now, lays it.
    pub fn every_reading(&self) -> Vec<Sample> {
        self.laid(&self.readings)
    }

    fn laid(&self, readings: &[Reading]) -> Vec<Sample> {
        let (trajectory, time_map) = (&self.trajectory, &self.time_map);
        let mut samples = Vec::with_capacity(readings.len());
        for &Reading { time_s: log_s, deviation_mm, line } in readings {
            let Some(deviation_mm) = deviation_mm else { continue };
            let moment = time_map.at(log_s);
            // In a pause the senses are still those of the motion before it.
            let before_s = if moment.in_stop { 1e-6 } else { 0.0 };
            let mut state = trajectory.at(moment.program_s - before_s);
            if !moment.in_stop {
                state.position_mm = self.followed_mm(moment.program_s, time_map.following_s)
                    - time_map.delays_s.component_mul(&state.velocity_mm_s);
            }
            let part = if moment.in_stop {
                Part::Stop
            } else if state.velocity_mm_s.norm() < 1e-9 {
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
            samples.push(Sample {
                log_s,
                line,
                program_s: moment.program_s,
                time_sigma_s: time_map.sigma_s(log_s, moment.leg),
                deviation_mm,
                pose: Pose { position_mm: state.position_mm, sense: state.sense },
                motion: Motion {
                    velocity_mm_s: state.velocity_mm_s,
                    elapsed_s: (1.0 + time_map.rate) * (log_s - self.began_log_s),
                    program_s: moment.program_s,
                    reversals: self.reversals.last(moment.program_s, &state.position_mm),
                    corner: trajectory.corner(moment.program_s, state.block),
                },
                part,
                leg: moment.leg,
            });
        }
        samples
    }

    /// Where slides are at a program time that all follow the program alike with a time constant, mm; that they do so
    /// late is in the offsets.
    pub fn followed_mm(&self, program_s: f64, following_s: f64) -> Vector3<f64> {
        following::at(&self.trajectory, program_s, following_s)
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
