//! Excel workbooks: a sheet becomes lines of text, one a row, so that everything else goes as with any log.
//!
//! The cells are read one by one, and of a formula the value that Excel stored with it is taken.

use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

use calamine::{DataRef, ExcelDateTime, Reader as _, SheetType, Xlsx, XlsxError};

use super::text::quote;
use super::workbook_parts;
use crate::error::{Error, Place, Result};

/// The lines that a sheet becomes: a hundred letters a row.
const LARGEST_TEXT_BYTES: usize = 1 << 27;
/// Excel holds no more letters in a cell.
const MOST_LETTERS: usize = 32_767;
/// Excel has no more.
const MOST_ROWS: u32 = 1 << 20;
const MOST_COLUMNS: u32 = 1 << 14;
/// So many sheets are listed in a message.
const LISTED: usize = 20;

const EXPORT: &str =
    "save it again as .xlsx without a password, or export the sheet as CSV (UTF-8)";

type Workbook<'a> = Xlsx<Cursor<&'a [u8]>>;

/// Whether a file is an archive, as new workbooks are.
pub(super) fn is_archive(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// Whether a file is of the kind that old workbooks are, and new ones with a password.
pub(super) fn is_compound(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0xD0, 0xCF, 0x11, 0xE0, 0xA1, 0xB1, 0x1A, 0xE1])
}

/// The rows of the named sheet, or of the only one that holds something, as lines with tabs between the cells; with its name.
pub(super) fn as_text(bytes: &[u8], file: &Path, sheet: Option<&str>) -> Result<(String, String)> {
    let refused = |what: String, hint: String| Error::input(what).at(Place::file(file)).hint(hint);
    let unreadable = |error: XlsxError| {
        refused(format!("the workbook cannot be read: {error}"), EXPORT.to_owned())
    };
    if is_compound(bytes) {
        return Err(refused(
            "the log is an old workbook (.xls), or has a password".into(),
            EXPORT.into(),
        ));
    }
    workbook_parts::check(bytes).map_err(|what| refused(what, EXPORT.to_owned()))?;
    let mut workbook: Workbook = Xlsx::new(Cursor::new(bytes)).map_err(unreadable)?;
    let all = workbook.sheets_metadata().iter();
    let sheets: Vec<String> =
        all.filter(|of| of.typ == SheetType::WorkSheet).map(|of| of.name.clone()).collect();
    let listed = |names: &[String]| {
        let more = if names.len() > LISTED { ", ..." } else { "" };
        let names: Vec<String> = names.iter().take(LISTED).map(|name| quote(name)).collect();
        names.join(", ") + more
    };
    let name = if let Some(wanted) = sheet {
        let same = |name: &&String| name.trim().to_lowercase() == wanted.trim().to_lowercase();
        let exact = sheets.iter().find(|name| *name == wanted);
        exact.or_else(|| sheets.iter().find(same)).cloned().ok_or_else(|| {
            refused(
                format!("the workbook has no sheet {}; it has {}", quote(wanted), listed(&sheets)),
                "name one of them: `sheet` under `[log]` in the test file".to_owned(),
            )
        })?
    } else {
        let mut filled = Vec::new();
        for name in &sheets {
            if sheets.len() == 1 || is_filled(&mut workbook, name).map_err(unreadable)? {
                filled.push(name.clone());
            }
        }
        match filled.as_slice() {
            [one] => one.clone(),
            [] => return Err(refused("the workbook is empty".into(), "was it saved?".into())),
            [first, ..] => {
                return Err(refused(
                    format!("the workbook has {} sheets: {}", filled.len(), listed(&filled)),
                    format!(
                        "say which holds the log: write `sheet = {first:?}` under `[log]` in the test file"
                    ),
                ));
            }
        }
    };
    let text = rows(&mut workbook, &name).map_err(|fault| match fault {
        Fault::Xlsx(error) => unreadable(error),
        Fault::Other(what, hint) => {
            refused(format!("sheet {}: {what}", quote(&name)), hint.to_owned())
        }
    })?;
    Ok((text, name))
}

