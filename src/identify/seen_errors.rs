//! The errors of a machine as far as a test sees them.

use super::result::Identification;
use crate::solve::Matrix;

/// What a test sees of the errors of a machine. Shapes are those of [`Identification`].
#[derive(Debug)]
pub struct SeenErrors {
    /// The values of the parameters, in their units.
    pub values: Vec<f64>,
    /// See [`Identification::covariance`].
    pub covariance: Matrix,
    /// See [`Identification::left_open`].
    pub left_open: Option<Matrix>,
    /// See [`Identification::open_by_driving`].
    pub driven: Option<Matrix>,
    /// See [`Identification::effects`].
    pub effects: Option<Matrix>,
}

impl Identification {
    /// What the test sees of the errors: what else the fit moved is at nothing, plus or minus what is plausible.
    pub fn seen_errors(&self) -> SeenErrors {
        let rows = |matrix: &Matrix| self.across.leave_out_rows(matrix);
        let mut values = self.values();
        self.across.leave_out(&mut values);
        let left_open = self.left_open.as_ref().map(|open| {
            let mut open = rows(open);
            let plausible: Vec<_> = self.estimates.iter().map(|of| of.plausible).collect();
            self.across.add_plausible(&mut open, &plausible);
            open
        });
        SeenErrors {
            values,
            covariance: rows(&rows(&self.covariance).transposed()),
            left_open,
            driven: self.open_by_driving().as_ref().map(rows),
            effects: self.effects.as_ref().map(rows),
        }
    }
}
