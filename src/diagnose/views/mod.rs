//! What it looks like: the residual against everything, and each effect by itself.

pub(super) mod feature;
pub(super) mod means;
pub(super) mod picture;
pub(super) mod sample;
pub(super) mod spectra;
pub(super) mod view;
