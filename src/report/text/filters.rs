//! Filters of the templates.

// What the macro makes of a filter, and the form that it wants of one.
#![allow(unreachable_pub, clippy::inline_always, clippy::unnecessary_wraps, clippy::unused_self)]

use std::fmt::Display;

use askama::filters::Safe;
use askama::{Result, Values};

use super::markup::coded;

/// Text with what stands between backticks as code.
#[askama::filter_fn]
pub(crate) fn code(text: impl Display, _: &dyn Values) -> Result<Safe<String>> {
    Ok(Safe(coded(&text.to_string())))
}
