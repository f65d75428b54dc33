//! Travels as people say them: from where to where, or how long and where the zero is.

use crate::error::{Error, Result};
use crate::machine::Axis;
use crate::toml_text::{FARTHEST_MM, short};

/// Where the zero of an axis is in its travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Zero {
    /// At its upper end, where many machines have their reference point: all positions are negative.
    Upper,
    /// In the middle.
    Middle,
    /// At its lower end.
    Lower,
}

impl Zero {
    /// All, the commonest first.
    pub const ALL: [Self; 3] = [Self::Upper, Self::Middle, Self::Lower];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Upper => "upper",
            Self::Middle => "middle",
            Self::Lower => "lower",
        }
    }

    /// Reads a name.
    pub fn parse(name: &str) -> Result<Self> {
        let known = Self::ALL.into_iter().find(|zero| zero.name().eq_ignore_ascii_case(name));
        known.ok_or_else(|| {
            Error::input(format!("`{name}` is no end of a travel"))
                .hint(format!("write one of `{}`", Self::ALL.map(Self::name).join("`, `")))
        })
    }
}

/// The travel of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel {
    /// Lowest and highest machine coordinate, mm.
    Between(f64, f64),
    /// How long it is, mm; the zero is told apart.
    Length(f64),
}

impl Travel {
    /// Reads those of X, Y and Z: `-762..0,-406..0,-508..0` or `762,406,508`.
    pub fn parse(text: &str) -> Result<[Self; 3]> {
        let wrong = |what: String| {
            Error::input(what).hint(
                "write the lowest and the highest machine coordinate of X, Y and Z in mm, such as \
                 `-762..0,-406..0,-508..0`, or three lengths, such as `762,406,508`",
            )
        };
        let parts: Vec<&str> = text.split([',', ';']).collect();
        let &[x, y, z] = parts.as_slice() else {
            let count = parts.iter().filter(|part| !part.trim().is_empty()).count();
            let plural = if count == 1 { "" } else { "s" };
            return Err(wrong(format!("`{text}` has {count} travel{plural} instead of three")));
        };
        let number = |text: &str| {
            let value: Option<f64> = text.trim().parse().ok();
            let fits = value.filter(|value| (-FARTHEST_MM..=FARTHEST_MM).contains(value));
            fits.ok_or_else(|| wrong(format!("`{}` is no coordinate in mm", text.trim())))
        };
        let one = |text: &str| match text.split_once("..") {
            Some((low, high)) => {
                let (low, high) = (number(low)?, number(high)?);
                let upwards = low < high;
                upwards.then_some(Self::Between(low, high)).ok_or_else(|| {
                    wrong(format!("a travel goes upwards, not from {low} to {high}"))
                })
            }
            None => match number(text)? {
                length if length > 0.0 => Ok(Self::Length(length)),
                length => Err(wrong(format!("a travel of {length} mm is none"))),
            },
        };
        Ok([one(x)?, one(y)?, one(z)?])
    }

    /// Whether it leaves open where the zero is.
    pub fn asks_for_zero(self) -> bool {
        matches!(self, Self::Length(_))
    }

    /// Lowest and highest machine coordinate, mm.
    pub fn between_mm(self, zero: Zero) -> [f64; 2] {
        match (self, zero) {
            (Self::Between(low, high), _) => [low, high],
            (Self::Length(length), Zero::Upper) => [-length, 0.0],
            (Self::Length(length), Zero::Middle) => [-0.5 * length, 0.5 * length],
            (Self::Length(length), Zero::Lower) => [0.0, length],
        }
    }

    /// As it is written.
    pub fn text(travel_mm: &[[f64; 2]; 3]) -> String {
        let of = |axis: Axis| travel_mm[axis.index()].map(short).join("..");
        Axis::ALL.map(of).join(",")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn travels_are_read_from_end_to_end_or_as_lengths() {
        let ranges = Travel::parse("-762..0, -406..0, -508..1e2").unwrap();
        assert_eq!(ranges[2], Travel::Between(-508.0, 100.0));
        let travel_mm = ranges.map(|travel| travel.between_mm(Zero::Lower));
        assert_eq!(Travel::text(&travel_mm), "-762..0,-406..0,-508..100");
        let lengths = Travel::parse("762,406;508").unwrap();
        let low = |zero| lengths.map(|travel| travel.between_mm(zero)[0].round() as i64);
        assert_eq!(low(Zero::Upper), [-762, -406, -508]);
        assert_eq!(low(Zero::Middle), [-381, -203, -254]);
        assert_eq!(low(Zero::Lower), [0, 0, 0]);
    }

    #[test]
    fn what_is_no_travel_is_told() {
        for (text, told) in [
            ("762,406", "2 travels"),
            ("762,406,0", "a travel of 0 mm"),
            ("762,406,x", "`x` is no coordinate"),
            ("0..-762,406,508", "goes upwards"),
            ("762,406,nan", "no coordinate"),
            ("762,406,1e6", "no coordinate"),
            ("..,406,1", "no coordinate"),
            ("", "0 travels"),
            ("1..2", "1 travel instead"),
            ("1,2,3,4", "4 travels"),
        ] {
            let error = Travel::parse(text).unwrap_err();
            assert!(error.what.contains(told) && error.hint.is_some(), "{text}: {error}");
        }
    }
}
