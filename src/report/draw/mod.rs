//! Pictures as SVG that any page can hold: lines and texts, charts, polar plots.

pub(super) mod chart;
pub(super) mod polar;
pub(super) mod svg;
pub(super) mod ticks;
