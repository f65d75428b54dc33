//! What an identification is given: runs, and how to take them.

use crate::align::{Alignment, FOLLOWING_S, Following, Sample, TimeMap};
use crate::plan::Test;
use crate::solve::Loss;

/// How to identify.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Stated standard deviation of a reading, mm.
    pub noise_mm: f64,
    /// How far the instrument's clock may be off, as a share of 1.
    pub clock_tolerance: f64,
    /// Weights of far-off samples.
    pub loss: Loss,
    /// Of all solutions of a rank-deficient problem take the shortest, instead of refusing.
    pub minimum_norm: bool,
}

impl Options {
    /// What a test file says.
    pub fn of(test: &Test) -> Self {
        Self {
            noise_mm: test.ball_bar().noise_mm,
            clock_tolerance: test.ball_bar().clock_tolerance,
            loss: test.estimation().loss,
            minimum_norm: test.estimation().minimum_norm,
        }
    }
}

/// Step of the difference that tells the effect of the time constant, s, at the least.
const FOLLOWING_STEP_S: f64 = 1e-3;

/// One run that takes part.
#[derive(Debug, Clone)]
pub struct RunInput {
    /// Its name.
    pub name: String,
    /// Index of its mounting in the model.
    pub mounting: usize,
    /// Nominal length of the bar that was used, mm.
    pub nominal_mm: f64,
    /// The aligned log.
    pub alignment: Alignment,
    /// When the log was read by its alignment alone, before any fit.
    pub(super) aligned: TimeMap,
    /// Its number among the runs of its repeat.
    number: usize,
    /// Its samples, where the time map of the alignment lays them.
    samples: Vec<Sample>,
    /// How the slides follow there, and with a time constant that is longer by a step.
    pub(super) following: [Following; 2],
    /// That step, s.
    pub(super) following_step_s: f64,
}

impl RunInput {
    /// A run with its samples where its alignment lays them.
    pub fn new(name: String, mounting: usize, nominal_mm: f64, alignment: Alignment) -> Self {
        let following = [0.0, FOLLOWING_STEP_S].map(|longer_s| alignment.following(longer_s));
        let samples = alignment.samples_by(&following[0]);
        let aligned = alignment.time_map.clone();
        Self {
            name,
            mounting,
            nominal_mm,
            alignment,
            aligned,
            number: 0,
            samples,
            following,
            following_step_s: FOLLOWING_STEP_S,
        }
    }

    /// The same as that of this number of its repeat.
    #[must_use]
    pub(super) fn numbered(mut self, number: usize) -> Self {
        self.number = number;
        self.samples.iter_mut().for_each(|sample| sample.motion.run = number);
        self
    }

    /// The same with its feed held so many plausible deviations from that of engagement and release.
    pub(super) fn at_feed(mut self, off: f64) -> Self {
        self.alignment.time_map.hold_pace(off);
        self
    }

    /// Its samples, in order.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// From now on the effect of a time constant is told by the difference that this standard deviation makes, s, as far as it is
    /// plausible. Of a radius it is a square: where slides seem to follow at once its slope is nothing, and a lag that nobody can
    /// rule out is not. Of a normal deviation `σ` about nothing the square has the root mean square `√3 σ²`, which is the
    /// difference over `√3 σ` times `σ`.
    pub(super) fn consider_lag(&mut self, sigma_s: f64) {
        self.following_step_s = 3.0_f64.sqrt() * sigma_s.min(FOLLOWING_S);
    }

    /// That standard deviation, s.
    pub(super) fn considered_s(&self) -> f64 {
        self.following_step_s / 3.0_f64.sqrt()
    }

    /// Lays the samples anew, after the time map has changed.
    pub(super) fn place(&mut self) {
        self.follow();
        self.samples = self.alignment.samples_by(&self.following[0]);
        self.samples.iter_mut().for_each(|sample| sample.motion.run = self.number);
    }

    /// The same of some of them, by their indices in order; the others stay where they were.
    pub(super) fn place_some(&mut self, some: &[usize]) {
        self.follow();
        let laid = self.alignment.some_samples_by(some, &self.following[0]);
        for (&k, mut sample) in some.iter().zip(laid) {
            sample.motion.run = self.number;
            self.samples[k] = sample;
        }
    }

    /// States how well their times are known, where nothing else of the time map has changed.
    pub(super) fn state_sigmas(&mut self) {
        let map = &self.alignment.time_map;
        for sample in &mut self.samples {
            sample.time_sigma_s = map.sigma_s(sample.log_s, sample.leg);
        }
    }

    /// How the slides follow by the time map as it is now, and with the step of the time constant as it is now.
    pub(super) fn follow(&mut self) {
        for (following, longer_s) in self.following.iter_mut().zip([0.0, self.following_step_s]) {
            // Worked out over all blocks: not again where only times have moved.
            if !self.alignment.follows(following, longer_s) {
                *following = self.alignment.following(longer_s);
            }
        }
    }
}
