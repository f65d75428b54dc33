//! A TOML file while it is being checked: its text, for messages that point into it.

use std::ops::Range;
use std::path::Path;

use nalgebra::Vector3;
use serde::de::DeserializeOwned;
use toml::Spanned;

use crate::error::{Error, Place, Result};

/// Reads a text file for [`Text`].
pub(crate) fn read(file: &Path) -> Result<String> {
    let bytes = crate::input::read(file, "file")?;
    String::from_utf8(bytes).map_err(|_| {
        Error::input("the file is not UTF-8 text")
            .at(Place::file(file))
            .hint("save it as plain text in UTF-8")
    })
}

/// A TOML text and the name of its file.
#[derive(Clone, Copy)]
pub(crate) struct Text<'a> {
    pub(crate) source: &'a str,
    pub(crate) file: &'a Path,
}

impl Text<'_> {
    /// Parses into a raw type; toml's own message becomes ours, with line and caret.
    pub(crate) fn parse<T: DeserializeOwned>(&self) -> Result<T> {
        toml::from_str(self.source).map_err(|error| {
            let place = match error.span() {
                Some(span) => Place::bytes(self.file, self.source, span),
                None => Place::file(self.file),
            };
            let what = error.message().trim().replace('\n', "; ");
            let hint = unknown_key_hint(&what)
                .unwrap_or_else(|| "docs/reference.md lists every key with its unit".to_owned());
            Error::input(what).at(place).hint(hint)
        })
    }

    /// The place of a span.
    pub(crate) fn place(&self, span: Range<usize>) -> Place {
        if span.is_empty() {
            Place::file(self.file)
        } else {
            Place::bytes(self.file, self.source, span)
        }
    }

    /// A number that must be positive and finite.
    pub(crate) fn positive(&self, value: &Spanned<f64>, key: &str) -> Result<f64> {
        let number = *value.get_ref();
        if number.is_finite() && number > 0.0 {
            return Ok(number);
        }
        Err(Error::input(format!("`{key}` must be a positive number, got `{number}`"))
            .at(self.place(value.span())))
    }

    /// A number within bounds.
    pub(crate) fn within(
        &self,
        value: &Spanned<f64>,
        key: &str,
        low: f64,
        high: f64,
    ) -> Result<f64> {
        let number = *value.get_ref();
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        Err(Error::input(format!("`{key}` must lie between {low} and {high}, got `{number}`"))
            .at(self.place(value.span())))
    }

    /// Three finite numbers.
    pub(crate) fn finite_vector(
        &self,
        value: &Spanned<[f64; 3]>,
        key: &str,
    ) -> Result<Vector3<f64>> {
        let numbers = *value.get_ref();
        if numbers.iter().all(|number| number.is_finite()) {
            return Ok(Vector3::from(numbers));
        }
        Err(Error::input(format!("`{key}` must be three finite numbers"))
            .at(self.place(value.span())))
    }
}

/// A key with another unit, or without one, is the commonest mistake: name the key that was meant.
fn unknown_key_hint(message: &str) -> Option<String> {
    let mut quoted = message.split('`').skip(1).step_by(2);
    if !message.starts_with("unknown field") {
        return None;
    }
    let written = quoted.next()?;
    let stem = |key: &str| key.split('_').next().unwrap_or("").to_lowercase();
    let meant = quoted.find(|known| stem(known) == stem(written))?;
    Some(format!("write `{meant}`; the unit is part of the key"))
}
