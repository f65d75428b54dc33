//! In which language a program is written, as far as its file tells.

use std::path::Path;

use super::grammar::Form;
use crate::error::{Error, Place, Result};

/// Refuses a program that is plainly one of another control: read in a wrong language, half of it might pass.
pub(crate) fn check(source: &str, file: &Path, form: Form) -> Result<()> {
    let Some(written) = of(source, file).filter(|written| *written != form) else { return Ok(()) };
    let (name, dialect) = match written {
        Form::Numbered => ("a Fanuc or LinuxCNC", "\"fanuc\"` or `dialect = \"linuxcnc\""),
        Form::Keywords => ("a Siemens control", "\"siemens\""),
        Form::Klartext => ("a HEIDENHAIN control", "\"heidenhain\""),
    };
    Err(Error::input(format!(
        "this is a program of {name}, and the machine file names another dialect"
    ))
    .at(Place::file(file))
    .hint(format!(
        "write `dialect = {dialect}` in `[controller]`, or take the program of this machine"
    )))
}

/// What the beginning says, or else the ending of the file's name.
fn of(source: &str, file: &Path) -> Option<Form> {
    let first = source.lines().map(str::trim).find(|line| !line.is_empty())?;
    let unnumbered = first.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    if unnumbered.starts_with("BEGIN PGM ") {
        return Some(Form::Klartext);
    }
    if first.starts_with("%_N_") {
        return Some(Form::Keywords);
    }
    if first == "%" {
        return Some(Form::Numbered);
    }
    let name = file.file_name()?.to_str()?.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.')?.1 {
        "mpf" | "spf" => Some(Form::Keywords),
        "h" => Some(Form::Klartext),
        _ => None,
    }
}
