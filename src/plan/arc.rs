//! A circular arc on the sphere.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Rotation3, Unit, UnitVector3, Vector3};

/// An arc on the unit sphere: `start` turned about `normal`.
///
/// A great circle where the two are perpendicular, a small circle where they are not.
#[derive(Debug, Clone, PartialEq)]
pub struct Arc {
    /// What the program and the report call it.
    pub name: String,
    /// Direction of its first point.
    pub start: UnitVector3<f64>,
    /// Axis that the arc turns about.
    pub normal: UnitVector3<f64>,
    /// Angle turned about `normal` by the right hand, rad; negative turns the other way.
    pub sweep_rad: f64,
}

/// A way is looked at in so many places.
const LOOKS: usize = 90;
/// Farther below its ends, as a share of the radius, a way may meet what carries the workpiece ball: on a bar of 150 mm
/// 30 mm.
const BELOW: f64 = 0.2;

/// Direction of a polar angle and an azimuth, rad.
pub(super) fn direction(polar_rad: f64, azimuth_rad: f64) -> UnitVector3<f64> {
    Unit::new_normalize(Vector3::new(
        polar_rad.sin() * azimuth_rad.cos(),
        polar_rad.sin() * azimuth_rad.sin(),
        polar_rad.cos(),
    ))
}

impl Arc {
    /// A circle of constant polar angle, counter-clockwise seen from +Z for a positive sweep.
    pub fn parallel(name: &str, polar_rad: f64, azimuth_rad: f64, sweep_rad: f64) -> Self {
        Self {
            name: name.to_owned(),
            start: direction(polar_rad, azimuth_rad),
            normal: Vector3::z_axis(),
            sweep_rad,
        }
    }

    /// The equator, from an azimuth.
    pub fn equator(name: &str, azimuth_rad: f64, sweep_rad: f64) -> Self {
        Self::parallel(name, FRAC_PI_2, azimuth_rad, sweep_rad)
    }

    /// The meridian of an azimuth, from `start_rad` above the equator over the pole by `sweep_rad`;
    /// the whole one has start 0 and sweep pi.
    pub fn meridian(name: &str, azimuth_rad: f64, start_rad: f64, sweep_rad: f64) -> Self {
        Self {
            name: name.to_owned(),
            start: direction(FRAC_PI_2 - start_rad, azimuth_rad),
            normal: direction(FRAC_PI_2, azimuth_rad - FRAC_PI_2),
            sweep_rad,
        }
    }

    /// The shortest great circle between two directions; over the pole where they are opposite.
    pub fn shortest(name: &str, from: &UnitVector3<f64>, to: &UnitVector3<f64>) -> Self {
        let cross = from.cross(to);
        let sweep_rad = cross.norm().atan2(from.dot(to));
        let normal = Unit::try_new(cross, 1e-9)
            .or_else(|| Unit::try_new(from.cross(&Vector3::z()), 1e-9))
            .unwrap_or(Vector3::x_axis());
        Self { name: name.to_owned(), start: *from, normal, sweep_rad }
    }

    /// Direction after a share of the sweep, 0 to 1; after whole turns it is that of the start to the last bit.
    pub fn at(&self, share: f64) -> UnitVector3<f64> {
        let turns = self.sweep_rad * share / TAU;
        if (turns - turns.round()).abs() < 1e-12 {
            return self.start;
        }
        let turned = Rotation3::from_axis_angle(&self.normal, self.sweep_rad * share) * self.start;
        Unit::new_normalize(turned.into_inner())
    }

    /// The same arc driven from its end to its start.
    #[must_use]
    pub fn reversed(&self, name: &str) -> Self {
        Self {
            name: name.to_owned(),
            start: self.at(1.0),
            normal: self.normal,
            sweep_rad: -self.sweep_rad,
        }
    }

    /// The same arc, begun so much earlier on its circle and ended so much later, rad.
    #[must_use]
    pub fn beyond(&self, rad: f64) -> Self {
        let before_rad = -rad.copysign(self.sweep_rad);
        let turned = Rotation3::from_axis_angle(&self.normal, before_rad) * self.start;
        Self {
            start: if rad > 0.0 { Unit::new_normalize(turned.into_inner()) } else { self.start },
            sweep_rad: self.sweep_rad - 2.0 * before_rad,
            ..self.clone()
        }
    }

