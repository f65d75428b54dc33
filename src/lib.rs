//! Ball-bar testing of three-axis machine tools.

pub mod align;
pub mod cli;
pub mod error;
pub mod identify;
mod input;
pub mod log;
pub mod machine;
pub mod model;
pub mod motion;
pub mod nc;
pub mod plan;
pub mod report;
pub mod simulate;
pub mod solve;
mod toml_text;

pub use error::{Error, Result};
