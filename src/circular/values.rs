//! The values of one or two ways over an arc.

use std::f64::consts::TAU;

use super::thresholds::WIDEST_GAP_RAD;
use crate::error::Result;
use crate::solve::MinimaxRows;

/// Numbers of a way: G, G by least squares, F max, F min.
pub(super) const OF_WAY: usize = 4;
/// Numbers of both ways: G(b), the same by least squares, D, H.
pub(super) const OF_BOTH: usize = 4;

/// Where on a circle the readings of one or two ways were taken.
#[derive(Debug, Clone)]
pub struct Ways {
    nominal_mm: f64,
    each: Vec<WayRows>,
    all: MinimaxRows<3>,
}

/// A way over a circle.
#[derive(Debug, Clone)]
struct WayRows {
    angle_rad: Vec<f64>,
    rows: Vec<Row>,
    fit: MinimaxRows<3>,
}

impl Ways {
    /// The angles of each way on the circle, rad.
    pub fn of<'a>(angles_rad: impl IntoIterator<Item = &'a [f64]>, nominal_mm: f64) -> Self {
        let way = |angle_rad: &[f64]| {
            let rows: Vec<Row> = angle_rad.iter().map(|angle| row(*angle)).collect();
            WayRows { angle_rad: angle_rad.to_vec(), fit: MinimaxRows::of(&rows), rows }
        };
        let each: Vec<WayRows> = angles_rad.into_iter().map(way).collect();
        let all: Vec<Row> = each.iter().flat_map(|way| &way.rows).copied().collect();
        Self { nominal_mm, each, all: MinimaxRows::of(&all) }
    }

    /// G(b) of two ways, of one way G, mm, of lengths minus the nominal one, mm, way after way.
    ///
    /// # Errors
    /// When there is not a finite number for every angle.
    pub fn deviation_mm(&self, read_mm: &[f64]) -> Result<f64> {
        let radial_mm = self.radial_mm(read_mm)?;
        self.all.fit(&radial_mm).map(|fit| 2.0 * fit.deviation)
    }

    /// All values of one or two ways, mm: [`OF_WAY`] of each, then of two [`OF_BOTH`] of both.
    pub(super) fn values_mm(&self, read_mm: &[f64]) -> Result<Vec<f64>> {
        let all_mm = self.radial_mm(read_mm)?;
        let mut values = Vec::with_capacity(2 * OF_WAY + OF_BOTH);
        let (mut of_ways, mut rest) = (Vec::new(), &all_mm[..]);
        for way in &self.each {
            let (radial_mm, others) = rest.split_at(way.rows.len());
            let [zone_mm, range_mm, _] = zones(&way.fit, &way.rows, radial_mm)?;
            let [lowest_mm, highest_mm] = ends(radial_mm.iter().copied());
            values.extend([zone_mm, range_mm, highest_mm, lowest_mm]);
            of_ways.push((&way.angle_rad[..], radial_mm));
            rest = others;
        }
        if let [one, other] = of_ways[..] {
            let rows = self.each.iter().flat_map(|way| &way.rows);
            let [zone_mm, range_mm, radius_mm] = zones(&self.all, rows, &all_mm)?;
            values.extend([zone_mm, range_mm, radius_mm, largest_between(one, other)]);
        }
        Ok(values)
    }

    /// Length of the path from the centre of the least-squares circle minus nominal radius, mm.
    fn radial_mm(&self, read_mm: &[f64]) -> Result<Vec<f64>> {
        let [_, x_mm, y_mm] = self.all.by_squares(read_mm)?;
        let radial = |(row, read_mm): (&Row, &f64)| {
            let [_, cos, sin] = *row;
            let (along_mm, across_mm) = (x_mm * cos + y_mm * sin, y_mm * cos - x_mm * sin);
            let length_mm = self.nominal_mm + read_mm;
            ((length_mm - across_mm) * (length_mm + across_mm)).max(0.0).sqrt()
                - self.nominal_mm
                - along_mm
        };
        let rows = self.each.iter().flat_map(|way| &way.rows);
        Ok(rows.zip(read_mm).map(radial).collect())
    }
}

