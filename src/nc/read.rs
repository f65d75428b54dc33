//! From a file or a text to a [`Program`].

use std::path::Path;

use super::listing::Listing;
use super::program::Program;
use super::reading::Reading;
use super::run;
use crate::error::{Error, Place, Result};

/// Reads a program.
///
/// The first program of the text is the main program; the others are its subprograms. What the text does
/// not tell and the control knows comes from `reading`. `file` is only used in messages and kept in the
/// result. An error has the place of the word that cannot be followed.
///
/// ```
/// use ballbar::nc::{Action, Reading, read};
/// use nalgebra::Vector3;
///
/// let mut reading = Reading::default();
/// reading.work_offsets_mm.insert(54, Vector3::new(20.0, -35.0, 40.0));
/// let source = "%\nO1\nG90 G54 G00 X0. Y0. Z0.\nG01 X30. F600.\nM30\n%\n";
/// let program = read(source, "O0001.nc".as_ref(), &reading)?;
/// let Action::Move(first) = program.steps[0].action else { unreachable!() };
/// assert_eq!(first.end_mm, Vector3::new(50.0, -35.0, 40.0));
/// assert_eq!(first.feed_mm_s, 10.0);
/// # Ok::<(), ballbar::Error>(())
/// ```
pub fn read(source: &str, file: &Path, reading: &Reading) -> Result<Program> {
    read_at_most(source, file, reading, run::MOST_BLOCKS)
}

/// Reads a program that runs no more than so many blocks.
pub(crate) fn read_at_most(
    source: &str,
    file: &Path,
    reading: &Reading,
    most_blocks: usize,
) -> Result<Program> {
    let listing = Listing::new(source, file, reading, &mut Err)?;
    let steps = run::run(&listing, reading, most_blocks, &mut Err)?.steps;
    // After the run, because a file that was cut off lacks its M30 too, and that is the better message.
    if let Some(line) = listing.unclosed {
        return Err(listing.cut_off(line));
    }
    Ok(Program {
        file: file.to_path_buf(),
        number: listing.sections.first().and_then(|main| main.number),
        labels: listing.labels,
        steps,
    })
}

/// Reads a program from a file, gzipped or not.
pub fn read_file(file: &Path, reading: &Reading) -> Result<Program> {
    read(&text_of(file)?, file, reading)
}

/// The text of a program file, gzipped or not.
///
/// # Errors
/// When the file cannot be read or is not text.
pub fn text_of(file: &Path) -> Result<String> {
    let bytes = crate::input::read(file, "program")?;
    if bytes.contains(&0) {
        return Err(Error::input("the file is not a program but binary data")
            .at(Place::file(file))
            .hint("a program is plain text; an editor may have saved it as UTF-16"));
    }
    String::from_utf8(bytes)
        .map_err(|error| not_text(error.as_bytes(), error.utf8_error().valid_up_to(), file))
}

/// The error of a byte that is no character.
fn not_text(bytes: &[u8], at: usize, file: &Path) -> Error {
    let before = String::from_utf8_lossy(&bytes[..at]);
    let line = before.matches('\n').count() + 1;
    let beginning = before.rsplit('\n').next().unwrap_or("");
    let column = beginning.chars().count() + 1;
    let text = bytes[at - beginning.len()..].split(|&byte| byte == b'\n').next();
    let text = String::from_utf8_lossy(text.unwrap_or(&[]));
    let byte = bytes.get(at).copied().unwrap_or(0);
    Error::input(format!("byte {byte:#04x} is not text"))
        .at(Place::span(file, line, column, 1, text.trim_end_matches('\r')))
        .hint("save the program as ASCII or UTF-8")
}
