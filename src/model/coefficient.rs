//! The 96 names of the paper, letter by letter.

use std::fmt;

use crate::machine::{Axis, Pose};

/// Which of the six errors of a slide, or which direction of a set-up error: the letter after `E`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Component {
    /// Displacement along X, mm.
    X,
    /// Displacement along Y, mm.
    Y,
    /// Displacement along Z, mm.
    Z,
    /// Rotation about X, rad.
    A,
    /// Rotation about Y, rad.
    B,
    /// Rotation about Z, rad.
    C,
}

impl Component {
    /// X, Y, Z, A, B, C in this order.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::A, Self::B, Self::C];

    /// Whether it is a rotation.
    pub fn is_angular(self) -> bool {
        self >= Self::A
    }

    /// 0, 1, 2 for the direction or the axis of rotation X, Y, Z.
    pub fn direction(self) -> usize {
        self as usize % 3
    }

    /// The letter.
    pub fn letter(self) -> char {
        ['X', 'Y', 'Z', 'A', 'B', 'C'][self as usize]
    }
}

/// The last sign of a coefficient's name: the power of `h`, or `b` for the hysteresis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Power {
    /// Constant.
    P0,
    /// Linear.
    P1,
    /// Quadratic.
    P2,
    /// Cubic.
    P3,
    /// Hysteresis: multiplies the sense `b`.
    B,
}

impl Power {
    /// 0, 1, 2, 3, b in this order.
    pub const ALL: [Self; 5] = [Self::P0, Self::P1, Self::P2, Self::P3, Self::B];

    /// The sign.
    pub fn letter(self) -> char {
        ['0', '1', '2', '3', 'b'][self as usize]
    }
}

/// One of the 90 coefficients of the intra-axis errors, such as `EXY1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Coefficient {
    /// The slide that errs: the letter `H`.
    pub slide: Axis,
    /// In which of the six ways: the letter `I`.
    pub component: Component,
    /// The power.
    pub power: Power,
}

impl Coefficient {
    /// All 90, in the order of the paper's Table 1.
    pub fn all() -> impl Iterator<Item = Self> {
        Axis::ALL.into_iter().flat_map(|slide| {
            Component::ALL.into_iter().flat_map(move |component| {
                Power::ALL.into_iter().map(move |power| Self { slide, component, power })
            })
        })
    }

    /// What it multiplies at a pose: `1, h, h², h³` of its slide (mm), or the sense `b`.
    pub fn basis(self, at: &Pose) -> f64 {
        let h_mm = at.position_mm[self.slide.index()];
        match self.power {
            Power::P0 => 1.0,
            Power::P1 => h_mm,
            Power::P2 => h_mm * h_mm,
            Power::P3 => h_mm * h_mm * h_mm,
            Power::B => at.sense[self.slide.index()],
        }
    }

    /// Reads a name such as `EAZ0` or `EYYb`.
    pub fn parse(name: &str) -> Option<Self> {
        Self::all().find(|coefficient| coefficient.to_string() == name)
    }

    /// Unit: `mm`, `mm/mm`, `mm/mm²`, `mm/mm³`, or the same with `rad`.
    pub fn unit(self) -> &'static str {
        let angular = self.component.is_angular();
        match self.power {
            Power::P0 | Power::B => ["mm", "rad"][usize::from(angular)],
            Power::P1 => ["mm/mm", "rad/mm"][usize::from(angular)],
            Power::P2 => ["mm/mm²", "rad/mm²"][usize::from(angular)],
            Power::P3 => ["mm/mm³", "rad/mm³"][usize::from(angular)],
        }
    }
}

impl fmt::Display for Coefficient {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "E{}{}{}", self.component.letter(), self.slide, self.power.letter())
    }
}

/// Which ball a set-up error displaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Ball {
    /// The ball on the table: the letter `w`.
    Workpiece,
    /// The ball on the spindle: the letter `t`.
    Tool,
}

/// One of the six set-up errors, such as `EXt`, mm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SetUp {
    /// The ball.
    pub ball: Ball,
    /// The direction.
    pub axis: Axis,
}

impl SetUp {
    /// `EXw EYw EZw EXt EYt EZt`.
    pub fn all() -> impl Iterator<Item = Self> {
        [Ball::Workpiece, Ball::Tool]
            .into_iter()
            .flat_map(|ball| Axis::ALL.into_iter().map(move |axis| Self { ball, axis }))
    }

    /// Reads a name such as `EXt`.
    pub fn parse(name: &str) -> Option<Self> {
        Self::all().find(|set_up| set_up.to_string() == name)
    }
}

impl fmt::Display for SetUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ball = match self.ball {
            Ball::Workpiece => 'w',
            Ball::Tool => 't',
        };
        write!(f, "E{}{ball}", self.axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn there_are_96_names_and_each_reads_back() {
        let names: BTreeSet<String> = Coefficient::all()
            .map(|c| c.to_string())
            .chain(SetUp::all().map(|s| s.to_string()))
            .collect();
        assert_eq!(names.len(), 96);
        for coefficient in Coefficient::all() {
            assert_eq!(Coefficient::parse(&coefficient.to_string()), Some(coefficient));
        }
        assert_eq!(Coefficient::parse("EAZ0").unwrap().slide, Axis::Z);
        assert_eq!(SetUp::parse("EYt").unwrap().axis, Axis::Y);
        assert_eq!(Coefficient::parse("EXX4"), None);
    }
}
