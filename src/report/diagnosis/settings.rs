//! What the machine file or the test file states wrong.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::words::what;
use crate::diagnose::WrongSetting;
use crate::machine::{Machine, Pivot};
use crate::model::{Ball, Seat};
use crate::report::text::numbers::{decimals, fixed};

/// Something that the machine file or the test file states wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct WrongSettingFacts {
    /// Which setting.
    pub setting: WrongSetting,
    /// How it is in truth, in words.
    pub in_words: String,
}

impl WrongSettingFacts {
    pub(super) fn new(setting: &WrongSetting, machine: &Machine) -> Self {
        Self { setting: setting.clone(), in_words: in_words(setting, machine) }
    }
}

impl Serialize for WrongSettingFacts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        const UM: f64 = 1e3;
        let effect = &self.setting.effect;
        let mut fields = serializer.serialize_struct("WrongSetting", 6)?;
        fields.serialize_field("cause", effect.cause.id)?;
        fields.serialize_field("effect", &effect.to_string())?;
        fields.serialize_field("on", &effect.seat.to_string())?;
        fields.serialize_field("told", &self.in_words)?;
        fields.serialize_field("before_um", &(self.setting.before_mm * UM))?;
        fields.serialize_field("after_um", &(self.setting.after_mm * UM))?;
        fields.end()
    }
}

/// What a file states wrong, and what to write instead.
fn in_words(wrong: &WrongSetting, machine: &Machine) -> String {
    match wrong.effect.seat {
        Seat::Slide(slide) => {
            let (is, instead) = match machine.slide(slide).pivot {
                Pivot::Carriage => ("carriage", "base"),
                Pivot::Base => ("base", "carriage"),
            };
            format!(
                "The pivot of {slide} is not on the {is}, as the machine file states: write `pivot = \"{instead}\"`"
            )
        }
        place => {
            let sigma_mm = wrong.sigma_mm.unwrap_or(0.0);
            let places = decimals(sigma_mm, 2);
            let mounting = match wrong.effect.get("mounting") {
                0.0 => "every mounting".to_owned(),
                number => format!("mounting no. {number}"),
            };
            let key = match place {
                Seat::Ball(of) if of.ball == Ball::Tool => "tool_ball_mm",
                _ => "coincidence_mm",
            };
            format!(
                "The position of the {} differs from the test file by {} +- {} mm in {mounting}: read `{key}` from the control again",
                what(place).unwrap_or_else(|| "ball".into()),
                fixed(wrong.effect.get("offset"), places),
                fixed(sigma_mm, places)
            )
        }
    }
}
