//! Ball-bar testing of three-axis machine tools.
pub mod error;
pub use error::{Error, Result};
