//! Words of a dialect that are more than a letter and a number.

use super::code::{Code, Held, Motion};

/// Such a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Keyword {
    /// Siemens: this block in machine coordinates, without any offset.
    Supa,
    /// Siemens: no tool offset.
    D0,
    /// Siemens: no transformation of axes.
    Trafoof,
    /// Siemens: alone, it takes all programmed frames away.
    Trans,
    /// Siemens: no cycle is called at positions.
    Mcall,
    /// Siemens: blocks are not put together.
    Compof,
    /// Siemens: feed-forward control on.
    Ffwon,
    /// Siemens: feed-forward control off.
    Ffwof,
    /// Siemens: acceleration builds up with limited jerk.
    Soft,
    /// Siemens: acceleration builds up at once.
    Brisk,
    /// Siemens: rapids go straight.
    Rtlion,
    /// Klartext: a straight line at feed.
    Line,
    /// Klartext: a straight line at rapid traverse: L with FMAX.
    Rapid,
    /// Klartext: an arc about the pole, counter-clockwise: C with DR+.
    Ccw,
    /// Klartext: the same clockwise: C with DR-.
    Cw,
    /// Klartext: the pole of arcs to come.
    Pole,
    /// Klartext: this block in machine coordinates.
    M91,
    /// Klartext: no radius compensation.
    R0,
    /// Klartext: the tool axis, which chooses the plane of arcs: Z, Y, X.
    ToolAxis(u8),
    /// Klartext: cycle 9, a dwell.
    Dwell,
    /// Klartext: cycle 7 back to 0.
    DatumShift,
    /// Klartext: cycle 8 without an axis.
    Mirror,
    /// Klartext: cycle 10 back to 0.
    Rotation,
    /// Klartext: cycle 11 back to 1.
    Scaling,
    /// Klartext: no tilted plane.
    PlaneReset,
    /// Klartext: rotary axes move by themselves.
    M129,
    /// Klartext: the unit of the program, INCH when true.
    Unit(bool),
}

impl Keyword {
    /// Those of a Siemens control.
    pub(crate) const SIEMENS: [Self; 10] = [
        Self::Supa,
        Self::Trafoof,
        Self::Trans,
        Self::Mcall,
        Self::Compof,
        Self::Ffwon,
        Self::Ffwof,
        Self::Soft,
        Self::Brisk,
        Self::Rtlion,
    ];

    /// How it is written, and what it says.
    fn entry(self) -> (&'static str, Code) {
        let arc = |counter_clockwise| Code::Motion(Motion::Arc { counter_clockwise });
        match self {
            Self::Supa => ("SUPA", Code::MachineCoordinates),
            Self::D0 => ("D0", Code::Default(Held::ToolLength)),
            Self::Trafoof => ("TRAFOOF", Code::Default(Held::Transformation)),
            Self::Trans => ("TRANS", Code::Default(Held::Frames)),
            Self::Mcall => ("MCALL", Code::Default(Held::FixedCycles)),
            Self::Compof => ("COMPOF", Code::Default(Held::Compressor)),
            Self::Ffwon => ("FFWON", Code::Default(Held::FeedForward)),
            Self::Ffwof => ("FFWOF", Code::Default(Held::FeedForward)),
            Self::Soft => ("SOFT", Code::Default(Held::Jerk)),
            Self::Brisk => ("BRISK", Code::Default(Held::Jerk)),
            Self::Rtlion => ("RTLION", Code::Default(Held::StraightRapids)),
            Self::Line => ("L", Code::Motion(Motion::Line)),
            Self::Rapid => ("L", Code::Motion(Motion::Rapid)),
            Self::Ccw => ("C", arc(true)),
            Self::Cw => ("C", arc(false)),
            Self::Pole => ("CC", Code::Pole),
            Self::M91 => ("M91", Code::MachineCoordinates),
            Self::R0 => ("R0", Code::Default(Held::CutterCompensation)),
            Self::ToolAxis(axis) => ("TOOL CALL", Code::Plane(usize::from(axis))),
            Self::Dwell => ("CYCL DEF 9", Code::Dwell),
            Self::DatumShift => ("CYCL DEF 7", Code::Default(Held::DatumShift)),
            Self::Mirror => ("CYCL DEF 8", Code::Default(Held::Mirror)),
            Self::Rotation => ("CYCL DEF 10", Code::Default(Held::Rotation)),
            Self::Scaling => ("CYCL DEF 11", Code::Default(Held::Scaling)),
            Self::PlaneReset => ("PLANE RESET STAY", Code::Default(Held::TiltedPlane)),
            Self::M129 => ("M129", Code::Default(Held::Transformation)),
            Self::Unit(inch) => (if inch { "INCH" } else { "MM" }, Code::Inch(inch)),
        }
    }

    /// How it is written.
    pub(crate) fn name(self) -> &'static str {
        self.entry().0
    }

    /// What it says.
    pub(crate) fn code(self) -> Code {
        self.entry().1
    }
}
