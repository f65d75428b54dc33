//! The error of the whole working volume, and how well a test knows it.
//!
//! **Field.** At a position `p` with the senses `b`, the coefficients `x` displace the tool against the
//! workpiece by `v(p, b) = J(p, b) x` (paper, Eq. 4), mm, for the tool of one mounting. A rigid motion
//! of the workpiece, `t + w × p`, is no error of the machine: it is how the workpiece was set up. So the
//! rigid motion that fits `v` best over the grid and the senses is taken off, for every column alike.
//!
//! **Uncertainty.** With `C` the covariance of `x`, the standard deviation at a point is
//!
//! `sigma(p)² = mean over b of trace(J'(p, b) C J'(p, b)^T)`,
//!
//! the length of the vector of errors, not one of its components. The four sets of senses `+++`, `+--`,
//! `-+-`, `--+` have the same mean as all eight, because no two slides' hysteresis is confounded in them.

use nalgebra::Vector3;

use crate::machine::{Axis, Machine, Mounting, Pose};
use crate::model::{Coefficient, Model, Situation, Term};
use crate::solve::Matrix;

const SENSES: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Rows of the field a point has: senses times X, Y, Z.
const ROWS: usize = 3 * SENSES.len();

/// The error field of some coefficients over a grid in a box of machine coordinates.
#[derive(Debug, Clone)]
pub struct Volume {
    range_mm: [[f64; 2]; 3],
    points_mm: Vec<Vector3<f64>>,
    coefficients: Vec<Coefficient>,
    /// [`ROWS`] rows a point, a column a coefficient, without the best rigid motion.
    field: Matrix,
    /// Root mean square of every column over the grid, rigid motion included, mm per unit.
    sizes: Vec<f64>,
}

/// The standard deviation of the volumetric error at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSigma {
    /// Machine coordinates, mm.
    pub position_mm: Vector3<f64>,
    /// Standard deviation of the length of the error vector, mm.
    pub sigma_mm: f64,
}

/// The standard deviation of the volumetric error over a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeSigma {
    /// Lowest and highest machine coordinate of X, Y and Z, mm.
    pub range_mm: [[f64; 2]; 3],
    /// The points, Z fastest, then Y, then X.
    pub points: Vec<PointSigma>,
    /// Root mean square over the points, mm.
    pub rms_mm: f64,
    /// The point where it is largest.
    pub worst: PointSigma,
}

impl Volume {
    /// The field of these coefficients with the tool of a mounting, over `steps` points an axis (two at
    /// the least), the ends of the ranges included.
    pub fn new(
        machine: &Machine,
        mounting: &Mounting,
        range_mm: [[f64; 2]; 3],
        steps: usize,
        coefficients: &[Coefficient],
    ) -> Self {
        let steps = steps.max(2);
        let at = |axis: usize, k: usize| {
            let [low, high] = range_mm[axis];
            low + (high - low) * k as f64 / (steps - 1) as f64
        };
        let points_mm: Vec<Vector3<f64>> = (0..steps.pow(3))
            .map(|k| {
                Vector3::new(at(0, k / (steps * steps)), at(1, k / steps % steps), at(2, k % steps))
            })
            .collect();
        let mut terms: Vec<Box<dyn Term>> = Vec::new();
        for &coefficient in coefficients {
            terms.push(Box::new(coefficient));
        }
        let model = Model::new(machine, vec![*mounting], terms);
        let rows = points_mm.len() * ROWS;
        let mut field = Matrix::zeros(rows, coefficients.len());
        let mut rigid: Vec<Vec<f64>> = vec![Vec::new(); 6];
        for (point, position_mm) in points_mm.iter().enumerate() {
            for (of_senses, senses) in SENSES.iter().enumerate() {
                let pose = Pose { position_mm: *position_mm, sense: Vector3::from(*senses) };
                for axis in Axis::ALL {
                    let along = Vector3::ith(axis.index(), 1.0);
                    let at = Situation::along(machine, mounting, 0, &pose, along);
                    let row = point * ROWS + of_senses * 3 + axis.index();
                    model.row(&at, field.row_mut(row));
                    // u . t, and u . (w × p) = w . (p × u).
                    let turned = position_mm.cross(&along);
                    for (column, value) in rigid.iter_mut().zip(along.iter().chain(turned.iter())) {
                        column.push(*value);
                    }
                }
            }
        }
        let per_row = (rows as f64).sqrt().recip();
        let sizes = field.column_norms().into_iter().map(|norm| norm * per_row).collect();
        take_off(&mut field, rigid);
        Self { range_mm, points_mm, coefficients: coefficients.to_vec(), field, sizes }
    }

