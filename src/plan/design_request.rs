//! What a test is to be designed for: the table `[design]` of a test file.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::raw_mounting::{LENGTHS_MM, check_length};
use crate::error::{Error, Result};
use crate::model::{self, COMPLETE, SetUp};
use crate::toml_text::{FARTHEST_MM, Text};

/// The longest test that is designed: a day. The search takes a minute for it.
const LONGEST_MIN: f64 = 1440.0;
/// Bars and tool balls nearer to each other than this are the same, mm.
const SAME_MM: f64 = 1e-6;
/// A working volume is not thinner than this, mm: the error of a place is what its sigma is about, and the
/// coefficients are told apart by what they do from place to place.
const THINNEST_MM: f64 = 1.0;

/// What is to be small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
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

/// A kit has a handful of bars and a shop a handful of holders; every candidate is tried with each of both.
const MOST_TRIED: usize = 20;

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
                if let Some(name) = written.get_ref().iter().find(|name| is_set_up(name)) {
                    return Err(Error::input(format!("the set-up error `{name}` cannot be wanted"))
                        .at(text.place(written.span()))
                        .hint("name coefficients of the machine; every mounting has its set-up errors anyway"));
                }
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
            let [shortest, longest] = LENGTHS_MM;
            let length_mm = text.within(length, "bar_lengths_mm", shortest, longest)?;
            check_length(length_mm, range_mm, text.place(length.span())).map(|()| length_mm)
        };
        let volume_mm = match self.volume_mm {
            None => None,
            Some(volume) => {
                let ordered = |[low, high]: &[f64; 2]| {
                    -FARTHEST_MM <= *low && *low + THINNEST_MM <= *high && *high <= FARTHEST_MM
                };
                if !volume.get_ref().iter().all(ordered) {
                    return Err(Error::input(format!(
                        "the volume's ranges must go from low to high, {THINNEST_MM} mm at the least"
                    ))
                    .at(text.place(volume.span()))
                    .hint("give machine coordinates, `[[-250, 250], [-250, 250], [-150, 350]]`"));
                }
                Some(volume.into_inner())
            }
        };
        for (count, beyond, what) in [
            (
                self.tool_balls_mm.len(),
                self.tool_balls_mm.get(MOST_TRIED).map(Spanned::span),
                "tool balls",
            ),
            (
                self.bar_lengths_mm.len(),
                self.bar_lengths_mm.get(MOST_TRIED).map(Spanned::span),
                "bar lengths",
            ),
        ] {
            text.at_most(count, MOST_TRIED, what, beyond, "name those that are at hand")?;
        }
        Ok(DesignRequest {
            budget_s: text.within(&self.budget_min, "budget_min", 0.0, LONGEST_MIN)? * 60.0,
            criterion: self.criterion,
            wanted,
            most_mountings,
            places: self.places,
            tool_balls_mm: once(
                self.tool_balls_mm.iter().map(|ball| text.finite_vector(ball, "tool_balls_mm")),
                |a, b| (a - b).norm() < SAME_MM,
            )?,
            bar_lengths_mm: once(self.bar_lengths_mm.iter().map(bar), |a, b| {
                (a - b).abs() < SAME_MM
            })?,
            step_rad: match &self.step_deg {
                None => 15.0,
                Some(step) => text.within(step, "step_deg", 5.0, 90.0)?,
            }
            .to_radians(),
            volume_mm,
        })
    }
}

fn is_set_up(name: &str) -> bool {
    SetUp::parse(name.trim_start_matches('-')).is_some()
}

/// Each of them once: a candidate twice would only take twice the time to look at.
fn once<T>(all: impl Iterator<Item = Result<T>>, same: impl Fn(&T, &T) -> bool) -> Result<Vec<T>> {
    let mut kept: Vec<T> = Vec::new();
    for next in all {
        let next = next?;
        if !kept.iter().any(|before| same(before, &next)) {
            kept.push(next);
        }
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use crate::plan::Test;

    fn request(rest: &str) -> crate::error::Result<super::DesignRequest> {
        let source = format!(
            "name = 'T'\nmachine = 'm.toml'\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\nname = 'A'\n\
             coincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\n\
             feed_mm_min = 500.0\n[design]\nbudget_min = 60.0\n{rest}\n"
        );
        Test::parse(&source, "t.toml".as_ref()).and_then(|test| test.design().cloned())
    }

    #[test]
    fn the_same_bar_or_tool_again_is_no_other_candidate() {
        let request = request(
            "bar_lengths_mm = [150.0, 100.0, 150.0]\n\
             tool_balls_mm = [[0, 0, -250], [0, 0, -250.0]]",
        );
        let request = request.unwrap();
        assert_eq!(request.bar_lengths_mm, [150.0, 100.0]);
        assert_eq!(request.tool_balls_mm.len(), 1);
    }

    #[test]
    fn what_cannot_be_asked_for_is_told_with_its_place() {
        for (rest, told) in [
            ("wanted = ['EXt']", "the set-up error `EXt` cannot be wanted"),
            ("wanted = ['EXX1', 'EYw']", "the set-up error `EYw` cannot be wanted"),
            ("wanted = ['EXX9']", "unknown term `EXX9`"),
            ("volume_mm = [[0, 1e-300], [0, 1], [0, 1]]", "1 mm at the least"),
            ("volume_mm = [[-1e308, 1e308], [0, 1], [0, 1]]", "from low to high"),
            ("volume_mm = [[nan, 1], [0, 1], [0, 1]]", "from low to high"),
            ("tool_balls_mm = [[1e308, 0, 0]]", "got `1e308`"),
            ("bar_lengths_mm = [1.0]", "`bar_lengths_mm` must lie between 5 and 3000"),
            ("bar_lengths_mm = [1e300]", "`bar_lengths_mm` must lie between 5 and 3000"),
            ("most_mountings = 9", "9 mountings"),
            ("step_deg = nan", "between 5 and 90"),
        ] {
            let error = request(rest).unwrap_err();
            assert!(error.what.contains(told), "{told}: {}", error.what);
            assert!(error.hint.is_some() && error.place.is_some_and(|p| p.line > 0), "{told}");
        }
    }
}
