//! A cause with what it acts on and how much: `cyclic:on=EXX,period_mm=10,amplitude_um=1.2`.

use std::fmt;

use super::cause::Cause;
use super::causes::CAUSES;
use super::key::{DEGREE, Key, ORDER};
use super::seat::{Seat, SeatKind};
use crate::error::{Error, Result};

/// A cause at work.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Which.
    pub cause: &'static Cause,
    /// On what.
    pub seat: Seat,
    /// Its numbers in the order of the cause's keys, in mm, s, rad.
    values: Vec<f64>,
}

impl Effect {
    /// An effect with its numbers in the order of the cause's keys, in mm, s, rad.
    ///
    /// # Panics
    /// If there is not one number a key.
    pub fn new(cause: &'static Cause, seat: Seat, values: Vec<f64>) -> Self {
        assert_eq!(cause.keys.len(), values.len(), "one number for each key of {}", cause.id);
        Self { cause, seat, values }
    }

    /// A number by the name of its key, in mm, s, rad; not a number where the cause has no such key.
    pub fn get(&self, key: &str) -> f64 {
        let index = self.cause.keys.iter().position(|known| known.name == key);
        index.map_or(f64::NAN, |index| self.values[index])
    }

    /// The same with one number changed, in mm, s, rad.
    #[must_use]
    pub fn with(mut self, key: &str, value: f64) -> Self {
        if let Some(index) = self.cause.keys.iter().position(|known| known.name == key) {
            self.values[index] = value;
        }
        self
    }

