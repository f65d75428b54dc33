//! The library of causes: what a machine or a bar may do beyond cubics and hysteresis.
//!
//! A cause is known by its name, acts on a [`SeatKind`], and has numbers with units. The table is the
//! one vocabulary of `simulate --hide`, of `model.toml`, of diagnosis and of the trial; what a cause does
//! to the machine the simulator works out by itself, and what it does to the readings stands in [`Shape`](super::Shape).

/// What a cause acts on: the key `on` of an [`Effect`](super::Effect).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeatKind {
    /// An error function, such as `EXX` or `EBZ`.
    Function,
    /// An angular error function only, such as `EBZ`.
    Angle,
    /// A slide: `X`, `Y` or `Z`.
    Slide,
    /// A slide, or all alike where none is named.
    Slides,
    /// What warms: a ball (`EZt`, `EXw`), the scale of a slide (`EXX1`) or the bar (`bar`).
    Body,
    /// A ball: `EXt` .. `EZw`.
    Ball,
    /// A ball of the tool or the bar's own length: `EXt`, `EYt`, `EZt`, `bar`.
    Reading,
    /// A coefficient of the paper, such as `EBX3`.
    Coefficient,
    /// Nothing: it acts on the whole.
    None,
}

/// A number of a cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Its name with the unit in which it is written; `amplitude` takes the unit of what the cause acts
    /// on: `amplitude_um`, `amplitude_urad` or, for a scale, `amplitude_um_m`.
    pub name: &'static str,
    /// What a number in the written unit is multiplied by to be in mm, s, rad.
    pub si: f64,
    /// What it is where it is not given; `None` where it must be.
    pub default: Option<f64>,
    /// From .. to, in the written unit.
    pub limits: [f64; 2],
}

/// The name of the key whose unit hangs on the seat.
pub const AMPLITUDE: &str = "amplitude";

/// Which cause, for those who work it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the table of causes says what each is")]
pub enum Kind {
    Cyclic,
    Servo,
    ReversalSpike,
    GrowingBacklash,
    PreSliding,
    Drift,
    Knock,
    BarLength,
    Roundness,
    Degree,
    Vibration,
    StickSlip,
    FeedOverride,
    Clock,
    BallPlace,
    Pivot,
    Coefficient,
    Bump,
    Joint,
    FrictionTilt,
}

/// One cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cause {
    /// Which it is.
    pub kind: Kind,
    /// Its name, such as `cyclic`.
    pub id: &'static str,
    /// In words.
    pub title: &'static str,
    /// What it acts on.
    pub seat: SeatKind,
    /// Its numbers.
    pub keys: &'static [Key],
    /// What it does, as an equation; `A` is the amplitude, `h` the position of a slide (mm), `b` its
    /// sense, `v` its velocity, `t` the time since the program began.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What a technician does about it.
    pub remedy: &'static str,
    /// What it is easily taken for.
    pub taken_for: &'static str,
    /// Whether diagnosis looks for it; what it does not know is there to be hidden from it.
    pub known: bool,
}

impl PartialEq<str> for Cause {
    fn eq(&self, id: &str) -> bool {
        self.id == id
    }
}

impl Cause {
    /// The whole numbers that a key of this name may be; none where there is no such key.
    pub fn whole_numbers(&self, key: &str) -> impl Iterator<Item = f64> + use<> {
        let limits = self.keys.iter().find(|known| known.name == key).map(|known| known.limits);
        limits.into_iter().flat_map(|[low, high]| (low as i32..=high as i32).map(f64::from))
    }
}
