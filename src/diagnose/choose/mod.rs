//! What is there: settings put right, effects chosen beside each other, the model extended by them.

pub(super) mod exact;
pub(super) mod extend;
pub(super) mod found;
mod in_place;
mod pair;
pub(super) mod price;
mod rivals;
pub(super) mod run;
pub(super) mod search;
pub(super) mod settings;
pub(super) mod tidy;
