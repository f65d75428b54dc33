//! How much an arc tells in a set-up, before anything is measured.
//!
//! **Scale.** A coefficient is counted in the size that it is trusted with beforehand, a set-up error in
//! 0.1 mm, so the prior information is the identity.
//!
//! **Information.** An arc of `n` samples gives `A^T A n / (p sigma²)`, `A` the rows of `p` points evenly
//! along it, both ways, and `sigma²` the long-run variance of the noise: that is what correlated noise
//! leaves of many samples for columns that change slowly. The times do not enter: they cost next to
//! nothing (the prediction of the finished test counts them).

use rayon::prelude::*;

use super::candidates::SetUpCandidate;
use super::volume::Volume;
use crate::error::Result;
use crate::identify::ideal_poses;
use crate::machine::Machine;
use crate::model::{Coefficient, Situation, Term};
use crate::plan::Arc;
use crate::solve::{Choice, Matrix, Truncation, Tsqr, low_rank_factor};

/// Points of a half circle, each way.
const POINTS: f64 = 48.0;
/// What an arc tells less than this of, in units of the prior's information, it does not tell.
const NEGLIGIBLE: f64 = 1e-2;
/// A column of which the set-up errors of its own mounting leave less than this is rounding.
const ROUNDING: f64 = 1e-12;
/// Relative tolerance of a rank.
const TOLERANCE: f64 = 1e-10;
/// Set-up errors of a mounting.
pub(super) const SET_UPS: usize = 3;
/// A set-up error is known to this beforehand, mm: nobody sets up a ball worse than by 0.1 mm.
pub(super) const SET_UP_MM: f64 = 0.1;

/// The coefficients that are estimated, and the size of each that is trusted beforehand.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    pub(super) coefficients: Vec<Coefficient>,
    /// In the coefficient's unit.
    pub(super) sizes: Vec<f64>,
    /// What a set-up error is trusted with, mm.
    pub(super) set_up_mm: f64,
}

/// What one arc tells in one set-up.
#[derive(Debug, Clone)]
pub(super) struct ArcInformation {
    pub(super) set_up: usize,
    pub(super) arc: usize,
    /// Time that it takes, both ways, with what comes between, s.
    pub(super) seconds: f64,
    /// `F` with `F^T F` the information: a row a direction that it tells, a column a coefficient of the
    /// basis, the set-up errors of the mounting last.
    pub(super) factor: Matrix,
}

impl Basis {
    /// Situations of a set-up along an arc, both ways.
    fn situations(
        machine: &Machine,
        set_up: &SetUpCandidate,
        arc: &Arc,
    ) -> impl Iterator<Item = Situation> {
        let points = (POINTS * arc.sweep_rad.abs() / std::f64::consts::PI).ceil().max(6.0) as usize;
        // An even number: no point then lies where a slide turns round.
        let points = points + points % 2;
        ideal_poses(&set_up.mounting, arc, set_up.bar_mm, points)
            .filter_map(|pose| Situation::new(machine, &set_up.mounting, 0, &pose))
    }

    /// The row of one situation: coefficients in their sizes, then the set-up errors of its mounting.
    pub(super) fn row(&self, at: &Situation) -> Vec<f64> {
        let mut value = [0.0];
        let mut row = Vec::with_capacity(self.coefficients.len() + SET_UPS);
        for (coefficient, size) in self.coefficients.iter().zip(&self.sizes) {
            coefficient.columns(at, &mut value);
            row.push(value[0] * size);
        }
        row.extend(at.direction.iter().map(|along| along * self.set_up_mm));
        row
    }

    /// What an arc tells in a set-up, with this long-run variance of a reading.
    pub(super) fn information(
        &self,
        machine: &Machine,
        set_up: &SetUpCandidate,
        arc: &Arc,
        sample_rate_hz: f64,
        feed_mm_s: f64,
        variance_mm2: f64,
    ) -> Matrix {
        let rows: Vec<Vec<f64>> =
            Self::situations(machine, set_up, arc).map(|at| self.row(&at)).collect();
        let length_mm = arc.circle_radius_mm(set_up.bar_mm) * arc.sweep_rad.abs();
        let samples = 2.0 * length_mm / feed_mm_s * sample_rate_hz;
        let weight = (samples / rows.len() as f64 / variance_mm2).sqrt();
        let columns = self.coefficients.len() + SET_UPS;
        let by_column = Matrix::from_fn(columns, rows.len(), |k, i| rows[i][k] * weight);
        low_rank_factor(&by_column.times_own_transpose(), NEGLIGIBLE)
    }
}

