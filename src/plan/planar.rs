//! Circles in the coordinate planes, as ISO 230-4 has them.

use super::arc::Arc;
use super::plane::Plane;

/// A whole circle where the tool gets round below the workpiece ball, which it does in XY.
const WHOLE_DEG: f64 = 360.0;
/// The usual part of one in a plane of the tool axis: a fifth of a right angle and more below the equator either side.
const PART_DEG: f64 = 220.0;
/// Overshoot of a whole circle, degrees: half a turn, so that it begins and ends at one place.
const OF_WHOLE_DEG: f64 = 180.0;
/// Overshoot of a part of a circle, degrees: on a bar of 100 mm at 1000 mm/min in 0.2 s, in which a control is up to feed.
const OF_PART_DEG: f64 = 2.0;

/// A choice of planes by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Planes {
    /// X and Y.
    Xy,
    /// Y and Z.
    Yz,
    /// Z and X.
    Zx,
    /// All three, one after the other.
    Iso230,
}

impl Planes {
    /// All.
    pub const ALL: [Self; 4] = [Self::Xy, Self::Yz, Self::Zx, Self::Iso230];

    /// Its name in a test file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xy => "xy",
            Self::Yz => "yz",
            Self::Zx => "zx",
            Self::Iso230 => "iso230-4",
        }
    }

    /// Reads a name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|planes| planes.name().eq_ignore_ascii_case(name))
    }

    /// The planes, in the order of driving.
    pub fn planes(self) -> &'static [Plane] {
        match self {
            Self::Xy => &[Plane::Xy],
            Self::Yz => &[Plane::Yz],
            Self::Zx => &[Plane::Zx],
            Self::Iso230 => &Plane::ALL,
        }
    }
}

/// Planes, and which part of each circle is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planar {
    /// The planes.
    pub planes: Planes,
    /// Angle of the data arc, degrees.
    pub sweep_deg: Option<f64>,
    /// Where it begins, CCW from the first axis of its plane, degrees.
    pub start_deg: Option<f64>,
    /// What is driven before the data arc and after it, degrees.
    pub overshoot_deg: Option<f64>,
}

impl Planar {
    /// The data arcs CCW, each with its overshoot, rad.
    pub fn arcs(&self) -> impl Iterator<Item = (Arc, f64)> + '_ {
        self.planes.planes().iter().map(|&plane| {
            let whole_deg = if plane == Plane::Xy { WHOLE_DEG } else { PART_DEG };
            let sweep_deg = self.sweep_deg.unwrap_or(whole_deg);
            let whole = sweep_deg >= WHOLE_DEG;
            // What is a part only lies to both sides of the tool axis.
            let middle_deg = match plane {
                Plane::Yz => Some(90.0),
                Plane::Zx => Some(0.0),
                Plane::Xy => None,
            };
            let about_z_deg = middle_deg.filter(|_| !whole).map(|deg| deg - 0.5 * sweep_deg);
            let start_deg = self.start_deg.or(about_z_deg).unwrap_or(0.0);
            let usual_deg = if whole { OF_WHOLE_DEG } else { OF_PART_DEG };
            let overshoot_deg = self.overshoot_deg.unwrap_or(usual_deg);
            let arc = plane.arc(plane.name(), start_deg.to_radians(), sweep_deg.to_radians());
            (arc, overshoot_deg.to_radians())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn planar(planes: Planes) -> Planar {
        Planar { planes, sweep_deg: None, start_deg: None, overshoot_deg: None }
    }

    #[test]
    fn a_part_of_a_circle_lies_to_both_sides_of_the_tool_axis() {
        for (planes, sweep_deg) in
            [(Planes::Yz, None), (Planes::Zx, None), (Planes::Zx, Some(180.0))]
        {
            let (arc, overshoot_rad) =
                Planar { sweep_deg, ..planar(planes) }.arcs().next().unwrap();
            assert!((arc.at(0.5).into_inner() - Vector3::z()).norm() < 1e-12, "{planes:?}");
            assert!((arc.sweep_rad.to_degrees() - sweep_deg.unwrap_or(220.0)).abs() < 1e-12);
            assert!((overshoot_rad.to_degrees() - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_whole_circle_begins_at_its_first_axis_half_a_turn_late() {
        let all = planar(Planes::Iso230);
        let mut arcs = all.arcs();
        let (arc, overshoot_rad) = arcs.next().unwrap();
        assert!(arc.is_closed() && (arc.start.into_inner() - Vector3::x()).norm() < 1e-15);
        assert!((overshoot_rad.to_degrees() - 180.0).abs() < 1e-12);
        let names: Vec<String> = arcs.map(|(arc, _)| arc.name).collect();
        assert_eq!(names, ["YZ", "ZX"]);
        let whole = Planar { sweep_deg: Some(360.0), ..planar(Planes::Zx) };
        let (arc, _) = whole.arcs().next().unwrap();
        assert!((arc.start.into_inner() - Vector3::z()).norm() < 1e-15);
    }
}