    /// The working volume: the travel of every axis.
    pub fn travel_mm(machine: &Machine) -> [[f64; 2]; 3] {
        Axis::ALL.map(|axis| machine.slide(axis).travel_mm)
    }

    /// The coefficients, in the order of the columns.
    pub fn coefficients(&self) -> &[Coefficient] {
        &self.coefficients
    }

    /// Root mean square displacement over the grid that one unit of each coefficient makes, a rigid
    /// motion of the workpiece included, mm per unit.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// `W` with `x^T W x` the mean square of the volumetric error over grid and senses, mm².
    pub fn mean_square(&self) -> Matrix {
        let n = self.coefficients.len();
        let mut w = Matrix::zeros(n, n);
        let share = (self.points_mm.len() * SENSES.len()) as f64;
        for i in 0..self.field.rows() {
            let row = self.field.row(i).to_vec();
            for (k, &a) in row.iter().enumerate() {
                for (out, &b) in w.row_mut(k).iter_mut().zip(&row) {
                    *out += a * b / share;
                }
            }
        }
        w
    }

    /// Rows `J'` of one point, divided by the root of the number of senses, so that
    /// `trace(J' C J'^T)` is `sigma²` there.
    pub fn rows_at(&self, point: usize) -> Matrix {
        let scale = (SENSES.len() as f64).sqrt().recip();
        Matrix::from_fn(ROWS, self.coefficients.len(), |i, k| {
            self.field[(point * ROWS + i, k)] * scale
        })
    }

