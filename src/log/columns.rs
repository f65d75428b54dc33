//! Which line names the columns, and which column a name of the test file means.

use std::ops::Range;
use std::path::Path;

use super::clock::Clock;
use super::number::is_no_reading;
use super::text::{Line, quote, split};
use super::unit_line::UnitLine;
use crate::error::{Error, Place, Result};
use crate::plan::log_format::{
    Delimiter, Format, LengthUnit, ReadingColumn, TimeColumn, TimeUnit, is_between,
};

/// So many columns are listed in a message.
const LISTED: usize = 20;
/// So many lines that are neither blank nor comments may stand before the names of the columns.
const LOOKED_AT: usize = 200;

/// So many lines of any kind may, blank ones and comments: more than an instrument writes, and passed over in no time.
const FARTHEST: usize = 100_000;

/// The error of a log that says nothing, at least not in its first lines.
fn nothing_said(file: &Path, goes_on: bool) -> Error {
    let error = if goes_on {
        let what = format!("the first {FARTHEST} lines of the log are blank or comments");
        Error::input(what).hint("cut them off, up to the line that names the columns")
    } else {
        Error::input("the log is empty").hint("was the capture saved?")
    };
    error.at(Place::file(file))
}

/// The line that names the columns, and what separates them.
#[derive(Clone, Copy)]
pub(super) struct Header<'a> {
    pub(super) line: Line<'a>,
    pub(super) delimiter: Delimiter,
}

/// The first line that has all the columns of a format; what loggers write above it is passed over.
///
/// # Errors
/// Where there is none, about the line that probably names them: the last one before the numbers.
pub(super) fn find_header<'a>(
    file: &Path,
    lines: &mut impl Iterator<Item = Line<'a>>,
    format: &Format,
) -> Result<Header<'a>> {
    let (told, mut looked_at) = separated(lines.by_ref(), format);
    let delimiters = told.map_or(Delimiter::ALL.to_vec(), |told| vec![told]);
    let wanted = match &format.time {
        TimeColumn::Named { name, .. } | TimeColumn::Angle { name } => {
            vec![name.as_str(), format.reading.name.as_str()]
        }
        TimeColumn::Rate { .. } => vec![format.reading.name.as_str()],
    };
    let mut fields = Vec::new();
    let mut seen: Vec<Line> = Vec::new();
    for line in looked_at.by_ref().take(LOOKED_AT) {
        for &delimiter in &delimiters {
            split(line.text, delimiter, &mut fields);
            let has = |name: &&str| fields.iter().any(|of| same_name(&line.text[of.clone()], name));
            if wanted.iter().all(has) {
                return Ok(Header { line, delimiter });
            }
        }
        seen.push(line);
    }
    let Some(&first) = seen.first() else {
        drop(looked_at);
        return Err(nothing_said(file, lines.next().is_some()));
    };
    // The message should list the columns as the user sees them, not one long name.
    let mut likely = |line: Line| {
        let mut count = |delimiter: &Delimiter| {
            split(line.text, *delimiter, &mut fields);
            fields.len()
        };
        let apart = [Delimiter::Comma, Delimiter::Semicolon, Delimiter::Tab];
        let most = apart.into_iter().max_by_key(&mut count).unwrap_or(Delimiter::Comma);
        told.unwrap_or(if count(&most) > 1 { most } else { Delimiter::Blanks })
    };
    let mut names = first;
    if !is_data(first, likely(first)) {
        let mut pairs = seen.windows(2);
        if let Some(pair) = pairs.find(|pair| is_data(pair[1], likely(pair[1]))) {
            names = pair[0];
            // Units stand between the names and the numbers.
            if UnitLine::of(names, likely(names)).is_some() {
                let above = seen.iter().rfind(|line| line.number < names.number);
                names = above.copied().unwrap_or(names);
            }
        }
    }
    Ok(Header { line: names, delimiter: likely(names) })
}

/// The lines that say something, and the delimiter that the first of them tells.
fn separated<'a>(
    lines: impl Iterator<Item = Line<'a>>,
    format: &Format,
) -> (Option<Delimiter>, impl Iterator<Item = Line<'a>>) {
    let says = |line: &Line| !line.is_comment() && !line.is_blank();
    let mut lines = lines.take(FARTHEST).filter(says).peekable();
    let mut told = format.delimiter;
    if told.is_none() {
        told = lines.peek().and_then(|line| Delimiter::told(line.text));
        let _ = lines.next_if(|_| told.is_some());
    }
    (told, lines)
}

