//! A picture with its caption.

/// A figure and the sentence under it.
#[derive(Debug)]
pub(in crate::report) struct Figure {
    /// Inline SVG.
    pub(in crate::report) svg: String,
    /// What it shows; empty where the figures of a group share one sentence.
    pub(in crate::report) caption: String,
    /// It stands beside two of the others.
    pub(in crate::report) tall: bool,
}
