//! The rigid motion of the workpiece that fits a displacement best: it is its set-up, and no error of the machine.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::field::{Displacement, Row};

/// Displacements are told without the best rigid motion `t + w × p`, or beside that of a reference.
#[derive(Debug)]
pub(super) struct Rigid {
    centre_mm: Vector3<f64>,
    /// Turns are counted at this distance, so that all six are of one size, mm.
    radius_mm: f64,
    motion: Vector6<f64>,
    rows: Vec<Row>,
}

/// Points on one line do not show a turn about it: it is nothing then.
const RIDGE: f64 = 1e-9;

impl Rigid {
    /// Fits at these points.
    pub(super) fn fit(at: &[(Vector3<f64>, Displacement)], width: usize) -> Self {
        let count = at.len().max(1) as f64;
        let centre_mm = at.iter().map(|(p, _)| p).sum::<Vector3<f64>>() / count;
        let farthest = at.iter().map(|(p, _)| (p - centre_mm).norm()).fold(1.0, f64::max);
        let mut rigid = Self {
            centre_mm,
            radius_mm: farthest,
            motion: Vector6::zeros(),
            rows: vec![Row::zero(width); 6],
        };
        let mut normal = Matrix6::zeros();
        for (p, _) in at {
            for k in 0..3 {
                let along = rigid.along(p, k);
                normal += along * along.transpose();
            }
        }
        normal += Matrix6::identity() * (RIDGE * normal.trace().max(f64::MIN_POSITIVE));
        let Some(inverse) = normal.cholesky().map(|normal| normal.inverse()) else {
            return rigid;
        };
        for (p, displacement) in at {
            for k in 0..3 {
                let weight = inverse * rigid.along(p, k);
                rigid.motion += weight * displacement.error_mm[k];
                for (row, weight) in rigid.rows.iter_mut().zip(&weight) {
                    row.add(&displacement.rows[k], *weight);
                }
            }
        }
        rigid
    }

    /// A motion that is the displacement of one point everywhere.
    pub(super) fn of_point(at: &Displacement, width: usize) -> Self {
        let turn = std::iter::repeat_n(Row::zero(width), 3);
        let [x, y, z] = at.error_mm.into();
        Self {
            centre_mm: Vector3::zeros(),
            radius_mm: 1.0,
            motion: Vector6::new(x, y, z, 0.0, 0.0, 0.0),
            rows: at.rows.iter().cloned().chain(turn).collect(),
        }
    }

    /// How component `k` at a point hangs on the six.
    fn along(&self, p: &Vector3<f64>, k: usize) -> Vector6<f64> {
        let along = Vector3::ith(k, 1.0);
        let turned = (p - self.centre_mm).cross(&along) / self.radius_mm;
        Vector6::new(along.x, along.y, along.z, turned.x, turned.y, turned.z)
    }

    /// Takes it off the displacement of a point.
    pub(super) fn take_off(&self, p: &Vector3<f64>, of: &mut Displacement) {
        for k in 0..3 {
            let along = self.along(p, k);
            of.error_mm[k] -= along.dot(&self.motion);
            for (row, weight) in self.rows.iter().zip(&along) {
                of.rows[k].add(row, -weight);
            }
        }
    }
}