    /// The number that scales the effect: the first one; none where the cause has no numbers.
    pub fn size_key(&self) -> Option<&'static Key> {
        self.cause.keys.first()
    }

    /// Reads `CAUSE:key=value,key=value`.
    ///
    /// # Errors
    /// What is unknown, missing, no number or out of its limits, with what is possible.
    ///
    /// ```
    /// use ballbar::model::Effect;
    ///
    /// let effect = Effect::parse("cyclic:on=EXX,period_mm=10,amplitude_um=1.2")?;
    /// assert_eq!(effect.get("amplitude"), 1.2e-3);
    /// assert_eq!(effect.to_string(), "cyclic:on=EXX,amplitude_um=1.2,period_mm=10,phase_rad=0");
    /// assert!(Effect::parse("cyclic:on=EXX,pitch_mm=10").is_err());
    /// # Ok::<(), ballbar::Error>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self> {
        let (id, rest) = text.split_once(':').unwrap_or((text, ""));
        let cause = Self::cause_of(id)?;
        let mut given = Vec::new();
        for pair in rest.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
            let (key, value) = pair.split_once('=').ok_or_else(|| {
                Error::input(format!("`{pair}` of `{id}` has no value")).hint(Self::usage(cause))
            })?;
            given.push((key.trim(), value.trim()));
        }
        let on = given.iter().find(|(key, _)| *key == "on").map(|(_, value)| *value);
        if given.iter().filter(|(key, _)| *key == "on").count() > 1 {
            return Err(
                Error::input(format!("`on` of `{id}` is given twice")).hint(Self::usage(cause))
            );
        }
        given.retain(|(key, _)| *key != "on");
        let numbers = given
            .into_iter()
            .map(|(key, value)| match value.parse::<f64>() {
                Ok(number) => Ok((key, number)),
                Err(_) => {
                    Err(Error::input(format!("`{value}` is no number, for `{key}` of `{id}`"))
                        .hint(Self::usage(cause)))
                }
            })
            .collect::<Result<Vec<_>>>()?;
        Self::of(id, on, &numbers)
    }

    /// The effect of a cause's name, what it acts on, and its numbers in the units of their names.
    ///
    /// # Errors
    /// As [`parse`](Self::parse).
    pub fn of(id: &str, on: Option<&str>, numbers: &[(&str, f64)]) -> Result<Self> {
        let cause = Self::cause_of(id)?;
        let refuse = |what: String| Error::input(what).hint(Self::usage(cause));
        let seat = match on {
            None if matches!(cause.seat, SeatKind::None | SeatKind::Slides) => Some(Seat::Whole),
            None => None,
            Some(name) => Seat::parse(name).filter(|seat| seat.fits(cause.seat)),
        };
        let seat = seat.ok_or_else(|| match on {
            None => refuse(format!("`{id}` does not say what it acts on")),
            Some(name) => refuse(format!("`{id}` cannot act on `{name}`")),
        })?;
        let mut values: Vec<Option<f64>> = vec![None; cause.keys.len()];
        for (name, number) in numbers {
            let known = cause.keys.iter().position(|key| key.written(seat) == *name);
            let index = known.ok_or_else(|| refuse(format!("`{id}` has no `{name}`")))?;
            let key = &cause.keys[index];
            let [low, high] = key.limits;
            if !(low..=high).contains(number) {
                return Err(refuse(format!(
                    "`{name}` of `{id}` must be from {low} to {high}, not {number}"
                )));
            }
            if key.is_whole() && number.fract() != 0.0 {
                return Err(Error::input(format!(
                    "`{name}` of `{id}` must be a whole number, not {number}"
                ))
                .hint(format!("write `{name}={}`", number.round())));
            }
            if values[index].is_some() {
                return Err(refuse(format!("`{name}` of `{id}` is given twice")));
            }
            values[index] = Some(number * key.unit(seat).si);
        }
        let values = values
            .into_iter()
            .zip(cause.keys)
            .map(|(value, key)| {
                value.or_else(|| key.default.map(|d| d * key.unit(seat).si)).ok_or_else(|| {
                    refuse(format!("`{id}` does not say its `{}`", key.written(seat)))
                })
            })
            .collect::<Result<_>>()?;
        let effect = Self { cause, seat, values };
        let (degree, order) = (effect.get(DEGREE), effect.get(ORDER));
        if order.abs() > degree {
            return Err(Error::input(format!(
                "`order` of `{id}` must be from -{degree} to {degree}, its degree, not {order}"
            ))
            .hint("orders above 0 go with the cosine of the azimuth, below 0 with the sine"));
        }
        Ok(effect)
    }

    /// Every number with the name of its key and in the unit that the name says.
    pub fn written(&self) -> Vec<(String, f64)> {
        let each = self.cause.keys.iter().zip(&self.values);
        each.map(|(key, value)| {
            // Without the last digits, which a change of units leaves behind.
            let number = value / key.unit(self.seat).si;
            let digits = 1e12 / 10f64.powi(number.abs().max(1e-30).log10().floor() as i32);
            (key.written(self.seat), (number * digits).round() / digits)
        })
        .collect()
    }

    fn cause_of(id: &str) -> Result<&'static Cause> {
        Cause::named(id).ok_or_else(|| {
            let ids: Vec<&str> = CAUSES.iter().map(|cause| cause.id).collect();
            Error::input(format!("unknown cause `{id}`"))
                .hint(format!("causes are `{}`", ids.join("`, `")))
        })
    }

    fn usage(cause: &Cause) -> String {
        let on = match cause.seat {
            SeatKind::Function => "on=EXX",
            SeatKind::Angle => "on=EBX",
            SeatKind::Slide | SeatKind::Slides => "on=X",
            SeatKind::Body | SeatKind::Ball | SeatKind::Reading => "on=EZt",
            SeatKind::Coefficient => "on=EBX3",
            SeatKind::None => "",
        };
        let seat = Seat::parse(on.trim_start_matches("on=")).unwrap_or(Seat::Whole);
        let keys = cause.keys.iter().map(|key| format!("{}=...", key.written(seat)));
        let on = Some(on.to_owned()).filter(|on| !on.is_empty());
        let parts: Vec<String> = on.into_iter().chain(keys).collect();
        let angle = Seat::parse("EBX").unwrap_or(seat);
        let of_an_angle: Vec<String> = cause
            .keys
            .iter()
            .filter(|key| key.unit(angle) != key.unit(seat))
            .map(|key| format!("; on an angular function `{}`", key.written(angle)))
            .collect();
        let of_an_angle = of_an_angle.concat();
        let or = match cause.seat {
            SeatKind::Function => &of_an_angle,
            SeatKind::Slides => "; without `on`, all axes alike",
            SeatKind::Body => "; on a ball, a scale such as EXX1 (um_m) or the bar",
            SeatKind::Reading => "; on EXt, EYt, EZt or bar",
            _ => "",
        };
        format!("write `{}:{}`{or}", cause.id, parts.join(","))
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.cause.id)?;
        let on = Some(("on".to_owned(), self.seat.to_string())).filter(|(_, on)| !on.is_empty());
        let numbers = self.written().into_iter().map(|(name, number)| (name, number.to_string()));
        for (k, (name, value)) in on.into_iter().chain(numbers).enumerate() {
            write!(f, "{}{name}={value}", if k == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_read_back_as_they_are_written() {
        for text in [
            "cyclic:on=EBZ,amplitude_urad=0.7,period_mm=2.5,phase_rad=-1.25",
            "drift:on=EXX1,amplitude_um_m=12,time_constant_s=600",
            "drift:on=EZt,amplitude_um=6,time_constant_s=500",
            "roundness:amplitude_um=0.3,degree=3,order=-2",
            "servo:on=Y,delay_ms=-0.4",
            "pivot:on=X",
        ] {
            assert_eq!(Effect::parse(text).unwrap().to_string().trim_end_matches(':'), text);
        }
    }

    #[test]
    fn what_cannot_be_is_refused_with_what_can() {
        for (text, what) in [
            ("cycle", "unknown cause `cycle`"),
            ("cyclic", "`cyclic` does not say what it acts on"),
            ("cyclic:on=X", "`cyclic` cannot act on `X`"),
            ("cyclic:on=EXX,period_mm=10", "`cyclic` does not say its `amplitude_um`"),
            ("cyclic:on=EXX,period_mm=0", "`period_mm` of `cyclic` must be from 0.5 to 500, not 0"),
            (
                "cyclic:on=EXX,period_mm=NaN",
                "`period_mm` of `cyclic` must be from 0.5 to 500, not NaN",
            ),
            (
                "roundness:amplitude_um=1,degree=2,order=-3",
                "`order` of `roundness` must be from -2 to 2, its degree, not -3",
            ),
            (
                "roundness:amplitude_um=1,degree=2.5",
                "`degree` of `roundness` must be a whole number, not 2.5",
            ),
            (
                "degree:on=EXX,amplitude_um=1,degree=4.5",
                "`degree` of `degree` must be a whole number, not 4.5",
            ),
            (
                "knock:on=EXt,step_um=1,moment_s=1,run=1.5",
                "`run` of `knock` must be a whole number, not 1.5",
            ),
            ("servo:on=X,on=Y,delay_ms=1", "`on` of `servo` is given twice"),
            ("servo:on=X,delay_ms=1,delay_ms=2", "`delay_ms` of `servo` is given twice"),
            ("cyclic:on=EXX,amplitude_urad=1", "`cyclic` has no `amplitude_urad`"),
            ("servo:on=X,delay_ms=five", "`five` is no number, for `delay_ms` of `servo`"),
            ("servo:on=X,delay_ms", "`delay_ms` of `servo` has no value"),
            ("friction-tilt:on=EXX,amplitude_um=1", "`friction-tilt` cannot act on `EXX`"),
        ] {
            let error = Effect::parse(text).unwrap_err();
            assert_eq!(error.what, what);
            assert!(error.hint.is_some());
        }
    }
}
