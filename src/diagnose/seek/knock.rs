//! Where a ball may have moved: every moment of every run tried in one pass.

use rayon::prelude::*;

use super::candidate::Candidate;
use crate::diagnose::thresholds::SEEN;
use crate::machine::Axis;
use crate::model::{Ball, Form, Kind, Seat, SetUp, Shape};
use crate::residual::data::{Data, dot};
use crate::residual::element::{Element, Owner};

/// A step needs so many samples on either side, or it is a reading that went wrong.
const FEWEST: usize = 20;

/// The best moment of every run and direction.
pub(crate) fn candidates(data: &Data) -> Vec<Candidate> {
    let cause = Kind::Knock.cause();
    let places: Vec<(usize, usize, Axis)> = data
        .blocks
        .iter()
        .enumerate()
        .flat_map(|(repeat, block)| (0..block.runs.len()).map(move |run| (repeat, run)))
        .flat_map(|(repeat, run)| Axis::ALL.into_iter().map(move |axis| (repeat, run, axis)))
        .collect();
    let found: Vec<Option<Candidate>> = places
        .par_iter()
        .map(|&(repeat, run, axis)| {
            let (moment_s, gain_mm2) = best_moment(data, repeat, run, axis)?;
            let seat = Seat::Ball(SetUp { ball: Ball::Tool, axis });
            let shape = Shape { cause, seat, inner: Some(moment_s) };
            let element = Element { form: Form::Cause(shape), owner: Owner::One { repeat, run } };
            Some(Candidate { element, gain_mm2 })
        })
        .collect();
    found.into_iter().flatten().collect()
}

/// Moment (s since the program began) and gain (mm²) of the best step of the tool ball.
fn best_moment(data: &Data, repeat: usize, run: usize, axis: Axis) -> Option<(f64, f64)> {
    let block = &data.blocks[repeat];
    let range = block.runs[run].clone();
    // Sums from the end of the run back to a sample: those of the column of a step before it.
    let mut along = vec![0.0; block.rank];
    let mut along_span = vec![0.0; data.span.len()];
    let (mut squares, mut common) = (0.0, 0.0);
    let mut best: Option<(usize, f64)> = None;
    for k in range.clone().rev() {
        let sample = &block.samples[k];
        let worth = sample.situation.direction[axis.index()] * sample.root_weight;
        for (a, q) in along.iter_mut().zip(&block.q[k * block.rank..(k + 1) * block.rank]) {
            *a += worth * q;
        }
        for (a, unit) in along_span.iter_mut().zip(&data.span) {
            if let Some(u) = unit[repeat].get(k) {
                *a += worth * u;
            }
        }
        squares += worth * worth;
        common += worth * data.left_mm[repeat][k];
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
    let before = block.samples[k - 1].situation.motion.elapsed_s;
    let after = block.samples[k].situation.motion.elapsed_s;
    Some((0.5 * (before + after), gain))
}
