//! Which column a name of the test file means.

use std::ops::Range;
use std::path::Path;

use super::text::{Line, quote};
use crate::error::{Error, Place, Result};

/// So many columns are listed in a message.
const LISTED: usize = 20;

pub(super) const CHOOSE_COLUMNS: &str = "choose the columns in the test file: `time_column` with \
    `time_unit`, or `sample_rate_hz` where the log has no time; `reading_column` with \
    `reading_unit` and `reading` = \"deviation\" or \"length\"";

pub(super) fn same_name(a: &str, b: &str) -> bool {
    a.trim().to_lowercase() == b.trim().to_lowercase()
}

/// Index of the column of a name: as it is written if there is one, else whatever its case.
pub(super) fn find_column(
    file: &Path,
    header: Line,
    fields: &[Range<usize>],
    wanted: &str,
) -> Result<usize> {
    let name = |i: usize| header.text[fields[i].clone()].trim();
    let indices = |matches: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..fields.len()).filter(|&i| matches(name(i))).collect()
    };
    let mut found = indices(&|name| name == wanted.trim());
    if found.is_empty() {
        found = indices(&|name| same_name(name, wanted));
    }
    match found.as_slice() {
        [one] => Ok(*one),
        [] if (0..fields.len()).all(|i| name(i).is_empty() || name(i).parse::<f64>().is_ok()) => {
            Err(Error::input("the log has no header: its first line holds numbers")
                .at(Place::line(file, header.number, header.text))
                .hint(
                    "write the names of the columns above them, in a line that does not begin \
                     with `#`",
                ))
        }
        [] => {
            let names = (0..fields.len()).map(name).filter(|name| !name.is_empty());
            let mut listed: Vec<String> = names.clone().take(LISTED).map(quote).collect();
            match names.count() {
                all if all > LISTED => listed.push(format!("and {} more", all - LISTED)),
                _ => {}
            }
            Err(Error::input(format!(
                "the log has no column `{}`; it has {}",
                wanted.trim(),
                listed.join(", ")
            ))
            .at(Place::line(file, header.number, header.text))
            .hint(CHOOSE_COLUMNS))
        }
        [.., again] => Err(header
            .error(
                file,
                &fields[*again],
                format!("the log has {} columns `{}`", found.len(), wanted.trim()),
            )
            .hint("rename all but one, or choose another column in the test file")),
    }
}
