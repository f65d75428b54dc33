//! An effect as a part of the extended model: its columns, and the number inside that is estimated too.

use std::mem::take;

use rayon::prelude::*;

use super::column::Column;
use super::residuals::{Repeat, Residuals};
use crate::model::{Empirical, Form, Inner, Law, Scale, Shape, Start, Term};

/// Whether an effect is the same in all runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// One amplitude for all.
    All,
    /// An amplitude, or amplitude and phase, of its own for every run.
    EachRun,
    /// One run of one repeat has it: indices of both.
    One {
        /// Index of the repeat.
        repeat: usize,
        /// Index of the run in it.
        run: usize,
    },
}

/// By which factor a vibration is faster in each run than its frequency says: no source, and no clock, keeps
/// a frequency to a turn in ten thousand. By default it is the same in all runs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tuning(Vec<Vec<f64>>);

impl Tuning {
    /// One factor a run, repeat after repeat.
    pub fn of(factors: Vec<Vec<f64>>) -> Self {
        Self(factors)
    }

    /// The factor of one run.
    pub fn factor(&self, repeat: usize, run: usize) -> f64 {
        self.0.get(repeat).and_then(|runs| runs.get(run)).copied().unwrap_or(1.0)
    }

    /// Whether any run has a factor of its own.
    pub fn differs(&self) -> bool {
        !self.0.is_empty()
    }
}

/// By how much earlier the program of each run began than its log tells, s, for what begins with it. By default by nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Earlier(Vec<Vec<f64>>);

impl Earlier {
    /// One time a run, repeat after repeat.
    pub(super) fn of(times_s: Vec<Vec<f64>>) -> Self {
        Self(times_s)
    }

    /// The time of one run, s.
    pub fn in_s(&self, repeat: usize, run: usize) -> f64 {
        self.0.get(repeat).and_then(|runs| runs.get(run)).copied().unwrap_or(0.0)
    }

    /// Whether any run has one.
    pub fn tells(&self) -> bool {
        !self.0.is_empty()
    }
}

/// An effect that takes part in the extended model.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// What it is.
    pub form: Form,
    /// Whose it is.
    pub owner: Owner,
    /// Of an effect that differs from run to run, how its frequency does.
    pub tuning: Tuning,
    /// Of an effect that begins with the program, when that was.
    pub earlier: Earlier,
}

impl Element {
    /// An effect with its owner, its frequency the same in all runs, which began as their logs tell.
    pub fn new(form: Form, owner: Owner) -> Self {
        Self { form, owner, tuning: Tuning::default(), earlier: Earlier::default() }
    }

    /// A cause that is the same in all runs.
    pub fn shared(shape: Shape) -> Self {
        Self::new(Form::Cause(shape), Owner::All)
    }

    /// The term that it is.
    pub fn term(&self) -> &dyn Term {
        self.form.term()
    }

    /// Its shape, where it has a cause.
    pub fn shape(&self) -> Option<&Shape> {
        match &self.form {
            Form::Cause(shape) => Some(shape),
            Form::Empirical(_) => None,
        }
    }

    /// Its curve, where no cause explains it.
    pub fn curve(&self) -> Option<&Empirical> {
        match &self.form {
            Form::Empirical(curve) => Some(curve),
            Form::Cause(_) => None,
        }
    }

    /// Whether it is a following error that all slides have in common.
    pub fn is_common_delay(&self) -> bool {
        self.shape().is_some_and(|shape| matches!(shape.law(), Law::Corner(_)))
    }

    /// Whether it is a slide that follows later than others.
    pub fn is_delay(&self) -> bool {
        self.shape().is_some_and(|shape| shape.delays().is_some())
    }