fn is_filled(workbook: &mut Workbook, name: &str) -> std::result::Result<bool, XlsxError> {
    let mut cells = workbook.worksheet_cells_reader(name)?;
    while let Some(cell) = cells.next_cell()? {
        if *cell.get_value() != DataRef::Empty {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Why a sheet cannot be read.
enum Fault {
    Xlsx(XlsxError),
    /// What is wrong, and what to do.
    Other(String, &'static str),
}

impl From<XlsxError> for Fault {
    fn from(error: XlsxError) -> Self {
        Self::Xlsx(error)
    }
}

fn rows(workbook: &mut Workbook, name: &str) -> std::result::Result<String, Fault> {
    let mut cells = workbook.worksheet_cells_reader(name)?;
    let mut text = String::new();
    // Where the text ends.
    let (mut row, mut column) = (0, 0);
    let mut last = None;
    while let Some(cell) = cells.next_cell_with_formula_metadata()? {
        if cell.value == DataRef::Empty {
            if cell.formula.is_some() {
                return Err(Fault::Other(
                    format!("the formula in {} has no stored value", address(cell.pos)),
                    "open the workbook in Excel and save it, or paste the values in place of the formulas",
                ));
            }
            continue;
        }
        let (at_row, at_column) = cell.pos;
        let outside = at_row >= MOST_ROWS || at_column >= MOST_COLUMNS;
        if outside || last.replace(cell.pos).is_some_and(|last| cell.pos <= last) {
            return Err(Fault::Other(
                format!("cell {} stands where no cell can", address(cell.pos)),
                EXPORT,
            ));
        }
        for _ in row..at_row {
            text.push('\n');
            column = 0;
        }
        for _ in column..at_column {
            text.push('\t');
        }
        (row, column) = cell.pos;
        if words(&cell.value).len() > 4 * MOST_LETTERS {
            return Err(Fault::Other(
                format!("cell {} holds more than {MOST_LETTERS} letters", address(cell.pos)),
                EXPORT,
            ));
        }
        push(&mut text, &cell.value);
        if text.len() > LARGEST_TEXT_BYTES {
            return Err(Fault::Other(
                format!("it has more than {} MiB of text", LARGEST_TEXT_BYTES >> 20),
                "copy the columns of the log to a workbook of their own",
            ));
        }
    }
    text.push('\n');
    Ok(text)
}

/// What a cell says in words; nothing of numbers.
fn words<'a>(value: &'a DataRef<'a>) -> &'a str {
    match value {
        DataRef::SharedString(words) => words,
        DataRef::String(words) | DataRef::DateTimeIso(words) | DataRef::DurationIso(words) => words,
        _ => "",
    }
}

/// A cell as text: numbers with a decimal point, whatever the country.
fn push(text: &mut String, value: &DataRef) {
    // Writing to a string cannot fail.
    let _ = match value {
        DataRef::Int(number) => write!(text, "{number}"),
        DataRef::Float(number) => write!(text, "{number}"),
        DataRef::Bool(truth) => write!(text, "{truth}"),
        DataRef::DateTime(time) => push_time(text, time),
        DataRef::Error(error) => write!(text, "{error}"),
        DataRef::String(_)
        | DataRef::SharedString(_)
        | DataRef::DateTimeIso(_)
        | DataRef::DurationIso(_) => {
            text.extend(words(value).chars().map(|c| if c.is_control() { ' ' } else { c }));
            Ok(())
        }
        DataRef::Empty => Ok(()),
    };
}

/// A time as a time of day, behind the number of its day where it has one.
fn push_time(text: &mut String, time: &ExcelDateTime) -> std::fmt::Result {
    const DAY_US: u64 = 86_400_000_000;
    let days = time.as_f64();
    // From 1900 to 9999.
    if !(0.0..3e6).contains(&days) {
        return write!(text, "{days}");
    }
    let all_us = (days * DAY_US as f64).round() as u64;
    let (day, of_day_us) =
        if time.is_duration() { (0, all_us) } else { (all_us / DAY_US, all_us % DAY_US) };
    if day > 0 {
        write!(text, "{day} ")?;
    }
    let (seconds, us) = (of_day_us / 1_000_000, of_day_us % 1_000_000);
    write!(text, "{:02}:{:02}:{:02}.{us:06}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// `B7`, as Excel calls a cell.
fn address((row, column): (u32, u32)) -> String {
    let mut letters = Vec::new();
    let mut left = u64::from(column) + 1;
    while left > 0 {
        left -= 1;
        letters.push(char::from(b'A' + (left % 26) as u8));
        left /= 26;
    }
    format!("{}{}", letters.iter().rev().collect::<String>(), u64::from(row) + 1)
}
