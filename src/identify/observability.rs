//! What can be told apart: rank and condition of columns over ideal paths, and over the volume.
//!
//! Ideal means: circles without chords or rounding, each arc by itself. The identities of the sphere
//! hold there to rounding, so a rank is a fact about geometry and not about noise. What noise lets a real
//! test see is the business of [`identify`](super::identify()).

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::words::sentence;
use crate::error::{Error, Result};
use crate::machine::{Axis, Machine, Mounting, Pose};
use crate::model::{Coefficient, Model, Motion, Parameter, ParameterId, Situation, terms};
use crate::plan::Arc;
use crate::solve::{Choice, NullDirection, Spectrum, Triangle, Truncation, Tsqr};

/// Singular values of unit columns below this part of the largest are rounding.
pub const TOLERANCE: f64 = 1e-10;
/// Poses of the volume, as many as the paper's.
pub const POSES: usize = 8000;
/// Points of an arc, half a step from its ends: an even number, so none lies where a slide turns round.
pub const POINTS: usize = 240;

/// Rows of all 90 coefficients and the six set-up errors of each mounting, while they are gathered.
pub struct Gather<'a> {
    model: Model<'a>,
    tsqr: Tsqr,
    /// Squared norms that the columns would have if nothing in them cancelled.
    squares: Vec<f64>,
}

impl<'a> Gather<'a> {
    /// No rows yet, of all columns.
    pub fn new(machine: &'a Machine, mountings: &[Mounting]) -> Result<Self> {
        Self::without(machine, mountings, &[])
    }

    /// No rows yet, of all columns but some.
    pub fn without(machine: &'a Machine, mountings: &[Mounting], gone: &[&str]) -> Result<Self> {
        let places: Vec<String> = (0..mountings.len()).map(|k| format!("P{k}")).collect();
        Self::named(machine, mountings, &places, gone)
    }

    /// The same with names for the mountings, which the names of their set-up errors end with.
    pub fn named(
        machine: &'a Machine,
        mountings: &[Mounting],
        places: &[String],
        gone: &[&str],
    ) -> Result<Self> {
        let mut names = vec!["all".to_owned()];
        names.extend(gone.iter().map(|name| format!("-{name}")));
        let model = Model::new(machine, mountings.to_vec(), terms(&names, places)?);
        let columns = model.parameters().len();
        Ok(Self { model, tsqr: Tsqr::new(columns), squares: vec![0.0; columns] })
    }

    /// A row, and the sizes of the numbers that were subtracted from each other in it: levers and
    /// directions are differences of positions.
    fn push(&mut self, at: &Situation, direction_size: &Vector3<f64>) {
        let mut row = vec![0.0; self.squares.len()];
        self.model.row(at, &mut row);
        self.tsqr.push(&row, 0.0);
        let mounting = &self.model.mountings()[at.mounting];
        let lever_size = mounting.tool_ball_mm.abs() + at.pose.position_mm.abs();
        let turned = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            lever_size[j] * direction_size[k] + lever_size[k] * direction_size[j]
        };
        for (square, parameter) in self.squares.iter_mut().zip(self.model.parameters()) {
            let size = match parameter.id {
                ParameterId::SetUp(_, mounting) if mounting != at.mounting => 0.0,
                ParameterId::SetUp(set_up, _) => direction_size[set_up.axis.index()],
                ParameterId::Local(_) | ParameterId::Amplitude | ParameterId::Delay(_) => 0.0,
                ParameterId::Coefficient(c) => {
                    let basis = c.basis(&at.pose).abs();
                    let i = c.component.direction();
                    basis * if c.component.is_angular() { turned(i) } else { direction_size[i] }
                }
            };
            *square += size * size;
        }
    }

    /// Cartesian rows, three a pose, of random poses in a working volume, mm, for the first mounting;
    /// every slide came from either side, or has not yet moved.
    pub fn volume(&mut self, range_mm: [[f64; 2]; 3], poses: usize) {
        let at = self.model.mountings()[0];
        let mut random = Pcg64Mcg::seed_from_u64(8000);
        for _ in 0..poses {
            let position_mm =
                Vector3::from(range_mm.map(|[low, high]| random.random_range(low..high)));
            let sense = Vector3::from_fn(|_, _| f64::from(random.random_range(-1..=1_i32)));
            let pose = Pose { position_mm, sense };
            for axis in Axis::ALL {
                let along = Vector3::ith(axis.index(), 1.0);
                let situation = Situation::along(self.model.machine(), &at, 0, &pose, along);
                self.push(&situation, &along);
            }
        }
    }

    /// Projected rows of ideal arcs, forward and backward, on a bar of this length, with `points` an arc.
    ///
    /// Each arc stands by itself: a slide that stands still during it has the sense 0 there.
    pub fn drive(&mut self, mounting: usize, arcs: &[Arc], bar_mm: f64, points: usize) {
        let at = self.model.mountings()[mounting];
        for arc in arcs {
            for pose in ideal_poses(&at, arc, bar_mm, points) {
                let situation = self.model.situation(&pose, &Motion::REST, mounting);
                let size = (pose.position_mm.abs() + at.coincidence_mm.abs()) / bar_mm;
                self.push(&situation, &size);
            }
        }
    }

    /// What the rows see.
    pub fn finish(self) -> Result<Sight> {
        Ok(Sight {
            triangle: self.tsqr.finish()?,
            references: self.squares.into_iter().map(f64::sqrt).collect(),
            parameters: self.model.parameters().to_vec(),
        })
    }
}

