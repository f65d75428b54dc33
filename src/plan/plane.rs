//! The coordinate planes, as circular interpolation and ball-bar tests name them.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Unit, UnitVector3, Vector3};

use super::arc::Arc;

/// A coordinate plane; CCW leads from its first axis to its second one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// From X to Y: G17.
    Xy,
    /// From Y to Z: G19.
    Yz,
    /// From Z to X: G18.
    Zx,
}

/// A normal this near to an axis, by its cosine, is that axis.
const ALONG: f64 = 1.0 - 1e-12;

impl Plane {
    /// All, in the usual order.
    pub const ALL: [Self; 3] = [Self::Xy, Self::Yz, Self::Zx];

    /// Such as `XY`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xy => "XY",
            Self::Yz => "YZ",
            Self::Zx => "ZX",
        }
    }

    /// The axis that is normal to it: 0, 1, 2 for X, Y, Z.
    pub fn normal(self) -> usize {
        match self {
            Self::Xy => 2,
            Self::Yz => 0,
            Self::Zx => 1,
        }
    }

    /// Its first and its second axis.
    pub fn axes(self) -> [usize; 2] {
        [(self.normal() + 1) % 3, (self.normal() + 2) % 3]
    }

    /// The plane of an axis that is normal to it.
    pub fn of_normal(axis: usize) -> Self {
        Self::ALL[(axis + 1) % 3]
    }

    /// The plane parallel to which an arc lies.
    pub fn of(arc: &Arc) -> Option<Self> {
        (0..3).find(|&axis| arc.normal[axis].abs() > ALONG).map(Self::of_normal)
    }

    /// An arc of the largest circle in it, from an angle counted from its first axis.
    pub fn arc(self, name: &str, start_rad: f64, sweep_rad: f64) -> Arc {
        let axis = |k| -> UnitVector3<f64> { Unit::new_unchecked(Vector3::ith(k, 1.0)) };
        let normal = axis(self.normal());
        let turned = Rotation3::from_axis_angle(&normal, start_rad) * axis(self.axes()[0]);
        Arc { name: name.to_owned(), start: turned, normal, sweep_rad }
    }

    /// Angle of a direction from its first axis, rad, from 0 to below a whole turn.
    pub fn angle_rad(self, direction: &Vector3<f64>) -> f64 {
        let [first, second] = self.axes();
        direction[second].atan2(direction[first]).rem_euclid(TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn counter_clockwise_leads_from_the_first_axis_to_the_second() {
        for (plane, from, to) in [
            (Plane::Xy, Vector3::x(), Vector3::y()),
            (Plane::Yz, Vector3::y(), Vector3::z()),
            (Plane::Zx, Vector3::z(), Vector3::x()),
        ] {
            let arc = plane.arc("A", 0.0, FRAC_PI_2);
            assert!((arc.start.into_inner() - from).norm() < 1e-15, "{plane:?}");
            assert!((arc.at(1.0).into_inner() - to).norm() < 1e-15, "{plane:?}");
            assert!((plane.angle_rad(&to) - FRAC_PI_2).abs() < 1e-15);
            assert_eq!(Plane::of(&arc), Some(plane));
            assert_eq!(Plane::of_normal(plane.normal()), plane);
        }
        assert_eq!(Plane::of(&Arc::meridian("M", 0.6, 0.0, 1.0)), None);
        assert_eq!(Plane::of(&Arc::meridian("M", 0.0, 0.0, 1.0)), Some(Plane::Zx));
    }
}
