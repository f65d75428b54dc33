//! In which runs a finding is.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::diagnose::Owner;
use crate::identify::Identification;

/// In which runs a finding is, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OwnerFacts {
    /// The same in all.
    AllRuns,
    /// In every run with an amplitude of its own.
    EachRun,
    /// In the run of this name; empty where it has none.
    One(String),
}

impl OwnerFacts {
    pub(super) fn new(of: Owner, identifications: &[Identification]) -> Self {
        match of {
            Owner::All => Self::AllRuns,
            Owner::EachRun => Self::EachRun,
            Owner::One { repeat, run } => {
                let run = identifications.get(repeat).and_then(|of| of.runs.get(run));
                Self::One(run.map_or_else(String::new, |run| run.name.clone()))
            }
        }
    }

    /// Whether it is in all runs alike, as most findings are.
    pub fn is_all(&self) -> bool {
        *self == Self::AllRuns
    }
}

impl fmt::Display for OwnerFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AllRuns => f.write_str("all runs"),
            Self::EachRun => f.write_str("every run, each with its own"),
            Self::One(name) if name.is_empty() => f.write_str("one run"),
            Self::One(name) => write!(f, "{name} only"),
        }
    }
}

impl Serialize for OwnerFacts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
