//! What a search has chosen, and what else it could be.

use crate::residual::element::Element;
use crate::residual::joint::Fitted;

/// Another explanation of the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Rival {
    /// What else it could be.
    pub element: Element,
    /// What it explains of what the named one does.
    pub share: f64,
    /// How far these runs tell them apart.
    pub told: Told,
}

/// Whether two explanations can be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// They are the same in these runs, whatever the noise.
    Same,
    /// They differ by less than the noise does.
    Undecided,
    /// The other one explains less.
    Apart,
}

/// What was found.
#[derive(Debug)]
pub(crate) struct Chosen {
    pub(crate) fitted: Fitted,
    /// Other explanations of each element.
    pub(crate) rivals: Vec<Vec<Rival>>,
}
