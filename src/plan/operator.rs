//! How long the operator takes: no program knows it, so the test file states it.

use serde::Deserialize;
use toml::Spanned;

use crate::error::Result;
use crate::toml_text::Text;

/// What the time of a whole test assumes of its operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operator {
    /// To place the two balls and set the work offset, once a mounting, s.
    pub set_up_s: f64,
    /// To fit the bar, once an engagement, s.
    pub fit_bar_s: f64,
    /// To press start at an M00 between two arcs, s.
    pub stop_s: f64,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawOperator {
    set_up_min: Option<Spanned<f64>>,
    fit_bar_min: Option<Spanned<f64>>,
    stop_s: Option<Spanned<f64>>,
}

/// Nobody takes longer than a day.
const LONGEST_S: f64 = 86_400.0;

impl RawOperator {
    pub(super) fn check(&self, text: &Text<'_>) -> Result<Operator> {
        let seconds = |value: &Option<Spanned<f64>>, key: &str, default: f64, unit_s: f64| {
            let value = value
                .as_ref()
                .map_or(Ok(default), |value| text.within(value, key, 0.0, LONGEST_S / unit_s));
            value.map(|value| value * unit_s)
        };
        Ok(Operator {
            set_up_s: seconds(&self.set_up_min, "set_up_min", 10.0, 60.0)?,
            fit_bar_s: seconds(&self.fit_bar_min, "fit_bar_min", 1.0, 60.0)?,
            stop_s: seconds(&self.stop_s, "stop_s", 10.0, 1.0)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::Test;

    fn with(operator: &str) -> crate::Result<Test> {
        let source = format!(
            "name = \"t\"\nmachine = \"m.toml\"\n{operator}\n[ball_bar]\nlength_mm = 150.0\n\
             [[mounting]]\nname = \"A\"\ncoincidence_mm = [0, 0, 0]\ntool_ball_mm = [0, 0, -200]\n"
        );
        Test::parse(&source, "t.toml".as_ref())
    }

    #[test]
    fn minutes_of_the_file_are_seconds_inside() {
        let stated = *with("[operator]\nset_up_min = 7.5\nstop_s = 4").unwrap().operator();
        assert_eq!((stated.set_up_s, stated.fit_bar_s, stated.stop_s), (450.0, 60.0, 4.0));
        let assumed = *with("").unwrap().operator();
        assert_eq!((assumed.set_up_s, assumed.fit_bar_s, assumed.stop_s), (600.0, 60.0, 10.0));
    }

    #[test]
    fn impossible_times_are_refused_with_their_line() {
        for (operator, told) in [
            ("[operator]\nset_up_min = -1.0", "`set_up_min` must lie between 0 and 1440"),
            ("[operator]\nstop_s = nan", "`stop_s` must lie between 0 and 86400"),
            ("[operator]\nset_up_s = 600.0", "unknown field `set_up_s`"),
        ] {
            let error = with(operator).unwrap_err();
            assert!(error.what.contains(told), "{error}");
            assert_eq!(error.place.as_ref().unwrap().line, 4, "{error}");
        }
    }
}