    /// The way on the sphere from one direction to another: the shortest, or where that leads far below both, to where the
    /// post of the workpiece ball stands, round the other side.
    pub fn transit(name: &str, from: &UnitVector3<f64>, to: &UnitVector3<f64>) -> Self {
        let short = Self::shortest(name, from, to);
        let lowest = (0..=LOOKS).map(|k| short.at(k as f64 / LOOKS as f64).z).fold(1.0, f64::min);
        if lowest > from.z.min(to.z) - BELOW {
            return short;
        }
        Self { sweep_rad: short.sweep_rad - TAU, ..short }
    }

    /// Radius of the circle on a sphere, mm.
    pub fn circle_radius_mm(&self, sphere_mm: f64) -> f64 {
        sphere_mm * self.normal.cross(&self.start).norm()
    }

    /// Number of equal chords whose sagitta on a sphere stays within `sag_mm`.
    ///
    /// A chord over the angle `d` of a circle of radius `r` sags by `r (1 - cos(d/2))`; on a small
    /// circle the length of the bar sees less of it, which is left as a margin.
    pub fn chords(&self, sphere_mm: f64, sag_mm: f64) -> usize {
        let radius_mm = self.circle_radius_mm(sphere_mm);
        if radius_mm <= sag_mm {
            return 1;
        }
        let widest_rad = 2.0 * (1.0 - sag_mm / radius_mm).acos();
        (self.sweep_rad.abs() / widest_rad).ceil().max(1.0) as usize
    }

    /// Whether the arc goes all the way round.
    pub fn is_closed(&self) -> bool {
        (self.sweep_rad.abs() - 2.0 * PI).abs() < 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &UnitVector3<f64>, b: [f64; 3]) -> bool {
        (a.into_inner() - Vector3::from(b)).norm() < 1e-12
    }

    #[test]
    fn a_meridian_goes_from_the_equator_over_the_pole_to_the_other_side() {
        for azimuth in [0.0_f64, 0.7, 2.5] {
            let arc = Arc::meridian("M", azimuth, 0.0, PI);
            assert!(close(&arc.start, [azimuth.cos(), azimuth.sin(), 0.0]));
            assert!(close(&arc.at(0.5), [0.0, 0.0, 1.0]));
            assert!(close(&arc.at(1.0), [-azimuth.cos(), -azimuth.sin(), 0.0]));
            let back = arc.reversed("B");
            assert!(close(&back.at(0.25), arc.at(0.75).into_inner().into()));
        }
    }

    #[test]
    fn the_equator_turns_from_x_towards_y() {
        let arc = Arc::equator("E", 0.0, 2.0 * PI);
        assert!(close(&arc.at(0.25), [0.0, 1.0, 0.0]));
        assert!(arc.is_closed());
    }

    #[test]
    fn transits_between_opposite_points_go_over_the_pole() {
        let arc = Arc::shortest("T", &Vector3::x_axis(), &-Vector3::x_axis());
        assert!(close(&arc.at(0.5), [0.0, 0.0, 1.0]) || close(&arc.at(0.5), [0.0, 0.0, -1.0]));
        assert!(arc.at(0.5).z > 0.0);
    }

    #[test]
    fn transits_between_low_places_go_over_the_top() {
        // The two ends of 220 degrees in ZX: the shortest way leads through the post.
        let low = |azimuth_rad| direction(110.0_f64.to_radians(), azimuth_rad);
        let arc = Arc::transit("T", &low(0.0), &low(PI));
        assert!(arc.at(0.5).z > 0.999 && close(&arc.at(1.0), low(PI).into_inner().into()));
        // From plane to plane it stays beside.
        let arc = Arc::transit("T", &low(0.0), &low(FRAC_PI_2));
        assert!(arc.sweep_rad > 0.0 && arc.at(0.5).z > -0.5);
    }

    #[test]
    fn what_is_driven_beyond_an_arc_lies_on_its_circle_on_both_sides() {
        for sweep_rad in [1.0, -1.0] {
            let arc = Arc::equator("E", 0.5, sweep_rad);
            let beyond = arc.beyond(0.25);
            assert!(close(&beyond.at(1.0 / 6.0), arc.start.into_inner().into()));
            assert!(close(&beyond.at(5.0 / 6.0), arc.at(1.0).into_inner().into()));
            assert_eq!(arc.beyond(0.0), arc);
        }
    }

    #[test]
    fn chords_keep_the_sag() {
        let arc = Arc::equator("E", 0.0, 2.0 * PI);
        let count = arc.chords(150.0, 0.0004);
        let sag = 150.0 * (1.0 - (PI / count as f64).cos());
        assert!(sag <= 0.0004 && sag > 0.00039, "{count} chords sag {sag}");
    }
}