type Row = [f64; 3];

/// Radius and centre as a reading sees them.
pub(super) fn row(angle_rad: f64) -> Row {
    [1.0, angle_rad.cos(), angle_rad.sin()]
}

/// Width of the minimum zone, range about the least-squares circle, and that circle's radius minus the nominal one, mm.
fn zones<'a>(
    fit: &MinimaxRows<3>,
    rows: impl IntoIterator<Item = &'a Row>,
    radial_mm: &[f64],
) -> Result<[f64; 3]> {
    let fit = fit.fit(radial_mm)?;
    let left = rows
        .into_iter()
        .zip(radial_mm)
        .map(|(row, e)| e - row.iter().zip(&fit.least_squares).map(|(a, x)| a * x).sum::<f64>());
    let [lowest, highest] = ends(left);
    Ok([2.0 * fit.deviation, highest - lowest, fit.least_squares[0]])
}

fn ends(of: impl Iterator<Item = f64>) -> [f64; 2] {
    of.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], e| [low.min(e), high.max(e)])
}

/// The largest difference of two paths at one angle: at each point of either one from the other one between its points.
fn largest_between(one: (&[f64], &[f64]), other: (&[f64], &[f64])) -> f64 {
    let apart = |from: (&[f64], &[f64]), to: (&[f64], &[f64])| {
        let line = by_angle(to);
        let points = from.0.iter().zip(from.1);
        let apart = points.filter_map(|(angle, e)| Some((e - between(&line, *angle)?).abs()));
        apart.fold(0.0, f64::max)
    };
    apart(one, other).max(apart(other, one))
}

/// A path in the order of its angles.
fn by_angle((angle_rad, radial_mm): (&[f64], &[f64])) -> Vec<(f64, f64)> {
    let turned = angle_rad.iter().map(|angle| angle.rem_euclid(TAU));
    let mut line: Vec<(f64, f64)> = turned.zip(radial_mm.iter().copied()).collect();
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    line
}

