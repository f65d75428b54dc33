//! Null space in words.

use std::fmt::Write as _;

use crate::model::Parameter;
use crate::solve::NullDirection;

/// A confounded group as a sentence: `EBXb acts as -40.0 mm/rad EXXb + 160.0 mm/rad EZXb`.
pub fn sentence(direction: &NullDirection, parameters: &[Parameter]) -> String {
    let name = |column: usize| {
        parameters.get(column).map_or("the time map", |parameter| parameter.name.as_str())
    };
    let Some((first, rest)) = direction.parts.split_first() else { return String::new() };
    if rest.is_empty() {
        return format!("{} has no effect on the length", name(first.0));
    }
    let mut text = format!("{} acts as", name(first.0));
    for (k, (column, share)) in rest.iter().enumerate() {
        // The direction is invisible: one unit of the first is undone by the shares of the others.
        let factor = -share / first.1;
        let sign = match (factor < 0.0, k) {
            (true, 0) => " -",
            (false, 0) => " ",
            (true, _) => " - ",
            (false, _) => " + ",
        };
        // A factor of one needs no word.
        let size = match significant(factor.abs()).as_str() {
            "1" => String::new(),
            size => format!("{size} "),
        };
        let _ = write!(text, "{sign}{size}{}", name(*column));
    }
    text
}

/// One parameter of each confounded group, as `terms` leaves it out: `-EBXb`.
pub(super) fn leave_out(directions: &[NullDirection], parameters: &[Parameter]) -> Vec<String> {
    let mut left_out: Vec<String> = Vec::new();
    for direction in directions {
        let names = direction.parts.iter().filter_map(|(column, _)| parameters.get(*column));
        let mut names = names.map(|parameter| format!("-{}", parameter.name));
        left_out.extend(names.find(|name| !left_out.contains(name)));
    }
    left_out
}

/// Four significant digits, without an exponent where it can be read without.
fn significant(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        let digits = (3 - value.log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') {
            return text.trim_end_matches('0').trim_end_matches('.').to_owned();
        }
        return text;
    }
    format!("{value:.3e}")
}
