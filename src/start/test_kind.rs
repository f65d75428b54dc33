//! Which test to begin with.

use crate::error::{Error, Result};
use crate::plan::{Planes, Strategy};

/// What is driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestKind {
    /// Circles in planes.
    Planes(Planes),
    /// Circles on the sphere.
    Sphere(Strategy),
    /// What `ballbar design` will choose.
    Design,
}

impl TestKind {
    /// All, the simplest first.
    pub fn all() -> impl Iterator<Item = Self> {
        let planes = Planes::ALL.into_iter().map(Self::Planes);
        planes.chain(Strategy::ALL.into_iter().map(Self::Sphere)).chain([Self::Design])
    }

    /// Its name on a command line; with planes and spheres that of the strategy.
    pub fn name(self) -> &'static str {
        match self {
            Self::Planes(planes) => planes.name(),
            Self::Sphere(strategy) => strategy.name(),
            Self::Design => "design",
        }
    }

    /// Reads a name.
    pub fn parse(name: &str) -> Result<Self> {
        Self::all().find(|kind| kind.name().eq_ignore_ascii_case(name)).ok_or_else(|| {
            let names: Vec<_> = Self::all().map(Self::name).collect();
            Error::input(format!("there is no test `{name}`"))
                .hint(format!("the tests are `{}`", names.join("`, `")))
        })
    }

    /// What it is, in a line.
    pub fn words(self) -> &'static str {
        match self {
            Self::Planes(Planes::Xy) => "the XY plane, a whole circle each way",
            Self::Planes(Planes::Yz) => "the YZ plane, 220 degrees each way",
            Self::Planes(Planes::Zx) => "the ZX plane, 220 degrees each way",
            Self::Planes(Planes::Iso230) => "the three planes, one after the other",
            Self::Sphere(Strategy::TwoD) => "equator and two meridians",
            Self::Sphere(Strategy::ThreeD5) => "equator and four meridians",
            Self::Sphere(Strategy::ThreeD6) => "equator and five meridians",
            Self::Sphere(Strategy::ThreeD10) => "equator and nine meridians",
            Self::Design => "what `ballbar design` chooses in a budget of time",
        }
    }

    /// The strategy of its test file; a design begins with one, so that it can be planned before it is designed.
    pub(super) fn strategy(self) -> &'static str {
        match self {
            Self::Design => Strategy::ThreeD6.name(),
            named => named.name(),
        }
    }

    /// A usual feed, mm/min: that of many acceptance tests of planes; slower where slides turn back on the sphere.
    pub fn usual_feed_mm_min(self) -> f64 {
        match self {
            Self::Planes(_) => 1000.0,
            Self::Sphere(_) | Self::Design => 500.0,
        }
    }
}