/// A path at an angle, on the straight line between its neighbours; `None` where they are too far apart.
fn between(line: &[(f64, f64)], angle_rad: f64) -> Option<f64> {
    let angle_rad = angle_rad.rem_euclid(TAU);
    let next = line.partition_point(|(at, _)| *at < angle_rad);
    let (last, first) = (*line.last()?, *line.first()?);
    let before = next.checked_sub(1).map_or((last.0 - TAU, last.1), |k| line[k]);
    let after = line.get(next).copied().unwrap_or((first.0 + TAU, first.1));
    let width = after.0 - before.0;
    if width > WIDEST_GAP_RAD {
        return None;
    }
    let share = if width > 0.0 { (angle_rad - before.0) / width } else { 0.0 };
    Some(before.1 + share * (after.1 - before.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const R_MM: f64 = 150.0;

    fn angles() -> Vec<f64> {
        (0..1440).map(|k| TAU * f64::from(k) / 1440.0).collect()
    }

    /// What a bar reads between a ball that is set up beside the centre and a path with this radial deviation.
    fn read(form_mm: impl Fn(f64) -> f64, beside_mm: [f64; 2]) -> Vec<f64> {
        let of = |angle: &f64| {
            let radius_mm = R_MM + form_mm(*angle);
            let x_mm = radius_mm * angle.cos() + beside_mm[0];
            let y_mm = radius_mm * angle.sin() + beside_mm[1];
            x_mm.hypot(y_mm) - R_MM
        };
        angles().iter().map(of).collect()
    }

    fn both(one: &[f64], other: &[f64]) -> Vec<f64> {
        let angles = angles();
        let ways = Ways::of([&angles[..], &angles], R_MM);
        ways.values_mm(&[one, other].concat()).unwrap()
    }

    fn near(values: &[f64], expected: &[f64], within_mm: f64) {
        assert_eq!(values.len(), expected.len());
        for (k, (value, is)) in values.iter().zip(expected).enumerate() {
            assert!((value - is).abs() < within_mm, "value {k}: {value} instead of {is}");
        }
    }

    /// Squareness of 10 um/m alone: e = alpha R / 2 sin 2 angle, the same both ways; G = G(b) = alpha R = 1.5 um.
    #[test]
    fn squareness_alone() {
        let form = |angle: f64| 10e-6 * R_MM / 2.0 * (2.0 * angle).sin();
        let read = read(form, [0.0; 2]);
        let g = 10e-6 * R_MM;
        let way = [g, g, g / 2.0, -g / 2.0];
        near(&both(&read, &read), &[&way[..], &way[..], &[g, g, 0.0, 0.0]].concat(), 1e-12);
    }

    /// A scale of X of 100 um/m alone: e = a R cos²; F from 0 to a R, D = a R / 2, G = a R = 15 um.
    #[test]
    fn scale_alone() {
        let form = |angle: f64| 100e-6 * R_MM * angle.cos().powi(2);
        let read = read(form, [0.0; 2]);
        let g = 100e-6 * R_MM;
        let way = [g, g, g, 0.0];
        near(&both(&read, &read), &[&way[..], &way[..], &[g, g, g / 2.0, 0.0]].concat(), 1e-11);
    }

    /// Servo mismatch turns with the way: each is an ellipse of its own, G(b) is that of both, H its whole height.
    #[test]
    fn servo_mismatch_alone() {
        let a = 8.333e-3;
        let [one, other] =
            [1.0, -1.0].map(|s: f64| read(|angle| s * a * (2.0 * angle).sin(), [0.0; 2]));
        let way = [2.0 * a, 2.0 * a, a, -a];
        let expected = [&way[..], &way[..], &[2.0 * a, 2.0 * a, 0.0, 2.0 * a]].concat();
        near(&both(&one, &other), &expected, 1e-11);
    }

    /// Balls that were set half a millimetre beside each other: 0.8 um of ovality, were it not for the second order.
    #[test]
    fn set_up_is_in_none_of_them() {
        let form = |angle: f64| 2e-3 * (3.0 * angle).cos() + 1e-3;
        let expected = both(&read(form, [0.0; 2]), &read(form, [0.0; 2]));
        // Angles of the bar and of the path differ by the set-up over the radius: 3 parts in 1000 of the form.
        let beside = read(form, [0.5, -0.1]);
        near(&both(&beside, &beside), &expected, 2e-5);
        assert!((expected[0] - 4e-3).abs() < 1e-7 && (expected[10] - 1e-3).abs() < 1e-9);
    }

    #[test]
    fn hysteresis_is_looked_for_between_readings_and_never_across_a_gap() {
        let angles: Vec<f64> = (0..360).map(|k| f64::from(k).to_radians()).collect();
        let turned: Vec<f64> = angles.iter().rev().map(|angle| (angle + 0.4) % TAU).collect();
        let path = |of: &[f64]| of.iter().map(|angle| 1e-3 * angle.cos()).collect::<Vec<f64>>();
        let (one, other) = (path(&angles), path(&turned));
        assert!(largest_between((&angles, &one), (&turned, &other)) < 1e-7);
        let stepped: Vec<f64> = other.iter().map(|e| e + 2e-3).collect();
        let apart = largest_between((&angles, &one), (&turned, &stepped));
        assert!((apart - 2e-3).abs() < 1e-7, "{apart}");
        // A quarter of one, beside the other end of the other one: nothing to compare.
        let apart =
            largest_between((&angles[..90], &one[..90]), (&angles[180..270], &one[180..270]));
        assert!(apart.abs() < 1e-15);
    }
}
