//! What the words of a block mean, whatever a dialect calls them, and what excludes what.

/// How X, Y and Z are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// G00.
    Rapid,
    /// G01.
    Line,
    /// G02 when false, G03 when true.
    Arc {
        /// Counter-clockwise, looking against the axis normal to the plane.
        counter_clockwise: bool,
    },
}

/// A function that switches the look-ahead of the control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LookAhead {
    /// The address of its argument.
    pub(crate) letter: u8,
    /// The argument that switches it on; 0 switches it off.
    pub(crate) on: u32,
}

/// What a word states that holds anyway; where somebody left it otherwise, the path would be another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Held {
    /// G40, R0.
    CutterCompensation,
    /// G49, D0.
    ToolLength,
    /// G80, MCALL.
    FixedCycles,
    /// G94.
    FeedKind,
    /// G15.
    PolarCoordinates,
    /// G50, cycle 11.
    Scaling,
    /// G69, cycle 10.
    Rotation,
    /// TRANS.
    Frames,
    /// TRAFOOF, M129.
    Transformation,
    /// COMPOF.
    Compressor,
    /// FFWON, FFWOF.
    FeedForward,
    /// SOFT, BRISK.
    Jerk,
    /// RTLION.
    StraightRapids,
    /// Cycle 7.
    DatumShift,
    /// Cycle 8.
    Mirror,
    /// PLANE RESET STAY.
    TiltedPlane,
}

impl Held {
    fn name(self) -> &'static str {
        match self {
            Self::CutterCompensation => "cutter compensation",
            Self::ToolLength => "tool length compensation",
            Self::FixedCycles => "fixed cycles",
            Self::FeedKind => "the kind of feed",
            Self::PolarCoordinates => "polar coordinates",
            Self::Scaling => "scaling",
            Self::Rotation => "rotation of coordinates",
            Self::Frames => "programmed frames",
            Self::Transformation => "transformations of axes",
            Self::Compressor => "the compressor of blocks",
            Self::FeedForward => "feed-forward control",
            Self::Jerk => "how acceleration builds up",
            Self::StraightRapids => "the way of positioning",
            Self::DatumShift => "the datum shift",
            Self::Mirror => "mirroring",
            Self::TiltedPlane => "the tilted plane",
        }
    }
}

/// What a word says, such as a G word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    /// G00 to G03.
    Motion(Motion),
    /// G17, G18, G19: the axis normal to the plane, 2, 1 or 0.
    Plane(usize),
    /// G20 (true), G21.
    Inch(bool),
    /// G91 (true), G90.
    Incremental(bool),
    /// G54 to G59.
    WorkOffset(u8),
    /// G61 (true), G64.
    ExactStopMode(bool),
    /// A word that states what holds anyway.
    Default(Held),
    /// G09.
    ExactStop,
    /// G04.
    Dwell,
    /// G53.
    MachineCoordinates,
    /// CC: the centre of arcs to come.
    Pole,
    /// G05, G05.1, G08.
    LookAhead(LookAhead),
}

impl Code {
    /// What excludes each other in one block: a number below 32 and its name.
    pub(crate) fn group(self) -> (u16, &'static str) {
        match self {
            Self::Motion(_) => (0, "the kind of motion"),
            Self::Plane(_) => (1, "the plane"),
            Self::Inch(_) => (2, "inch or metric"),
            Self::Incremental(_) => (3, "absolute or incremental"),
            Self::WorkOffset(_) => (4, "the work offset"),
            Self::ExactStopMode(_) => (5, "exact stop or cutting mode"),
            Self::Default(held) => (8 + held as u16, held.name()),
            Self::ExactStop => (6, "exact stop"),
            Self::Dwell | Self::MachineCoordinates | Self::Pole | Self::LookAhead(_) => {
                (7, "functions of one block")
            }
        }
    }
}

/// What an M word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Miscellaneous {
    /// M00.
    Stop,
    /// M01.
    OptionalStop,
    /// M02, M30.
    End,
    /// M98.
    Call,
    /// M99.
    Return,
    /// Spindle and coolant: M03, M04, M05, M08, M09.
    NoMotion,
}