/// The format with the columns whose names say their units, or the line below them, in the first line that has such; `None` where
/// no line has.
pub(super) fn by_name<'a>(
    lines: impl Iterator<Item = Line<'a>>,
    format: &Format,
) -> Option<Format> {
    let (told, lines) = separated(lines, format);
    let delimiters = told.map_or(Delimiter::ALL.to_vec(), |told| vec![told]);
    let mut fields = Vec::new();
    let mut lines = lines.take(LOOKED_AT).peekable();
    while let Some(line) = lines.next() {
        for &delimiter in &delimiters {
            split(line.text, delimiter, &mut fields);
            let below = lines.peek().and_then(|next| UnitLine::of(*next, delimiter));
            let below = below.filter(|below| below.width() == fields.len());
            let below = below.as_ref();
            let names = || fields.iter().map(|field| &line.text[field.clone()]).enumerate();
            let length = |(k, name): (usize, &'a str)| {
                let unit = LengthUnit::of_column(name).or_else(|| below?.length(k));
                unit.map(|unit| (name, unit))
            };
            let own = |(_, name): &(usize, &str)| same_name(name, &format.reading.name);
            let reading = names()
                .find(own)
                .map(|(k, name)| length((k, name)).unwrap_or((name, format.reading.unit)));
            let time = names().find_map(|(k, name)| {
                let unit = TimeUnit::of_column(name).or_else(|| below?.time(k));
                unit.map(|unit| (name, unit))
            });
            let angle = names().find(|(_, name)| is_angle(name));
            let time = match (time, angle) {
                (Some((name, unit)), _) => TimeColumn::Named { name: name.to_owned(), unit },
                (None, Some((_, name))) => TimeColumn::Angle { name: name.to_owned() },
                (None, None) => continue,
            };
            let Some((name, unit)) = reading.or_else(|| names().find_map(length)) else { continue };
            let reading = ReadingColumn { name: name.to_owned(), unit, ..format.reading.clone() };
            return Some(Format { time, reading, ..format.clone() });
        }
    }
    None
}

/// Whether the name of a column ends with a unit of angles.
fn is_angle(name: &str) -> bool {
    let unit = name.split(is_between).rfind(|word| !word.is_empty());
    unit.is_some_and(|unit| ["deg", "degree", "degrees", "grad", "\u{b0}"].contains(&unit))
}

/// Whether a line holds nothing but numbers, times and words for no reading.
fn is_data(line: Line, delimiter: Delimiter) -> bool {
    let mut fields = Vec::new();
    split(line.text, delimiter, &mut fields);
    let mut written =
        fields.iter().map(|field| &line.text[field.clone()]).filter(|w| !w.is_empty());
    let number =
        |text: &str| text.replace(',', ".").replace('\u{2212}', "-").parse::<f64>().is_ok();
    let has_digit = |text: &str| text.contains(|c: char| c.is_ascii_digit());
    let value = |text: &str| {
        number(text) || is_no_reading(text) || (Clock::is_one(text) && has_digit(text))
    };
    written.clone().any(has_digit) && written.all(value)
}

pub(super) const CHOOSE_COLUMNS: &str = "choose the columns in the test file: `time_column` with \
    `time_unit`, or `sample_rate_hz` where the log has no time; `reading_column` with \
    `reading_unit` and `reading` = \"deviation\" or \"length\"";

pub(super) fn same_name(a: &str, b: &str) -> bool {
    let [a, b] = [a, b].map(|name| name.trim().chars().flat_map(char::to_lowercase));
    a.eq(b)
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
            let names = || (0..fields.len()).map(name).filter(|name| !name.is_empty());
            let mut listed: Vec<String> = names().take(LISTED).map(quote).collect();
            match names().count() {
                all if all > LISTED => listed.push(format!("and {} more", all - LISTED)),
                _ => {}
            }
            Err(Error::input(format!(
                "the log has no column `{}`; it has {}",
                wanted.trim(),
                listed.join(", ")
            ))
            .at(Place::line(file, header.number, header.text))
            .hint(suggested(names()).unwrap_or_else(|| CHOOSE_COLUMNS.to_owned())))
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

/// The lines for the test file where the names of the columns tell their units.
fn suggested<'a>(mut names: impl Iterator<Item = &'a str> + Clone) -> Option<String> {
    let time = names.clone().find(|name| TimeUnit::of_column(name).is_some());
    let reading = names.find(|name| LengthUnit::of_column(name).is_some())?;
    let time = time.map_or("`sample_rate_hz`, the readings a second,".to_owned(), |name| {
        format!("`{}`", key_line("time_column", name))
    });
    Some(format!(
        "write {time} and `{}` under `[log]` in the test file, or the columns that you mean",
        key_line("reading_column", reading)
    ))
}

fn key_line(key: &str, name: &str) -> String {
    let mark = if name.contains(['"', '\\']) { '\'' } else { '"' };
    format!("{key} = {mark}{}{mark}", name.trim())
}

/// The lines under `[log]` without which a test reads other columns, or takes their units for others.
pub(crate) fn lines_for_the_test(format: &Format) -> Vec<String> {
    let default = Format::default();
    let mut lines = Vec::new();
    match &format.time {
        TimeColumn::Named { name, unit } if format.time != default.time => {
            lines.push(key_line("time_column", name));
            if TimeUnit::of_column(name).unwrap_or(TimeUnit::Second) != *unit {
                lines.push(key_line("time_unit", unit.name()));
            }
        }
        TimeColumn::Named { .. } => {}
        TimeColumn::Rate { hz } => lines.push(format!("sample_rate_hz = {hz:?}")),
        TimeColumn::Angle { name } => lines.push(key_line("angle_column", name)),
    }
    let ReadingColumn { name, unit, .. } = &format.reading;
    if *name != default.reading.name {
        lines.push(key_line("reading_column", name));
    }
    if LengthUnit::of_column(name).unwrap_or(LengthUnit::Micrometre) != *unit {
        lines.push(key_line("reading_unit", unit.name()));
    }
    lines
}
