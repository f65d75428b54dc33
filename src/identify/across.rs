//! What the length between the balls tells only by how the machine is bent.
//!
//! Displacements across the plane of a bar that never leaves it, and angles that have no lever at the place of a test, change a length `L`
//! by what is wrong there already: where a ball is `z` off the plane, by `z / L` of what moves across it. Of `z` one plane
//! tells nothing, it is known as well as a ball is set up, and so little is `z / L`: nothing plus or minus a thousandth. What the
//! readings tell is a product of two faults of which they tell neither.
//!
//! A fit needs both all the same: the product shows in readings of 0.05 um, and what it leaves open in the errors within the plane is
//! as large as their noise. But where it came to rest along them, in one of several ways that do the same, is no estimate of either.
//! So the errors of the machine that are mapped and compensated have nothing of them but what is plausible.

use nalgebra::{Matrix3, Vector3};

use super::input::RunInput;
use crate::align::{Part, Sample};
use crate::machine::Axis;
use crate::model::{Ball, LocalShape, Model, ParameterId};
use crate::solve::Matrix;

/// Places of a run that are looked at: as many as tell in which directions its bar goes.
const PLACES: usize = 100;

/// What of the errors is seen by a machine that is not bent.
#[derive(Debug)]
pub(super) struct Across {
    vectors: Vec<Vector>,
}

/// Parameters that are one vector.
#[derive(Debug)]
struct Vector {
    of: Of,
    /// Those along X, Y and Z, or about them.
    parameters: [Option<usize>; 3],
    /// The projection on what is seen of it; `None` where all of it is.
    seen: Option<Matrix3<f64>>,
}

/// What is a vector.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Of {
    Slide { slide: Axis, shape: LocalShape, turns: bool },
    Ball(Ball, usize),
}

impl Across {
    /// By all runs, beyond what a ball is set up to.
    pub(super) fn of(model: &Model, runs: &[RunInput]) -> Self {
        let mut vectors = vectors(model);
        let mut squares = vec![Squares::default(); vectors.len()];
        let mut row = vec![0.0; model.parameters().len()];
        let set_up_mm = model.machine().plausible().set_up_mm;
        for run in runs {
            for sample in places(run) {
                model.row(&model.situation(&sample.pose, &sample.motion, run.mounting), &mut row);
                for (squares, vector) in squares.iter_mut().zip(&vectors) {
                    let by_set_up = match vector.of {
                        Of::Slide { turns: true, .. } => set_up_mm,
                        Of::Ball(_, mounting) if mounting != run.mounting => continue,
                        _ => set_up_mm / run.nominal_mm,
                    };
                    squares.add(vector.in_row(&row) / by_set_up);
                }
            }
        }
        for (vector, squares) in vectors.iter_mut().zip(&squares) {
            vector.seen = squares.more_than_one();
        }
        Self { vectors }
    }

    /// Takes what is not seen out of values of the parameters.
    pub(super) fn leave_out(&self, values: &mut [f64]) {
        self.vectors.iter().for_each(|vector| vector.project(values));
    }

    /// Takes it out of the rows of a matrix, one for each parameter.
    pub(super) fn leave_out_rows(&self, matrix: &Matrix) -> Matrix {
        let column = |k: usize| {
            let mut column: Vec<f64> = (0..matrix.rows()).map(|i| matrix[(i, k)]).collect();
            self.leave_out(&mut column);
            column
        };
        let columns: Vec<Vec<f64>> = (0..matrix.columns()).map(column).collect();
        Matrix::from_fn(matrix.rows(), matrix.columns(), |i, k| columns[k][i])
    }

    /// Adds what is plausible of what is not seen: the parameters (rows) where each of them (column) is off by its standard deviation.
    pub(super) fn add_plausible(&self, open: &mut Matrix, plausible: &[Option<f64>]) {
        for Vector { parameters, seen, .. } in &self.vectors {
            let Some(seen) = seen else { continue };
            let unseen = Matrix3::identity() - seen;
            for (i, row) in parameters.iter().enumerate() {
                for (k, column) in parameters.iter().enumerate() {
                    if let (Some(row), Some(column)) = (row, column) {
                        let sigma = plausible[*column].unwrap_or(0.0);
                        open[(*row, *column)] += unseen[(i, k)] * sigma;
                    }
                }
            }
        }
    }
}

impl Vector {
    fn in_row(&self, row: &[f64]) -> Vector3<f64> {
        self.parameters.map(|at| at.map_or(0.0, |at| row[at])).into()
    }

    /// Leaves what is seen of its own of these values.
    fn project(&self, values: &mut [f64]) {
        let Some(seen) = self.seen else { return };
        let own = seen * self.in_row(values);
        for (at, value) in self.parameters.iter().zip(&own) {
            if let Some(at) = at {
                values[*at] = *value;
            }
        }
    }
}

/// Sums of squares of vectors.
#[derive(Debug, Clone, Default)]
struct Squares {
    sum: Matrix3<f64>,
    count: f64,
}

impl Squares {
    fn add(&mut self, of: Vector3<f64>) {
        self.sum += of * of.transpose();
        self.count += 1.0;
    }

    /// The projection on the directions in which the root of the mean square is more than one; `None` where it is so in all.
    fn more_than_one(&self) -> Option<Matrix3<f64>> {
        let squares = self.sum.symmetric_eigen();
        let directions = squares.eigenvalues.iter().zip(squares.eigenvectors.column_iter());
        let more = directions.filter(|(square, _)| **square > self.count);
        let kept: Vec<Vector3<f64>> = more.map(|(_, of)| of.into_owned()).collect();
        (kept.len() < 3).then(|| kept.iter().map(|of| of * of.transpose()).sum())
    }
}

/// Some of its samples on arcs.
fn places(run: &RunInput) -> impl Iterator<Item = &Sample> {
    let on_arc = |sample: &&Sample| matches!(sample.part, Part::Arc(_));
    let each = run.samples().len().div_ceil(PLACES).max(1);
    run.samples().iter().step_by(each).filter(on_arc)
}

/// The errors about the middle of a test and those of the set-up.
fn vectors(model: &Model) -> Vec<Vector> {
    let mut vectors: Vec<Vector> = Vec::new();
    let parameters = model.parameters().iter().enumerate();
    // Without anything plausible the readings alone decide.
    for (index, parameter) in parameters.filter(|(_, of)| of.plausible.is_some()) {
        let (of, direction) = match parameter.id {
            ParameterId::Local(local) => {
                let (slide, shape, turns) =
                    (local.slide, local.shape, local.component.is_angular());
                (Of::Slide { slide, shape, turns }, local.component.direction())
            }
            ParameterId::SetUp(set_up, mounting) => {
                (Of::Ball(set_up.ball, mounting), set_up.axis.index())
            }
            _ => continue,
        };
        let known = vectors.iter().position(|vector| vector.of == of);
        let at = known.unwrap_or(vectors.len());
        if known.is_none() {
            vectors.push(Vector { of, parameters: [None; 3], seen: None });
        }
        vectors[at].parameters[direction] = Some(index);
    }
    vectors
}
