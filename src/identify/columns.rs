//! Where the parameters of the time maps stand: each run has columns of its own, before those of the coefficients.

use std::ops::Range;

use nalgebra::Vector3;

use super::input::RunInput;
use crate::align::{NO_SAG_MM, TimeMap};
use crate::machine::Axis;
use crate::model::Model;
use crate::solve::Matrix;

/// Where the parameters of the time maps stand among the columns of their run.
pub(super) struct Columns {
    pub(super) coefficients: usize,
    /// For each run the legs that have an offset: its first columns.
    pub(super) legs: Vec<Vec<usize>>,
    /// For each run: how much each slide follows later than the mean, for one of each of the columns.
    pub(super) delays: Vec<Vec<Vector3<f64>>>,
    /// For each run: by which share the time constant of each slide is longer, for one of each of the columns.
    pub(super) longer: Vec<Vec<Vector3<f64>>>,
    /// Whether the control drives as planned, and nothing of how it does is estimated.
    pub(super) as_planned: bool,
    /// Whether slides may follow unlike, or all that their columns explain is left to others.
    pub(super) unlike: bool,
    /// For each run whether its path has chords.
    cuts: Vec<bool>,
    /// For each run whether the control may have rounded them out.
    rounds: Vec<bool>,
}

/// Unit vectors that say how slides that move follow late, the mean of them not at all: that is in the offsets.
fn contrasts(moving: [bool; 3]) -> Vec<Vector3<f64>> {
    let slides: Vec<usize> = (0..3).filter(|k| moving[*k]).collect();
    let mut contrasts = Vec::new();
    for count in 1..slides.len() {
        // One slide against all before it.
        let mut contrast = Vector3::zeros();
        slides[..count].iter().for_each(|&k| contrast[k] = 1.0);
        contrast[slides[count]] = -(count as f64);
        contrasts.push(contrast.normalize());
    }
    contrasts
}

/// The same without what the model lets slides follow later by terms of its own.
fn without_named(contrasts: &[Vector3<f64>], named: &[Axis]) -> Vec<Vector3<f64>> {
    let unit = |axis: &Axis| Vector3::from_fn(|k, _| f64::from(u8::from(k == axis.index())));
    let in_them = |of: Vector3<f64>| contrasts.iter().map(|c| *c * c.dot(&of)).sum();
    let mut taken: Vec<Vector3<f64>> = Vec::new();
    let mut left = Vec::new();
    let vectors = named.iter().map(|axis| (in_them(unit(axis)), true));
    for (vector, is_taken) in vectors.chain(contrasts.iter().map(|c| (*c, false))) {
        let outside = taken.iter().chain(&left).fold(vector, |v, of| v - *of * of.dot(&v));
        // Nothing, or a share of a unit vector.
        if outside.norm() > 1e-6 {
            if is_taken { &mut taken } else { &mut left }.push(outside.normalize());
        }
    }
    left
}

impl Columns {
    pub(super) fn new(model: &Model, runs: &[RunInput]) -> Self {
        let named = model.parameters().iter().filter_map(|parameter| parameter.id.delays());
        let named: Vec<Axis> = named.collect();
        let all = |run: &RunInput| contrasts(run.alignment.moving);
        let unnamed = |run: &RunInput| without_named(&all(run), &named);
        Self {
            coefficients: model.parameters().len(),
            legs: runs.iter().map(|run| run.alignment.legs()).collect(),
            delays: runs.iter().map(unnamed).collect(),
            longer: runs.iter().map(all).collect(),
            as_planned: false,
            unlike: true,
            cuts: runs.iter().map(|run| run.alignment.chord_sag_mm > NO_SAG_MM).collect(),
            rounds: runs.iter().map(|run| run.alignment.rounds_chords()).collect(),
        }
    }

    /// How many columns a run has for itself; those of the coefficients come after them.
    pub(super) fn own(&self, run: usize) -> usize {
        self.longer(run).end + usize::from(self.cuts[run]) + usize::from(self.rounds[run])
    }

    /// How many columns there are in all.
    pub(super) fn total(&self) -> usize {
        self.coefficients + (0..self.legs.len()).map(|run| self.own(run)).sum::<usize>()
    }

    /// Column of the offset of a leg; `None` where the leg has no samples.
    pub(super) fn offset(&self, run: usize, leg: usize) -> Option<usize> {
        self.legs[run].iter().position(|l| *l == leg)
    }

    /// Column of the clock rate.
    pub(super) fn rate(&self, run: usize) -> usize {
        self.legs[run].len()
    }

    /// Column of the pace.
    pub(super) fn pace(&self, run: usize) -> usize {
        self.rate(run) + 1
    }

    /// Column of the time constant with which the slides follow.
    pub(super) fn following(&self, run: usize) -> usize {
        self.rate(run) + 2
    }

    /// Columns of the unequal delays.
    pub(super) fn delays(&self, run: usize) -> Range<usize> {
        let first = self.following(run) + 1;
        first..first + self.delays[run].len()
    }

    /// Columns of the unequal time constants.
    pub(super) fn longer(&self, run: usize) -> Range<usize> {
        let first = self.delays(run).end;
        first..first + self.longer[run].len()
    }

    /// Column of what the control cuts off chords; `None` where the path has none.
    pub(super) fn cut(&self, run: usize) -> Option<usize> {
        self.cuts[run].then(|| self.longer(run).end)
    }

    /// Column of the share by which the control rounds the corners of chords out; `None` where it cannot.
    pub(super) fn rounded(&self, run: usize) -> Option<usize> {
        self.rounds[run].then(|| self.longer(run).end + usize::from(self.cuts[run]))
    }

    /// Takes the uncertainty of a time map from the covariance of the columns of its run.
    pub(super) fn state_uncertainty(&self, run: usize, map: &mut TimeMap, covariance: &Matrix) {
        let sigma = |column: usize| covariance[(column, column)].max(0.0).sqrt();
        let (rate, pace) = (self.rate(run), self.pace(run));
        map.rate_sigma = sigma(rate);
        map.pace_sigma = sigma(pace);
        map.rate_pace_covariance = covariance[(rate, pace)];
        for (column, &leg) in self.legs[run].iter().enumerate() {
            map.offset_sigmas_s[leg] = sigma(column);
            map.offset_rate_covariances_s[leg] = covariance[(column, rate)];
            map.offset_pace_covariances_s[leg] = covariance[(column, pace)];
        }
    }

    /// Takes the uncertainty of how the control drove from the covariance of the columns of its run, with what is plausible of it.
    pub(super) fn state_driving(&self, run: usize, map: &mut TimeMap, covariance: &Matrix) {
        let following = self.following(run);
        map.following_sigma_s = covariance[(following, following)].max(0.0).sqrt();
        map.rounded_sigma = self.rounded(run).map_or(0.0, |k| covariance[(k, k)].max(0.0).sqrt());
        map.delay_sigmas_s = Vector3::from_fn(|slide, _| {
            let parts: Vec<(usize, f64)> =
                self.delays(run).zip(&self.delays[run]).map(|(k, c)| (k, c[slide])).collect();
            let with = |a: &(usize, f64)| {
                parts.iter().map(|b| a.1 * b.1 * covariance[(a.0, b.0)]).sum::<f64>()
            };
            parts.iter().map(with).sum::<f64>().max(0.0).sqrt()
        });
    }
}
