//! What a test is to be designed for: the table `[design]` of a test file.

use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;

use crate::error::{Error, Result};
use crate::model::{self, COMPLETE};
use crate::toml_text::Text;

/// What is to be small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Criterion {
    /// The mean square uncertainty of the volumetric error over the working volume.
    #[default]
    A,
    /// The volume of the confidence ellipsoid of the wanted coefficients, in units of what each of them
    /// does to the tool.
    D,
    /// The uncertainty of the volumetric error where it is worst.
    G,
}

/// Where the workpiece ball may be placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Places {
    /// Where the test's mountings are, and in the corners and the middle of the room in which the sphere
    /// fits into the travel.
    #[default]
    Corners,
    /// Where the test's mountings are.
    Mountings,
}

/// A checked request.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRequest {
    /// All that the test may take, the operator's time included, s.
    pub budget_s: f64,
    /// What is to be small.
    pub criterion: Criterion,
    /// The coefficients that must be identifiable; `complete` for all that the candidates can see.
    pub wanted: Vec<String>,
    /// Most mountings.
    pub most_mountings: usize,
    /// Where the workpiece ball may be placed.
    pub places: Places,
    /// Tool balls besides those of the mountings, in the frame of the last slide on the tool side, mm.
    pub tool_balls_mm: Vec<Vector3<f64>>,
    /// Bars, mm; empty for that of the test.
    pub bar_lengths_mm: Vec<f64>,
    /// Step of the candidate arcs, rad.
    pub step_rad: f64,
    /// The working volume, machine coordinates of X, Y and Z, mm; `None` for the whole travel.
    pub volume_mm: Option<[[f64; 2]; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawDesign {
    budget_min: Spanned<f64>,
    #[serde(default)]
    criterion: Criterion,
    wanted: Option<Spanned<Vec<String>>>,
    most_mountings: Option<Spanned<usize>>,
    #[serde(default)]
    places: Places,
    #[serde(default)]
    tool_balls_mm: Vec<Spanned<[f64; 3]>>,
    #[serde(default)]
    bar_lengths_mm: Vec<Spanned<f64>>,
    step_deg: Option<Spanned<f64>>,
    volume_mm: Option<Spanned<[[f64; 2]; 3]>>,
}

impl RawDesign {
    pub(super) fn check(self, range_mm: f64, text: &Text<'_>) -> Result<DesignRequest> {
        let wanted = match self.wanted {
            None => vec![COMPLETE.to_owned()],
            Some(written) => {
                model::terms(written.get_ref(), &[String::new()])
                    .map_err(|error| error.at(text.place(written.span())))?;
                written.into_inner()
            }
        };
        let most_mountings = match &self.most_mountings {
            None => 3,
            Some(most) if (1..=8).contains(most.get_ref()) => *most.get_ref(),
            Some(most) => {
                return Err(Error::input(format!("{} mountings cannot be", most.get_ref()))
                    .at(text.place(most.span()))
                    .hint("give at least one and at most eight"));
            }
        };
        let bar = |length: &Spanned<f64>| {
            let length_mm = text.positive(length, "bar_lengths_mm")?;
            if length_mm > range_mm {
                return Ok(length_mm);
            }
            Err(Error::input(format!("a bar of {length_mm} mm is shorter than its own range"))
                .at(text.place(length.span()))
                .hint("give the nominal lengths between the centres of the balls"))
        };
        let volume_mm = match self.volume_mm {
            None => None,
            Some(volume) => {
                let ordered =
                    |[low, high]: &[f64; 2]| low.is_finite() && high.is_finite() && low < high;
                if !volume.get_ref().iter().all(ordered) {
                    return Err(Error::input("the volume's ranges must go from low to high")
                        .at(text.place(volume.span()))
                        .hint(
                            "give machine coordinates, `[[-250, 250], [-250, 250], [-150, 350]]`",
                        ));
                }
                Some(volume.into_inner())
            }
        };
        Ok(DesignRequest {
            budget_s: text.within(&self.budget_min, "budget_min", 0.0, 100_000.0)? * 60.0,
            criterion: self.criterion,
            wanted,
            most_mountings,
            places: self.places,
            tool_balls_mm: self
                .tool_balls_mm
                .iter()
                .map(|ball| text.finite_vector(ball, "tool_balls_mm"))
                .collect::<Result<_>>()?,
            bar_lengths_mm: self.bar_lengths_mm.iter().map(bar).collect::<Result<_>>()?,
            step_rad: match &self.step_deg {
                None => 15.0,
                Some(step) => text.within(step, "step_deg", 5.0, 90.0)?,
            }
            .to_radians(),
            volume_mm,
        })
    }
}