    fn inner(&self) -> Option<&'static Inner> {
        self.shape()?.law().inner()
    }

    fn scale(&self) -> Option<Scale> {
        self.inner()?.scale
    }

    /// The number inside on the scale on which it is estimated; `None` where nothing inside is.
    pub fn free(&self) -> Option<f64> {
        let inner = self.shape()?.inner?;
        Some(match self.scale()? {
            Scale::Plain => inner,
            Scale::Inverse => inner.recip(),
            Scale::Logarithm => inner.ln(),
        })
    }

    /// The same with another number inside.
    #[must_use]
    pub fn with_free(&self, free: f64) -> Self {
        let mut changed = self.clone();
        if let (Form::Cause(shape), Some(scale)) = (&mut changed.form, self.scale()) {
            shape.inner = Some(match scale {
                Scale::Plain => free,
                Scale::Inverse => free.recip(),
                Scale::Logarithm => free.exp(),
            });
        }
        changed
    }

    /// The time constant of what begins with the program of every run, s.
    pub(super) fn time_constant_s(&self) -> Option<f64> {
        let begins = matches!(self.inner()?.start, Start::TimeConstants(..));
        self.shape()?.inner.filter(|_| begins && self.owner == Owner::All)
    }

    /// The share of its amplitude that it comes to in these runs: a drift with a time constant of years to next to nothing of it.
    pub fn reached(&self, residuals: &Residuals) -> f64 {
        self.time_constant_s()
            .map_or(1.0, |constant_s| -(-residuals.longest_s() / constant_s).exp_m1())
    }

    /// Whether, as it is, several of it make any curve.
    pub fn makes_any_curve(&self) -> bool {
        self.shape().is_some_and(|shape| (shape.cause.makes_any_curve)(shape.inner.unwrap_or(0.0)))
    }

    /// Whether the number inside is one that these runs can show: within the limits of its key and, where it is
    /// a part of the way of its axis or of its highest speed, short enough for that; of a vibration one that means of readings leave.
    pub fn possible(&self, residuals: &Residuals) -> bool {
        let Some((shape, number)) = self.shape().and_then(|s| Some((s, s.inner?))) else {
            return true;
        };
        let Some((inner, key)) = shape.cause.inner(shape.seat) else { return true };
        let of_axis =
            |of: &[f64; 3]| shape.seat.axis().map_or(f64::INFINITY, |axis| of[axis.index()]);
        let [_, most] = key.limits_si(shape.seat);
        let stands = inner.start == Start::Middle;
        let is_left = |repeat: &Repeat| {
            let mut averaged = repeat.runs.iter().filter_map(|run| {
                Some(repeat.samples.get(run.samples.start)?.situation.motion.averaged)
            });
            averaged.any(|of| of.holds(number))
        };
        (number > 0.0 || stands)
            && (inner.start != Start::Lines || residuals.repeats.iter().any(is_left))
            && number <= most
            && number < inner.part_of_way * of_axis(&residuals.way_mm)
            && number < inner.part_of_fastest * of_axis(&residuals.fastest_mm_s)
    }

    /// How many amplitudes apart two of it act on a common sample: the hat of a curve touches its neighbours alone.
    pub(super) fn reach(&self) -> usize {
        match self.form {
            Form::Cause(_) => usize::MAX,
            Form::Empirical(_) => 1,
        }
    }

    /// What it is in one run.
    pub fn in_run(&self, repeat: usize, run: usize) -> Form {
        match &self.form {
            Form::Cause(shape) if self.owner == Owner::EachRun => {
                let tuned = self.tuning.factor(repeat, run);
                Form::Cause(Shape { inner: shape.inner.map(|hz| hz * tuned), ..shape.clone() })
            }
            form => form.clone(),
        }
    }

    /// Standard deviation of the number inside from that on its scale.
    pub fn inner_sigma(&self, free_sigma: f64) -> Option<f64> {
        let inner = self.shape()?.inner?;
        Some(match self.scale()? {
            Scale::Plain => free_sigma,
            Scale::Inverse => inner * inner * free_sigma,
            Scale::Logarithm => inner * free_sigma,
        })
    }

    /// A step of the number inside that is small and yet shows beyond rounding.
    pub fn small_step(&self) -> f64 {
        match self.scale() {
            // A hundredth of a radian over some 150 mm or 1000 s.
            Some(Scale::Inverse) => 1e-5,
            Some(Scale::Plain) => 2e-6,
            _ => 1e-3,
        }
    }

    /// No step of the estimate is longer than this: beyond it the derivative means nothing.
    pub fn long_step(&self) -> f64 {
        match self.scale() {
            Some(Scale::Inverse) => 8e-4,
            Some(Scale::Plain) => 3e-4,
            _ => 0.5,
        }
    }

    /// Its columns over all samples, one an amplitude, run after run where each has its own.
    pub fn columns(&self, residuals: &Residuals) -> Vec<Column> {
        let count = self.term().parameter_count();
        let repeats = &residuals.repeats;
        let mut shared: Vec<Vec<Vec<f64>>> = repeats
            .par_iter()
            .enumerate()
            .map(|(index, repeat)| self.in_repeat(index, repeat))
            .collect();
        if self.owner != Owner::EachRun {
            let mut of =
                |amplitude: usize| shared.iter_mut().map(|of| take(&mut of[amplitude])).collect();
            return (0..count).map(&mut of).collect();
        }
        let each = residuals.runs().flat_map(|(index, run)| {
            let samples = repeats[index].runs[run].samples.clone();
            let length = repeats[index].samples.len();
            shared[index].iter().map(move |of_repeat| {
                let mut own = vec![0.0; length];
                own[samples.clone()].copy_from_slice(&of_repeat[samples.clone()]);
                let mut column = Column::empty(repeats.len());
                column[index] = own;
                column
            })
        });
        each.collect()
    }

    /// What one of each amplitude does to the samples of a repeat, as if all runs had the same.
    fn in_repeat(&self, index: usize, repeat: &Repeat) -> Vec<Vec<f64>> {
        let count = self.term().parameter_count();
        if matches!(self.owner, Owner::One { repeat, .. } if repeat != index) {
            return vec![Vec::new(); count];
        }
        let mut columns = vec![vec![0.0; repeat.samples.len()]; count];
        let mut row = vec![0.0; count];
        for (k, sample) in repeat.samples.iter().enumerate() {
            if matches!(self.owner, Owner::One { run, .. } if run != sample.run) {
                continue;
            }
            if self.owner == Owner::EachRun || self.earlier.tells() {
                let mut own = sample.situation.clone();
                if self.owner == Owner::EachRun {
                    own.motion.elapsed_s *= self.tuning.factor(index, sample.run);
                }
                own.motion.elapsed_s += self.earlier.in_s(index, sample.run);
                self.term().columns(&own, &mut row);
            } else {
                self.term().columns(&sample.situation, &mut row);
            }
            for (column, value) in columns.iter_mut().zip(&row) {
                column[k] = value * sample.root_weight;
            }
        }
        columns
    }
}
