//! An effect as a part of the extended model: its columns, and the number inside that is estimated too.

use rayon::prelude::*;

use super::data::{Column, Data};
use crate::model::{Form, Kind, Seat, Shape, Term};

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

/// An effect that takes part in the extended model.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// What it is.
    pub form: Form,
    /// Whose it is.
    pub owner: Owner,
}

/// In which scale the number inside of a shape is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Plain,
    Inverse,
    Logarithm,
}

impl Element {
    /// A cause that is the same in all runs.
    pub(crate) fn shared(shape: Shape) -> Self {
        Self { form: Form::Cause(shape), owner: Owner::All }
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

    /// Whether it is a following error that all slides have in common.
    pub(crate) fn is_common_delay(&self) -> bool {
        self.shape().is_some_and(|s| s.cause.kind == Kind::Servo && s.seat == Seat::Whole)
    }

    fn scale(&self) -> Option<Scale> {
        match self.shape()?.cause.kind {
            Kind::Cyclic => Some(Scale::Inverse),
            Kind::Vibration => Some(Scale::Plain),
            Kind::ReversalSpike | Kind::PreSliding | Kind::Drift | Kind::StickSlip => {
                Some(Scale::Logarithm)
            }
            _ => None,
        }
    }

    /// The number inside on the scale on which it is estimated; `None` where nothing inside is.
    pub(crate) fn free(&self) -> Option<f64> {
        let inner = self.shape()?.inner?;
        Some(match self.scale()? {
            Scale::Plain => inner,
            Scale::Inverse => inner.recip(),
            Scale::Logarithm => inner.ln(),
        })
    }

    /// The same with another number inside.
    pub(crate) fn with_free(&self, free: f64) -> Self {
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

    /// Whether the number inside is one that these runs can show: a wave goes round at least three quarters
    /// of the way of its slide, a vibration and a decay are not slower than the runs.
    pub(crate) fn possible(&self, data: &Data) -> bool {
        let Some((shape, inner)) = self.shape().and_then(|s| Some((s, s.inner?))) else {
            return true;
        };
        match (shape.cause.kind, shape.seat) {
            (Kind::Cyclic, Seat::Function(slide, _)) => {
                inner > 0.0 && inner < 1.33 * data.way_mm[slide.index()]
            }
            (Kind::Drift, _) => inner < 1e7,
            (Kind::PreSliding, Seat::Function(slide, _)) => inner < data.way_mm[slide.index()],
            _ => inner > 0.0,
        }
    }

    /// What it is in one run.
    pub(crate) fn in_run(&self, tuned: f64) -> Form {
        match &self.form {
            Form::Cause(shape) if self.owner == Owner::EachRun => {
                Form::Cause(Shape { inner: shape.inner.map(|hz| hz * tuned), ..shape.clone() })
            }
            form => form.clone(),
        }
    }

    /// Standard deviation of the number inside from that on its scale.
    pub(crate) fn inner_sigma(&self, free_sigma: f64) -> Option<f64> {
        let inner = self.shape()?.inner?;
        Some(match self.scale()? {
            Scale::Plain => free_sigma,
            Scale::Inverse => inner * inner * free_sigma,
            Scale::Logarithm => inner * free_sigma,
        })
    }

    /// A step of the number inside that is small and yet shows beyond rounding.
    pub(crate) fn small_step(&self) -> f64 {
        match self.scale() {
            // A hundredth of a radian over some 150 mm or 1000 s.
            Some(Scale::Inverse) => 1e-5,
            Some(Scale::Plain) => 2e-6,
            _ => 1e-3,
        }
    }

    /// No step of the estimate is longer than this: beyond it the derivative means nothing.
    pub(crate) fn long_step(&self) -> f64 {
        match self.scale() {
            Some(Scale::Inverse) => 8e-4,
            Some(Scale::Plain) => 3e-4,
            _ => 0.5,
        }
    }

    /// Its columns over all samples, one an amplitude, each with whose amplitude it is.
    pub(crate) fn columns(&self, data: &Data) -> Vec<Column> {
        let count = self.term().parameter_count();
        let plain: Vec<Vec<Vec<f64>>> = data
            .blocks
            .par_iter()
            .enumerate()
            .map(|(index, block)| {
                let of_block = !matches!(self.owner, Owner::One { repeat, .. } if repeat != index);
                if !of_block {
                    return vec![Vec::new(); count];
                }
                let mut columns = vec![vec![0.0; block.samples.len()]; count];
                let mut row = vec![0.0; count];
                for (k, sample) in block.samples.iter().enumerate() {
                    if matches!(self.owner, Owner::One { run, .. } if run != sample.run) {
                        continue;
                    }
                    if self.owner == Owner::EachRun {
                        let mut own = sample.situation.clone();
                        own.motion.elapsed_s *= block.tuned[sample.run];
                        self.term().columns(&own, &mut row);
                    } else {
                        self.term().columns(&sample.situation, &mut row);
                    }
                    for (column, value) in columns.iter_mut().zip(&row) {
                        column[k] = value * sample.root_weight;
                    }
                }
                columns
            })
            .collect();
        let of = |amplitude: usize| -> Column {
            plain.iter().map(|block| block[amplitude].clone()).collect()
        };
        match self.owner {
            Owner::All | Owner::One { .. } => (0..count).map(of).collect(),
            Owner::EachRun => {
                let mut columns = Vec::new();
                for (index, block) in data.blocks.iter().enumerate() {
                    for run in &block.runs {
                        for of_block in &plain[index] {
                            let mut column: Column = vec![Vec::new(); data.blocks.len()];
                            let mut own = vec![0.0; block.samples.len()];
                            own[run.clone()].copy_from_slice(&of_block[run.clone()]);
                            column[index] = own;
                            columns.push(column);
                        }
                    }
                }
                columns
            }
        }
    }
}
