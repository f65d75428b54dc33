//! Corners of chords, which a control drives or rounds out.
//!
//! A planner that brakes for one chord while it speeds up for the next goes round the corner in `v / a`: its path is the mean of the
//! chords over that while, and where chords last less it is over one chord, the quadratic B-spline of their vertices. What is
//! commanded is taken as
//!
//! `c(t) = (1 - r) p(t) + r / t_c ∫ p(t + s) ds`,
//!
//! `p` along the chords and the integral over one of them, `t_c`; `r` is from 0, every chord is driven to its end, to 1.

use nalgebra::Vector3;

use super::following::Following;
use super::samples::Alignment;
use super::time_map::TimeMap;
use crate::motion::Times;

/// Chords that are off their arc by less than rounding of the program are none, mm.
pub const NO_SAG_MM: f64 = 1e-5;
/// The mean over a chord is that at so many places of it: what chords have of higher frequencies than that is nothing.
const CHORD: f64 = 8.0;
/// By so many standard deviations a control is told to round the corners of chords.
const TOLD: f64 = 3.0;

impl Alignment {
    /// By how much the commanded length at a program time of a leg, near that of a block, were longer if the corners of chords were
    /// wholly rounded out, mm: of a sample that is a mean of readings, as that mean has it.
    pub fn rounding_mm(
        &self,
        following: &Following,
        (leg, program_s, near): (usize, f64, usize),
        velocity_mm_s: &Vector3<f64>,
    ) -> f64 {
        let [path_mm, _] = following.at(&self.trajectory, program_s, near);
        let bow_mm = if self.averaged > 1 {
            self.bow_of_chords_mm(following, (program_s, near), &path_mm, velocity_mm_s)
        } else {
            0.0
        };
        self.rounded_from_mm(following, (leg, program_s, near), &path_mm, bow_mm)
    }

    /// The same from where slides are there, and from the [bow](Self::bow_of_chords_mm) of a mean of readings, mm.
    pub(super) fn rounded_from_mm(
        &self,
        following: &Following,
        (leg, program_s, near): (usize, f64, usize),
        path_mm: &Vector3<f64>,
        bow_mm: f64,
    ) -> f64 {
        let [mean_mm, _] = self.over_chord(following, leg, program_s, near);
        self.along(path_mm).dot(&(mean_mm - path_mm)) - bow_mm
    }

    /// The mean of where slides are that [follow](Following::mean) over the chord of a leg about a program time, as a control has it that rounds
    /// corners of chords wholly out.
    pub fn over_chord(
        &self,
        following: &Following,
        leg: usize,
        program_s: f64,
        near: usize,
    ) -> [Vector3<f64>; 2] {
        let chord_s = self.time_map.chords[leg].lasts_s;
        let over = Times::about(program_s, chord_s / CHORD, CHORD as usize);
        following.mean(&self.trajectory, &over, near)
    }

    /// Whether the control may round chords out: there are some, and nobody recorded what it made of them.
    pub fn rounds_chords(&self) -> bool {
        self.chord_sag_mm > NO_SAG_MM && self.trajectory.recorded_pauses_s().is_none()
    }

    /// By how much the mean of the commanded length over a window is longer than the length in its middle on an arc of chords, whose
    /// vertices no curve of third degree follows, mm: by where the slides are in their mean and not there, and by what the bar is longer
    /// for their way across it.
    pub(super) fn bow_of_chords_mm(
        &self,
        following: &Following,
        (program_s, near): (f64, usize),
        middle_mm: &Vector3<f64>,
        velocity_mm_s: &Vector3<f64>,
    ) -> f64 {
        let times = self.times(program_s);
        let [mean_mm, _] = following.mean(&self.trajectory, &times, near);
        let along = self.along(middle_mm);
        along.dot(&(mean_mm - middle_mm)) + self.across_mm(&along, velocity_mm_s, program_s)
    }

    /// By how much the bar is longer in its mean over a window than along it, for the way across it, mm.
    pub fn across_mm(
        &self,
        along: &Vector3<f64>,
        velocity_mm_s: &Vector3<f64>,
        program_s: f64,
    ) -> f64 {
        let across_mm_s = velocity_mm_s - along * velocity_mm_s.dot(along);
        let across_mm2 = across_mm_s.norm_squared() * self.times(program_s).variance_s2();
        across_mm2 / (2.0 * self.radius_mm)
    }
}

impl TimeMap {
    /// Corners are rounded out by so much more of their share, whose standard deviation is then this.
    pub fn round_out(&mut self, more: f64, sigma: f64) {
        self.rounded += more;
        self.turns_rounded = if self.rounded > TOLD * sigma { self.rounded } else { 0.0 };
    }

    /// By how much the time constant is uncertain because the control rounds the corners of chords, s; 0 where it is not told to.
    ///
    /// Readings tell a lag by what it takes from chords, and its way round a corner takes from them, too. A mean over chords that
    /// last `t` has the variance `t² / 12`; a way over less or more, or round every other corner only, has up to twice as much more
    /// or less, and so has `T²`: `(T² + t² / 6)^1/2 - T`.
    pub fn corners_s(&self) -> f64 {
        if self.rounded <= TOLD * self.rounded_sigma {
            return 0.0;
        }
        // Of other legs than those of arcs the blocks last longer.
        let last_s = self.chords.iter().map(|chords| chords.lasts_s).filter(|s| *s > 0.0);
        let last_s2 = last_s.reduce(f64::min).unwrap_or(0.0).powi(2);
        (self.following_s.powi(2) + self.rounded.min(1.0) * last_s2 / 6.0).sqrt() - self.following_s
    }
}
