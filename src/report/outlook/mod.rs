//! What a test will be, before it is run: for the terminal, as `plan.json` and as `plan.html`.

mod bars;
mod cautions;
mod facts;
mod gather;
mod html;
mod rows;
mod sphere;
mod terminal;
mod unseen;
mod volume_map;

pub use facts::{
    ClearanceFacts, ComparedSquareness, Comparison, ForeseenErrors, ForeseenHysteresis,
    ForeseenReversal, ForeseenScale, ForeseenSquareness, MountingOutlook, OperatorFacts,
    ParameterOutlook, PlanReport, SightFacts, Spread, TestOutlook, TimeFacts, TravelFacts,
    UnseenTerm, VolumeFacts,
};
pub use html::plan_page;
pub use terminal::plan_summary;

use crate::design::Outlook;
use crate::machine::Machine;
use crate::plan::Test;

/// A test with its machine and its outlook.
#[derive(Debug)]
pub struct Planned {
    /// The test.
    pub test: Test,
    /// Its machine.
    pub machine: Machine,
    /// What it will give.
    pub outlook: Outlook,
}
