//! What may be there, before and after a closer look.

use crate::residual::{Element, Fitted};

/// An effect that may be there.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) element: Element,
    /// By how much it lowers the sum of squares, mm².
    pub(crate) gain_mm2: f64,
}

/// A candidate after a closer look.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    pub(crate) fitted: Fitted,
    /// Gain less what its numbers gain by chance, mm².
    pub(crate) score_mm2: f64,
}
