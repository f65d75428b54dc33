//! Numbers of many displacements, each with what is known of it.

use nalgebra::Vector3;

use super::field::{Displacement, Field, Row, Sigmas};

/// A number of a volume or a line, mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Figure {
    /// The value, mm.
    pub value_mm: f64,
    /// How well it is known, mm.
    pub sigmas: Sigmas,
}

impl Figure {
    pub(super) fn of(field: &Field, value_mm: f64, row: &Row) -> Self {
        Self { value_mm, sigmas: field.sigmas(row) }
    }
}

/// What displacements are together.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// How many poses: points by senses.
    pub poses: usize,
    /// Largest length of the vector.
    pub largest: Figure,
    /// Where, machine coordinates, mm.
    pub largest_at_mm: Vector3<f64>,
    /// The length that 95 % are not beyond.
    pub most: Figure,
    /// Root mean square of the length.
    pub rms: Figure,
    /// Root mean square of what is not known of the vector, mm.
    pub unknown: Sigmas,
    /// Largest less smallest of the displacement along X, Y, Z.
    pub ranges: [Figure; 3],
}

/// What share of the poses is not beyond [`Figures::most`].
const MOST: f64 = 0.95;

impl Figures {
    /// Of these; `None` of nothing.
    pub(super) fn of(field: &Field, all: &[&(Vector3<f64>, Displacement)]) -> Option<Self> {
        let mut by_size: Vec<&(Vector3<f64>, Displacement)> = all.to_vec();
        by_size.sort_by(|a, b| a.1.error_mm.norm().total_cmp(&b.1.error_mm.norm()));
        let last = *by_size.last()?;
        let count = all.len() as f64;
        let most = by_size[((MOST * count).ceil() as usize).clamp(1, all.len()) - 1];
        let squares: f64 = all.iter().map(|(_, of)| of.error_mm.norm_squared()).sum();
        let rms_mm = (squares / count).sqrt();
        let mut rms_row = Row::zero(field.width());
        let (mut noise, mut open) = (0.0, 0.0);
        for (_, of) in all {
            for k in 0..3 {
                rms_row.add(&of.rows[k], of.error_mm[k] / (count * rms_mm.max(f64::MIN_POSITIVE)));
                let sigmas = field.sigmas(&of.rows[k]);
                noise += sigmas.noise.powi(2);
                open += sigmas.all.powi(2);
            }
        }
        let range = |k: usize| {
            let along = |of: &&&(Vector3<f64>, Displacement)| of.1.error_mm[k];
            let high = all.iter().max_by(|a, b| along(a).total_cmp(&along(b)))?;
            let low = all.iter().min_by(|a, b| along(a).total_cmp(&along(b)))?;
            let mut row = high.1.rows[k].clone();
            row.add(&low.1.rows[k], -1.0);
            Some(Figure::of(field, high.1.error_mm[k] - low.1.error_mm[k], &row))
        };
        Some(Self {
            poses: all.len(),
            largest: size(field, &last.1),
            largest_at_mm: last.0,
            most: size(field, &most.1),
            rms: Figure::of(field, rms_mm, &rms_row),
            unknown: Sigmas { noise: (noise / count).sqrt(), all: (open / count).sqrt() },
            ranges: [range(0)?, range(1)?, range(2)?],
        })
    }
}

/// Length of a vector, and how well it is known along itself.
pub(super) fn size(field: &Field, of: &Displacement) -> Figure {
    let length_mm = of.error_mm.norm();
    let direction = of.error_mm.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::x);
    let mut row = Row::zero(field.width());
    for k in 0..3 {
        row.add(&of.rows[k], direction[k]);
    }
    Figure::of(field, length_mm, &row)
}
