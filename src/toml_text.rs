//! A TOML file while it is being checked: its text, for messages that point into it.

use std::ops::Range;
use std::path::Path;

use nalgebra::Vector3;
use serde::de::DeserializeOwned;
use toml::Spanned;

use crate::error::{Error, Place, Result};

/// Reads a text file for [`Text`].
pub(crate) fn read(file: &Path) -> Result<String> {
    let bytes = crate::input::read_small(file, "file")?;
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
            let what = in_words(&error.message().trim().replace('\n', "; "));
            let hint = unknown_key_hint(&what)
                .or_else(|| slip_hint(&place))
                .unwrap_or_else(|| "`ballbar reference KEY` says what a key means".to_owned());
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
        let got = short(number);
        Err(Error::input(format!("`{key}` must lie between {low} and {high}, got `{got}`"))
            .at(self.place(value.span()))
            .hint("give a number within these bounds, in the unit at the end of the key"))
    }

    /// Refuses a list with more entries than a bound; `extra` is where the first one beyond it stands.
    pub(crate) fn at_most(
        &self,
        count: usize,
        most: usize,
        what: &str,
        extra: Option<Range<usize>>,
        hint: &str,
    ) -> Result<()> {
        if count <= most {
            return Ok(());
        }
        let place = extra.map_or_else(|| Place::file(self.file), |span| self.place(span));
        Err(Error::input(format!("the file has {count} {what}, and {most} are the most"))
            .at(place)
            .hint(hint.to_owned()))
    }

    /// A place or a way on a machine: three numbers, none of them beyond [`FARTHEST_MM`].
    pub(crate) fn finite_vector(
        &self,
        value: &Spanned<[f64; 3]>,
        key: &str,
    ) -> Result<Vector3<f64>> {
        let numbers = *value.get_ref();
        let Some(far) =
            numbers.iter().find(|number| !(-FARTHEST_MM..=FARTHEST_MM).contains(*number))
        else {
            return Ok(Vector3::from(numbers));
        };
        let got = short(*far);
        Err(Error::input(format!(
            "`{key}` must be three numbers between -{FARTHEST_MM} and {FARTHEST_MM}, got `{got}`"
        ))
        .at(self.place(value.span()))
        .hint("give X, Y and Z in mm"))
    }
}

/// No machine is larger, mm; beyond this the arithmetic loses the micrometres.
pub(crate) const FARTHEST_MM: f64 = 100_000.0;

/// A number as one would write it: without 300 zeros.
pub(crate) fn short(number: f64) -> String {
    let plain = number == 0.0 || !number.is_finite() || (1e-6..1e15).contains(&number.abs());
    if plain { number.to_string() } else { format!("{number:e}") }
}

/// The reader speaks of types of a programming language; users write numbers, text and lists.
fn in_words(message: &str) -> String {
    let Some((before, expected)) = message.rsplit_once("expected ") else {
        return message.replace("wanted string or table", "expected text in quotes");
    };
    let meant = match expected {
        "f64" => "a number",
        "usize" | "u32" | "u64" => "a whole number, not negative",
        "a string" => "text in quotes",
        "a sequence" => "a list in brackets",
        other => match other.strip_prefix("an array of length ") {
            Some(length) => return format!("{before}expected a list of {length} in brackets"),
            None => other,
        },
    };
    format!("{before}expected {meant}")
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

/// What people write who do not write TOML every day: paths of Windows, and numbers as in German.
fn slip_hint(place: &Place) -> Option<String> {
    let (key, value) = place.text.split_once('=')?;
    let value = value.trim();
    if value.starts_with('"') && value.contains('\\') {
        let path = value.trim_matches('"');
        return Some(format!(
            "write slashes, `\"{}\"`, or single quotes, `'{path}'`: in double quotes a backslash begins a character of its own",
            path.replace("\\\\", "/").replace('\\', "/")
        ));
    }
    let (whole, decimals) = value.split_once(',')?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let decimals = decimals.split([' ', '#']).next().unwrap_or("");
    (digits(whole.trim_start_matches(['-', '+'])) && digits(decimals))
        .then(|| format!("write a decimal point: `{} = {whole}.{decimals}`", key.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Deserialize)]
    struct Wish {
        minutes: Option<Spanned<f64>>,
        most: Option<usize>,
        names: Option<Vec<String>>,
        place: Option<Spanned<[f64; 3]>>,
    }

    fn read(source: &str) -> Result<()> {
        let text = Text { source, file: "t.toml".as_ref() };
        let wish: Wish = text.parse()?;
        // Only their types are of interest.
        drop((wish.most, wish.names));
        if let Some(minutes) = &wish.minutes {
            text.within(minutes, "minutes", 0.0, 90.0)?;
        }
        wish.place.map(|place| text.finite_vector(&place, "place")).transpose()?;
        Ok(())
    }

    #[test]
    fn a_wrong_value_is_told_in_words_with_figures_and_a_hint() {
        for (source, told) in [
            ("minutes = 'x'", "expected a number"),
            ("most = -1", "expected a whole number, not negative"),
            ("most = 2.5", "expected a whole number, not negative"),
            ("names = 'x'", "expected a list in brackets"),
            ("names = [1]", "expected text in quotes"),
            ("place = [1, 2]", "expected a list of 3 in brackets"),
            ("place = [1, 2, nan]", "between -100000 and 100000, got `NaN`"),
            ("place = [1, 2, 1e308]", "got `1e308`"),
            ("minutes = 1e308", "between 0 and 90, got `1e308`"),
            ("minutes = nan", "between 0 and 90, got `NaN`"),
            ("minutes = -1", "got `-1`"),
        ] {
            let error = read(source).unwrap_err();
            assert!(error.what.ends_with(told), "{source}: {}", error.what);
            assert!(error.what.len() < 100 && error.hint.is_some(), "{error}");
            assert!(error.place.is_some_and(|place| place.line == 1), "{source}");
        }
        assert!(read("minutes = 60\nmost = 3\nplace = [0, -1, 2.5]").is_ok());
    }
}
