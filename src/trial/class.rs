//! Classes of trials.

use std::fmt;

/// What is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// One effect, 1 um.
    Single = 1,
    /// One effect as large as the noise.
    Small = 2,
    /// One effect of 0.3, 0.5 and 2 times the noise in turn.
    Sizes = 3,
    /// Nothing.
    None = 4,
    /// Two effects, 1 um each.
    Two = 5,
    /// One effect that the library of causes does not have, 1 um.
    Outside = 6,
}

/// How many trials of each class a full trial has.
pub const REQUIRED: [(Class, usize); 6] = [
    (Class::Single, 300),
    (Class::Small, 300),
    (Class::Sizes, 300),
    (Class::None, 300),
    (Class::Two, 200),
    (Class::Outside, 100),
];

/// How many a full trial over the grid has: every value of every factor comes up some hundred times.
pub const IN_GRID: [(Class, usize); 5] = [
    (Class::Single, 400),
    (Class::Small, 200),
    (Class::None, 800),
    (Class::Two, 200),
    (Class::Outside, 200),
];

/// Sizes of [`Class::Sizes`] in units of the noise.
const SIZES: [f64; 3] = [0.3, 0.5, 2.0];

impl Class {
    /// All, in the order of the table.
    pub const ALL: [Self; 6] =
        [Self::Single, Self::Small, Self::Sizes, Self::None, Self::Two, Self::Outside];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Small => "small",
            Self::Sizes => "sizes",
            Self::None => "none",
            Self::Two => "two",
            Self::Outside => "outside",
        }
    }

    /// The class of a name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.name() == name)
    }

    /// Size of each effect of a trial, mm rms, where the noise has this standard deviation.
    pub fn size_mm(self, index: u64, noise_mm: f64) -> f64 {
        match self {
            Self::Single | Self::Two | Self::Outside => 1e-3,
            Self::Small => noise_mm,
            Self::Sizes => SIZES[index as usize % SIZES.len()] * noise_mm,
            Self::None => 0.0,
        }
    }

    /// How many effects are hidden.
    pub fn effects(self) -> usize {
        match self {
            Self::None => 0,
            Self::Two => 2,
            _ => 1,
        }
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
