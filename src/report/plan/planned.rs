//! What a plan is made of.

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
