//! What a fit leaves: the residuals of all repeats, what the model already spans, and what an effect explains
//! beside others.

pub(crate) mod data;
pub(crate) mod element;
pub(crate) mod joint;
pub(crate) mod noise;
pub(crate) mod structure;

pub use element::{Element, Owner};
pub use structure::Structure;