/// Poses on an ideal arc driven forward and then backward, `points` each way, on a bar of this length; a
/// slide that stands still on it has the sense 0.
pub fn ideal_poses(
    mounting: &Mounting,
    arc: &Arc,
    bar_mm: f64,
    points: usize,
) -> impl Iterator<Item = Pose> {
    let coincidence_mm = mounting.coincidence_mm;
    [arc.clone(), arc.reversed("")].into_iter().flat_map(move |arc| {
        (0..points).map(move |k| {
            let direction = arc.at((k as f64 + 0.5) / points as f64);
            let tangent = arc.normal.cross(&direction) * arc.sweep_rad.signum();
            Pose {
                position_mm: coincidence_mm + direction.into_inner() * bar_mm,
                sense: tangent.map(|t| if t.abs() < 1e-9 { 0.0 } else { t.signum() }),
            }
        })
    })
}

/// The triangle of all columns, with the names of the columns.
#[derive(Debug, Clone)]
pub struct Sight {
    triangle: Triangle,
    references: Vec<f64>,
    parameters: Vec<Parameter>,
}

/// Rank and condition of a choice of columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Number of columns.
    pub columns: usize,
    /// Rank at [`TOLERANCE`] on columns of unit length; a vanished column stays zero.
    pub rank: usize,
    /// Condition number of the columns of unit length: largest singular value over the smallest of the
    /// *retained* directions. With the full rank, that is the condition number of the matrix.
    pub condition: f64,
    /// Condition number of the columns as they are, in mm, rad and their powers; rounding only, without
    /// the full rank.
    pub raw_condition: f64,
}

impl Sight {
    /// Indices of the columns that are wanted by their bare name, without the mounting.
    pub fn columns(&self, keep: impl Fn(&str) -> bool) -> Vec<usize> {
        let kept = |k: &usize| keep(&self.parameters[*k].bare_name());
        (0..self.parameters.len()).filter(kept).collect()
    }

    /// Name of a column.
    pub fn name(&self, column: usize) -> &str {
        &self.parameters[column].name
    }

    /// What a column stands for.
    pub fn parameter(&self, column: usize) -> &Parameter {
        &self.parameters[column]
    }

    /// The same without its name.
    pub(super) fn id(&self, column: usize) -> ParameterId {
        self.parameters[column].id
    }

    fn spectrum(&self, columns: &[usize]) -> Result<(Triangle, Spectrum)> {
        let references: Vec<f64> = columns.iter().map(|&k| self.references[k]).collect();
        let narrow = self.triangle.select(columns)?;
        let spectrum = Spectrum::with_references(&narrow, &references)?;
        Ok((narrow, spectrum))
    }