/// Of coefficients, visited in this order, those that at most `most` of the set-ups can tell apart, by the
/// arcs that are given for each; the set-up errors of every mounting are unknown besides.
///
/// The set-ups are taken one after the other, always the one that adds most.
pub(super) fn tellable(
    machine: &Machine,
    order: &[Coefficient],
    set_ups: &[(&SetUpCandidate, Vec<&Arc>)],
    most: usize,
) -> Result<Choice> {
    let all = Basis { coefficients: order.to_vec(), sizes: vec![1.0; order.len()], set_up_mm: 1.0 };
    let columns = order.len() + SET_UPS;
    let parts: Vec<Result<(Matrix, Vec<f64>)>> = set_ups
        .par_iter()
        .map(|(set_up, arcs)| {
            // Set-up errors first: what is below them in the triangle is what they do not explain.
            let mut tsqr = Tsqr::new(columns);
            let mut squares = vec![0.0; order.len()];
            for arc in arcs {
                for at in Basis::situations(machine, set_up, arc) {
                    let row = all.row(&at);
                    let (coefficients, balls) = row.split_at(order.len());
                    tsqr.push(&[balls, coefficients].concat(), 0.0);
                    // What the columns would be if nothing in them cancelled.
                    let lever_mm = set_up.mounting.tool_ball_mm.norm() + at.pose.position_mm.norm();
                    for (square, c) in squares.iter_mut().zip(order) {
                        let basis = c.basis(&at.pose);
                        let lever = if c.component.is_angular() { lever_mm } else { 1.0 };
                        *square += (basis * lever).powi(2);
                    }
                }
            }
            Ok((tsqr.finish()?.r().clone(), squares))
        })
        .collect();
    let parts = parts.into_iter().collect::<Result<Vec<_>>>()?;
    let visit: Vec<usize> = (0..order.len()).collect();
    let told = |chosen: &[usize]| -> Result<Choice> {
        let mut rows = Tsqr::new(order.len());
        let mut squares = vec![0.0; order.len()];
        for &part in chosen {
            let (r, of_part) = &parts[part];
            for i in SET_UPS..columns {
                rows.push(&r.row(i)[SET_UPS..], 0.0);
            }
            for (square, more) in squares.iter_mut().zip(of_part) {
                *square += more;
            }
        }
        // A column that is shorter than this was the set-up's alone.
        let references: Vec<f64> =
            squares.iter().map(|s| s.sqrt() * ROUNDING / crate::solve::VANISHED).collect();
        rows.finish()?.choose(&visit, &references, Truncation::Relative(TOLERANCE))
    };
    let (mut chosen, mut best) = (Vec::new(), Choice::default());
    for _ in 0..most.min(parts.len()) {
        let with = |next: usize| [chosen.as_slice(), &[next]].concat();
        let others: Vec<usize> = (0..parts.len()).filter(|next| !chosen.contains(next)).collect();
        let tried: Vec<Result<Choice>> = others.par_iter().map(|&next| told(&with(next))).collect();
        let tried = tried.into_iter().collect::<Result<Vec<_>>>()?;
        let Some(place) = (0..tried.len()).rev().max_by_key(|&k| tried[k].kept.len()) else {
            break;
        };
        if tried[place].kept.len() <= best.kept.len() {
            break;
        }
        best = tried[place].clone();
        chosen.push(others[place]);
    }
    Ok(best)
}

/// The basis of coefficients with sizes that each displace the tool by `unknown_mm` rms over a volume.
pub(super) fn basis(volume: &Volume, unknown_mm: f64, set_up_mm: f64) -> Basis {
    let sizes = volume.sizes().iter().map(|size| unknown_mm / size.max(1e-9)).collect();
    Basis { coefficients: volume.coefficients().to_vec(), sizes, set_up_mm }
}
