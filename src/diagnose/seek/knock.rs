//! Where a ball may have moved: every moment of every run tried in one pass.

use rayon::prelude::*;

use super::candidate::Candidate;
use crate::diagnose::thresholds::SEEN;
use crate::machine::Axis;
use crate::model::{Ball, Cause, Form, Seat, SetUp, Shape};
use crate::residual::{Beside, Element, Owner};
use crate::solve::dot;

/// A step needs so many samples on either side, or it is a reading that went wrong.
const FEWEST: usize = 20;

/// The best moment of every run and direction.
pub(crate) fn candidates(cause: &'static Cause, beside: &Beside) -> Vec<Candidate> {
    let runs = beside.residuals.runs();
    let places: Vec<(usize, usize, Axis)> = runs
        .flat_map(|(repeat, run)| Axis::ALL.into_iter().map(move |axis| (repeat, run, axis)))
        .collect();
    let found: Vec<Option<Candidate>> = places
        .par_iter()
        .map(|&(repeat, run, axis)| {
            let (moment_s, gain_mm2) = best_moment(beside, repeat, run, axis)?;
            let seat = Seat::Ball(SetUp { ball: Ball::Tool, axis });
            let shape = Shape { cause, seat, inner: Some(moment_s) };
            let element = Element::new(Form::Cause(shape), Owner::One { repeat, run });
            Some(Candidate { element, gain_mm2 })
        })
        .collect();
    found.into_iter().flatten().collect()
}

/// Moment (s since the program began) and gain (mm²) of the best step of the tool ball.
fn best_moment(beside: &Beside, repeat: usize, run: usize, axis: Axis) -> Option<(f64, f64)> {
    let of = &beside.residuals.repeats[repeat];
    let range = of.runs[run].samples.clone();
    // Sums from the end of the run back to a sample: those of the column of a step before it.
    let mut along = vec![0.0; of.basis.rank()];
    let mut along_span = vec![0.0; beside.span.len()];
    let (mut squares, mut common) = (0.0, 0.0);
    let mut best: Option<(usize, f64)> = None;
    for k in range.clone().rev() {
        let sample = &of.samples[k];
        let worth = sample.situation.direction[axis.index()] * sample.root_weight;
        for (a, q) in along.iter_mut().zip(of.basis.row(k)) {
            *a += worth * q;
        }
        for (a, unit) in along_span.iter_mut().zip(&beside.span) {
            if let Some(u) = unit[repeat].get(k) {
                *a += worth * u;
            }
        }
        squares += worth * worth;
        common += worth * beside.left_mm[repeat][k];
        let left = squares - dot(&along, &along) - dot(&along_span, &along_span);
        let inside = range.end - k >= FEWEST && k - range.start >= FEWEST;
        if inside && left > SEEN * squares {
            let gain = common * common / left;
            if best.is_none_or(|(_, most)| gain > most) {
                best = Some((k, gain));
            }
        }
    }
    let (k, gain) = best?;
    let before = of.samples[k - 1].elapsed_s();
    let after = of.samples[k].elapsed_s();
    Some((0.5 * (before + after), gain))
}
