//! A mounting as a test file writes it.

use serde::Deserialize;
use toml::Spanned;

use super::parts::{BallBar, NamedMounting};
use crate::error::{Error, Place, Result};
use crate::machine::Mounting;
use crate::toml_text::Text;

/// Nominal lengths of bars, mm: a tenth of the shortest that is sold, and twice the longest with all its extensions.
pub(crate) const LENGTHS_MM: [f64; 2] = [5.0, 3000.0];

/// A bar is longer than what it reads either way.
pub(super) fn check_length(length_mm: f64, range_mm: f64, place: Place) -> Result<()> {
    if length_mm > range_mm {
        return Ok(());
    }
    Err(Error::input(format!("a bar of {length_mm} mm cannot read {range_mm} mm either way"))
        .at(place)
        .hint("give the nominal length between the centres of the two balls"))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMounting {
    name: Spanned<String>,
    coincidence_mm: Spanned<[f64; 3]>,
    tool_ball_mm: Spanned<[f64; 3]>,
    work_offset: Option<Spanned<String>>,
    bar_length_mm: Option<Spanned<f64>>,
}

/// Each has unknowns of its own and is put up by hand.
const MOST_MOUNTINGS: usize = 100;

pub(super) fn check_mountings(
    raw: &[RawMounting],
    bar: &BallBar,
    text: &Text<'_>,
) -> Result<Vec<NamedMounting>> {
    let beyond = raw.get(MOST_MOUNTINGS).map(|entry| entry.name.span());
    let hint = "three places that lie not on one line determine the whole volume";
    text.at_most(raw.len(), MOST_MOUNTINGS, "mountings", beyond, hint)?;
    let mut mountings: Vec<NamedMounting> = Vec::new();
    for entry in raw {
        let name = entry.name.get_ref().clone();
        if name.is_empty() || mountings.iter().any(|mounting| mounting.name == name) {
            return Err(Error::input(format!(
                "there is another mounting `{name}`, or the name is empty"
            ))
            .at(text.place(entry.name.span()))
            .hint("give every mounting its own name"));
        }
        let work_offset = match &entry.work_offset {
            None => 54,
            Some(written) => written
                .get_ref()
                .strip_prefix('G')
                .and_then(|number| number.parse().ok())
                .filter(|number| (54..=59).contains(number))
                .ok_or_else(|| {
                    Error::input(format!("`{}` is not a work offset", written.get_ref()))
                        .at(text.place(written.span()))
                        .hint("write one of `G54` to `G59`")
                })?,
        };
        let bar_length_mm = match &entry.bar_length_mm {
            None => bar.length_mm,
            Some(length) => {
                let length_mm =
                    text.within(length, "bar_length_mm", LENGTHS_MM[0], LENGTHS_MM[1])?;
                check_length(length_mm, bar.range_mm, text.place(length.span()))?;
                length_mm
            }
        };
        mountings.push(NamedMounting {
            name,
            mounting: Mounting {
                coincidence_mm: text.finite_vector(&entry.coincidence_mm, "coincidence_mm")?,
                tool_ball_mm: text.finite_vector(&entry.tool_ball_mm, "tool_ball_mm")?,
            },
            work_offset,
            bar_length_mm,
        });
    }
    if mountings.is_empty() {
        return Err(Error::input("the test has no mounting").at(Place::file(text.file)).hint(
            "add `[[mounting]]` with the machine coordinates at which both ball centres coincide",
        ));
    }
    Ok(mountings)
}

/// Index of the mounting of a name.
pub(super) fn mounting_index(
    name: &Spanned<String>,
    mountings: &[NamedMounting],
    text: &Text<'_>,
) -> Result<usize> {
    let index = mountings.iter().position(|mounting| mounting.name == *name.get_ref());
    index.ok_or_else(|| {
        let names: Vec<&str> = mountings.iter().map(|m| m.name.as_str()).collect();
        Error::input(format!("there is no mounting `{}`", name.get_ref()))
            .at(text.place(name.span()))
            .hint(format!("the mountings are `{}`", names.join("`, `")))
    })
}
