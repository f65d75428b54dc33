//! Arcs: from what a block says to a centre and an angle.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::program::Path;

/// The radii at both ends of an arc may differ by this much, mm: centre and end are rounded.
pub(crate) const RADIUS_TOLERANCE_MM: f64 = 0.01;

/// Two points closer than this are one, mm: half of the finest input increment is 50 nm.
const SAME_POINT_MM: f64 = 1e-5;

/// By how much half the chord may exceed the radius, mm: one least input increment.
const HALF_CHORD_TOLERANCE_MM: f64 = 1e-3;

/// An arc without its centre: what every block of G02 or G03 says.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    /// Start, mm.
    pub(crate) start_mm: Vector3<f64>,
    /// End, mm.
    pub(crate) end_mm: Vector3<f64>,
    /// The axis normal to the plane: 0, 1, 2 for X, Y, Z.
    pub(crate) axis: usize,
    /// G03 rather than G02.
    pub(crate) counter_clockwise: bool,
}

/// Why there is no such arc: what is wrong and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct NoArc {
    /// One sentence without a full stop.
    pub(crate) what: String,
    /// What to do about it.
    pub(crate) hint: &'static str,
}

impl Ends {
    /// The arc about `start + offset`, which is a full circle when it ends where it starts.
    pub(crate) fn about(&self, offset_mm: Vector3<f64>) -> Result<Path, NoArc> {
        let (u, v) = plane(self.axis);
        let center_mm = self.start_mm + offset_mm;
        let from = self.start_mm - center_mm;
        let to = self.end_mm - center_mm;
        let (first, last) = (from[u].hypot(from[v]), to[u].hypot(to[v]));
        if first < SAME_POINT_MM {
            return Err(NoArc {
                what: "the centre of the arc is its start".to_owned(),
                hint: "I, J and K lead from the start of the arc to its centre",
            });
        }
        if (first - last).abs() > RADIUS_TOLERANCE_MM {
            return Err(NoArc {
                what: format!(
                    "the arc starts at radius {first:.4} mm and ends at radius {last:.4} mm"
                ),
                hint: "I, J and K lead from the start of the arc to its centre, also with G90; \
                       the radii may differ by 0.01 mm",
            });
        }
        let sweep_rad = if self.closed() {
            self.turn(TAU)
        } else {
            let cross = from[u] * to[v] - from[v] * to[u];
            let dot = from[u] * to[u] + from[v] * to[v];
            // The angle in the sense of the motion, between nothing and a whole turn.
            let angle = self.turn(cross.atan2(dot));
            self.turn(if angle > 0.0 { angle } else { angle + TAU })
        };
        Ok(Path::Arc { center_mm, axis: self.axis, sweep_rad })
    }

    /// The arc of a radius: the shorter one, or the longer one when the radius is negative.
    pub(crate) fn of_radius(&self, radius_mm: f64) -> Result<Path, NoArc> {
        if self.closed() {
            return Err(NoArc {
                what: "an arc by R ends where it starts".to_owned(),
                hint: "a radius does not tell where the centre of a full circle is: write I, J or K",
            });
        }
        let (u, v) = plane(self.axis);
        let chord = self.end_mm - self.start_mm;
        let length = chord[u].hypot(chord[v]);
        let half = length / 2.0;
        if half > radius_mm.abs() + HALF_CHORD_TOLERANCE_MM {
            return Err(NoArc {
                what: format!(
                    "the radius {:.4} mm is too small for ends {length:.4} mm apart",
                    radius_mm.abs()
                ),
                hint: "half the distance of the ends is the smallest possible radius",
            });
        }
        let height = (radius_mm * radius_mm - half * half).max(0.0).sqrt();
        // The centre of the shorter arc is on the left of a counter-clockwise motion.
        let left = height.copysign(self.turn(radius_mm));
        let mut offset_mm = Vector3::zeros();
        offset_mm[u] = chord[u] / 2.0 - chord[v] / length * left;
        offset_mm[v] = chord[v] / 2.0 + chord[u] / length * left;
        self.about(offset_mm)
    }

    /// Whether it ends where it starts, seen along the axis.
    fn closed(&self) -> bool {
        let (u, v) = plane(self.axis);
        let chord = self.end_mm - self.start_mm;
        chord[u].hypot(chord[v]) < SAME_POINT_MM
    }

    /// A counter-clockwise quantity in the sense of the motion, and back.
    fn turn(&self, value: f64) -> f64 {
        if self.counter_clockwise { value } else { -value }
    }
}

/// The two axes of the plane, in the order in which they turn by the right hand about its normal.
pub(crate) fn plane(axis: usize) -> (usize, usize) {
    ((axis + 1) % 3, (axis + 2) % 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn ends(axis: usize, from_deg: f64, to_deg: f64, counter_clockwise: bool) -> Ends {
        let point = |degrees: f64| {
            let (u, v) = plane(axis);
            let mut point = Vector3::new(20.0, -35.0, 40.0);
            point[u] += 150.0 * degrees.to_radians().cos();
            point[v] += 150.0 * degrees.to_radians().sin();
            point
        };
        Ends { start_mm: point(from_deg), end_mm: point(to_deg), axis, counter_clockwise }
    }

    fn arc(path: Path) -> (Vector3<f64>, f64) {
        match path {
            Path::Arc { center_mm, sweep_rad, .. } => (center_mm, sweep_rad),
            Path::Line => panic!("a line"),
        }
    }

    #[test]
    fn radius_and_centre_describe_the_same_arc_in_every_plane() {
        for axis in 0..3 {
            for from in [0.0, 37.0, 180.0, 300.0] {
                for sweep in [1.0_f64, 90.0, 179.0, 181.0, 270.0, 359.0] {
                    for counter_clockwise in [true, false] {
                        let signed = if counter_clockwise { sweep } else { -sweep };
                        let ends = ends(axis, from, from + signed, counter_clockwise);
                        let radius = if sweep < 180.0 { 150.0 } else { -150.0 };
                        let (center, angle) = arc(ends.of_radius(radius).unwrap());
                        let truth = Vector3::new(20.0, -35.0, 40.0);
                        let (again, same) = arc(ends.about(truth - ends.start_mm).unwrap());
                        assert!((center - truth).norm() < 1e-9, "{ends:?}");
                        assert!((again - truth).norm() < 1e-12);
                        assert!((angle - signed.to_radians()).abs() < 1e-9, "{ends:?}");
                        assert!((same - signed.to_radians()).abs() < 1e-12, "{ends:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_half_turn_by_radius_bears_the_rounding_of_its_ends() {
        let mut ends = ends(2, 0.0, 180.0, true);
        ends.end_mm.x -= 0.001;
        let (center, sweep) = arc(ends.of_radius(150.0).unwrap());
        assert!((sweep - PI).abs() < 1e-9);
        assert!((center.x - 19.9995).abs() < 1e-9);
        ends.end_mm.x -= 0.01;
        assert!(ends.of_radius(150.0).is_err());
    }

    #[test]
    fn a_helix_keeps_the_centre_at_the_height_of_its_start() {
        let mut ends = ends(2, 0.0, 90.0, false);
        ends.end_mm.z += 10.0;
        let (center, sweep) = arc(ends.about(Vector3::new(-150.0, 0.0, 0.0)).unwrap());
        assert!((center.z - 40.0).abs() < 1e-12);
        assert!((sweep + 3.0 * FRAC_PI_2).abs() < 1e-12);
    }
}