    /// Rank and condition of these columns.
    ///
    /// # Errors
    /// A rank that hangs on the tolerance: it would be no rank of an ideal path.
    pub fn look(&self, columns: &[usize]) -> Result<Seen> {
        let (narrow, spectrum) = self.spectrum(columns)?;
        let rank = spectrum.rank(TOLERANCE);
        if (spectrum.rank(1e-8), spectrum.rank(1e-12)) != (rank, rank) {
            return Err(Error::input(format!(
                "the rank of {} columns is not clear: {} to {rank} to {} directions between the tolerances 1e-8 and 1e-12",
                columns.len(),
                spectrum.rank(1e-8),
                spectrum.rank(1e-12)
            )));
        }
        Ok(Seen {
            columns: columns.len(),
            rank,
            condition: spectrum.condition_of(rank),
            raw_condition: narrow.condition()?,
        })
    }

    /// Condition number of these columns at unit length, infinite without the full rank.
    pub fn full_condition(&self, columns: &[usize]) -> Result<f64> {
        let (_, spectrum) = self.spectrum(columns)?;
        let full = spectrum.rank(TOLERANCE) == columns.len();
        Ok(if full { spectrum.condition() } else { f64::INFINITY })
    }

    /// Rank of these columns.
    pub fn rank(&self, columns: &[usize]) -> Result<usize> {
        Ok(self.spectrum(columns)?.1.rank(TOLERANCE))
    }

    /// An order in which set-up errors and translations come first and angular errors last, those of X
    /// after the others: so a rotation is told by the translations that it acts as, and never the other
    /// way round.
    pub fn translations_first(&self, columns: &[usize]) -> Vec<usize> {
        let rank = |k: &usize| match self.id(*k).coefficient() {
            None => 0,
            Some(c) if c.component.is_angular() => 4 - c.slide.index(),
            Some(_) => 1,
        };
        let mut order = columns.to_vec();
        order.sort_by_key(rank);
        order
    }

    /// Which columns to keep, considered in this order, at [`TOLERANCE`].
    pub fn choose(&self, order: &[usize]) -> Result<Choice> {
        self.triangle.choose(order, &self.references, Truncation::Relative(TOLERANCE))
    }

    /// How the last of these columns follows from the others, which are independent: by the translations
    /// of the same slide and power if they suffice, removed before or not; otherwise by the columns that
    /// are there.
    pub(super) fn explained(&self, column: usize, with: &[usize]) -> Result<NullDirection> {
        let of = self.id(column).coefficient();
        if let Some(of) = of.filter(|of| of.component.is_angular()) {
            let same = |c: Coefficient| {
                (c.slide, c.power) == (of.slide, of.power) && !c.component.is_angular()
            };
            let mut few: Vec<usize> = (0..self.parameters.len())
                .filter(|&k| self.id(k).coefficient().is_some_and(same))
                .collect();
            few.push(column);
            if self.rank(&few)? < few.len() {
                return self.combination(&few);
            }
        }
        self.combination(with)
    }

    /// How the last of these columns follows from the others, which are independent.
    fn combination(&self, columns: &[usize]) -> Result<NullDirection> {
        let (_, spectrum) = self.spectrum(columns)?;
        let last = columns.len() - 1;
        let alone = NullDirection { parts: vec![(last, 1.0)], effect: 0.0 };
        let mut direction = spectrum.null_directions(last, 1e-6).pop().unwrap_or(alone);
        // One order whatever the rounding: the dependent column, then the others as they stand.
        direction.parts.sort_by_key(|&(k, _)| (k != last, k));
        let unit = direction.parts.first().map_or(1.0, |part| part.1);
        for (k, share) in &mut direction.parts {
            *k = columns[*k];
            *share /= unit;
        }
        direction.effect *= unit.abs().recip();
        Ok(direction)
    }

    /// A direction in words.
    pub fn told(&self, direction: &NullDirection) -> String {
        sentence(direction, &self.parameters)
    }
}