    /// Counts every coefficient in a size of its own from here on.
    pub(super) fn scale(&mut self, sizes: &[f64]) {
        for i in 0..self.field.rows() {
            for (value, size) in self.field.row_mut(i).iter_mut().zip(sizes) {
                *value *= size;
            }
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.points_mm.len()
    }

    /// Standard deviation over the grid for a covariance of the coefficients, in their order.
    pub fn sigma(&self, covariance: &Matrix) -> VolumeSigma {
        let points: Vec<PointSigma> = self
            .points_mm
            .iter()
            .enumerate()
            .map(|(point, &position_mm)| {
                let rows = self.rows_at(point);
                let spread = rows.times(covariance);
                let variance: f64 = (0..ROWS)
                    .map(|i| rows.row(i).iter().zip(spread.row(i)).map(|(a, b)| a * b).sum::<f64>())
                    .sum();
                PointSigma { position_mm, sigma_mm: variance.max(0.0).sqrt() }
            })
            .collect();
        let squares: f64 = points.iter().map(|point| point.sigma_mm.powi(2)).sum();
        let worst = points.iter().skip(1).fold(points[0], |worst, point| {
            if point.sigma_mm > worst.sigma_mm { *point } else { worst }
        });
        let rms_mm = (squares / points.len() as f64).sqrt();
        VolumeSigma { range_mm: self.range_mm, points, rms_mm, worst }
    }
}

/// Takes off every column of the field its projection on the rigid motions.
fn take_off(field: &mut Matrix, mut rigid: Vec<Vec<f64>>) {
    for k in 0..rigid.len() {
        let (before, rest) = rigid.split_at_mut(k);
        let motion = &mut rest[0];
        for _ in 0..2 {
            for q in before.iter() {
                let along: f64 = q.iter().zip(motion.iter()).map(|(q, m)| q * m).sum();
                motion.iter_mut().zip(q).for_each(|(m, q)| *m -= along * q);
            }
        }
        let length = motion.iter().map(|m| m * m).sum::<f64>().sqrt();
        for m in motion.iter_mut() {
            *m /= length;
        }
        let mut along = vec![0.0; field.columns()];
        for (i, m) in motion.iter().enumerate() {
            along.iter_mut().zip(field.row(i)).for_each(|(sum, value)| *sum += m * value);
        }
        for (i, m) in motion.iter().enumerate() {
            field.row_mut(i).iter_mut().zip(&along).for_each(|(value, sum)| *value -= m * sum);
        }
    }
}

/// A covariance of some named parameters as one of the coefficients of a volume; what is not among the
/// parameters has the variance zero.
pub fn of_coefficients(volume: &Volume, names: &[&str], covariance: &Matrix) -> Matrix {
    let places: Vec<Option<usize>> = volume
        .coefficients()
        .iter()
        .map(|c| names.iter().position(|name| *name == c.to_string()))
        .collect();
    let n = places.len();
    Matrix::from_fn(n, n, |i, k| match (places[i], places[k]) {
        (Some(i), Some(k)) => covariance[(i, k)],
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{ChainErrors, SlideError};

    fn hu40t() -> (Machine, Mounting) {
        let machine = Machine::read("machines/hu40t.toml".as_ref()).unwrap();
        let tool_ball_mm = Vector3::new(0.0, 0.0, -200.0);
        (machine, Mounting { coincidence_mm: Vector3::zeros(), tool_ball_mm })
    }

    fn named(names: &[&str]) -> Vec<Coefficient> {
        names.iter().map(|name| Coefficient::parse(name).unwrap()).collect()
    }

    #[test]
    fn a_rigid_motion_of_the_workpiece_is_no_error() {
        let (machine, mounting) = hu40t();
        // On this machine a tilt of X's table as a whole turns the workpiece, and so does its slide's
        // displacement across in proportion to the way.
        let rigid = named(&["EXX0", "EAX0", "EBX0", "ECX0", "EYZ0", "EBZ0"]);
        let volume = Volume::new(&machine, &mounting, Volume::travel_mm(&machine), 3, &rigid);
        for i in 0..volume.field.rows() {
            for (k, coefficient) in rigid.iter().enumerate() {
                assert!(volume.field[(i, k)].abs() < 1e-9, "{coefficient}");
            }
        }
        assert!((volume.sizes()[0] - 3.0_f64.sqrt().recip()).abs() < 1e-12, "1 mm of 3 components");
    }

    /// A scale error of one axis over its travel, in closed form: after the best rigid motion, a third of
    /// the squares over an even grid `-a .. a` of five points is `a²/2`.
    #[test]
    fn the_sigma_of_a_scale_is_its_way_from_the_middle() {
        let (machine, mounting) = hu40t();
        let scale = named(&["EYY1"]);
        let volume = Volume::new(&machine, &mounting, [[-200.0, 200.0]; 3], 5, &scale);
        let sigma = volume.sigma(&Matrix::from_fn(1, 1, |_, _| 1e-12));
        assert!((sigma.rms_mm - 200e-6 * 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((sigma.worst.sigma_mm - 200e-6).abs() < 1e-12);
        assert!((sigma.worst.position_mm.y.abs() - 200.0).abs() < 1e-12);
        let square = volume.mean_square()[(0, 0)] * 1e-12;
        assert!((square.sqrt() - sigma.rms_mm).abs() < 1e-15);
    }

    /// The senses that are looked at stand for all eight, and the field for the exact chain.
    #[test]
    fn four_sets_of_senses_have_the_mean_of_all_eight() {
        let (machine, mounting) = hu40t();
        let hysteresis = named(&["EXXb", "EYYb", "EAZb", "ECZ1"]);
        let range_mm = [[-100.0, 100.0], [-50.0, 80.0], [0.0, 90.0]];
        let volume = Volume::new(&machine, &mounting, range_mm, 2, &hysteresis);
        let values = [2e-3, -3e-3, 1e-5, 4e-8];
        let by_field = volume.sigma(&Matrix::from_fn(4, 4, |i, k| values[i] * values[k])).rms_mm;
        let mut displacements = Vec::new();
        let mut motions: Vec<Vec<f64>> = vec![Vec::new(); 6];
        for position_mm in &volume.points_mm {
            for k in 0..8 {
                let sense = Vector3::from_fn(|i, _| if k >> i & 1 == 0 { 1.0 } else { -1.0 });
                let mut errors = ChainErrors::zero();
                let slide = |t: [f64; 3], r: [f64; 3]| SlideError {
                    translation_mm: Vector3::from(t),
                    rotation_rad: Vector3::from(r),
                };
                errors.slides[0] = slide([values[0] * sense.x, 0.0, 0.0], [0.0; 3]);
                errors.slides[1] = slide([0.0, values[1] * sense.y, 0.0], [0.0; 3]);
                let rotation = [values[2] * sense.z, 0.0, values[3] * position_mm.z];
                errors.slides[2] = slide([0.0; 3], rotation);
                let ball_mm = |errors| machine.ball_vector_mm(&mounting, position_mm, errors);
                let moved = ball_mm(&errors) - ball_mm(&ChainErrors::zero());
                for i in 0..3 {
                    let along = Vector3::ith(i, 1.0);
                    displacements.push(moved[i]);
                    let turned = position_mm.cross(&along);
                    for (motion, value) in motions.iter_mut().zip(along.iter().chain(turned.iter()))
                    {
                        motion.push(*value);
                    }
                }
            }
        }
        let mut column = Matrix::from_fn(displacements.len(), 1, |i, _| displacements[i]);
        take_off(&mut column, motions);
        let squares: f64 = column.column(0).iter().map(|v| v * v).sum();
        let by_chain = (squares / (displacements.len() / 3) as f64).sqrt();
        assert!((by_field / by_chain - 1.0).abs() < 1e-5, "{by_field} {by_chain}");
    }
}
