//! Ball-bar testing of three-axis machine tools.

pub mod error;
pub mod machine;
pub mod model;
mod toml_text;

pub use error::{Error, Result};
