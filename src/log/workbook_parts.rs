//! The parts of a workbook, looked at before anybody believes them.
//!
//! A workbook is an archive of packed XML, small on the disk and as large in memory as its author likes, and the library that
//! reads it makes room for what the XML announces. Each part is therefore unpacked once, without being kept, for its size and
//! for what it announces.

use std::io::{BufRead, BufReader, Cursor, Read};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use super::text::quote;

/// A million rows of four numbers, unpacked.
const LARGEST_SHEET_BYTES: u64 = 1 << 28;
/// All different texts of a workbook; a table of numbers has a few.
const LARGEST_STRINGS_BYTES: u64 = 1 << 26;
/// What else is read of a workbook: formats, names of sheets.
const LARGEST_PART_BYTES: u64 = 1 << 22;
/// Excel numbers the formulas that cells share, and a log has hardly any.
const MOST_SHARED_FORMULAS: u64 = 1 << 16;
/// The shortest text of the table of texts, `<si/>`.
const SHORTEST_TEXT_BYTES: u64 = 5;

/// Unpacks the parts that are read, without keeping them: what an archive says of their size need not be true, nor what
/// a part says of how much is in it.
///
/// # Errors
/// What is wrong, in words.
pub(super) fn check(bytes: &[u8]) -> Result<(), String> {
    let damaged = |error: &dyn std::fmt::Display| format!("the workbook is damaged: {error}");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut sheets_left = LARGEST_SHEET_BYTES;
    for index in 0..archive.len() {
        let part = archive.by_index(index).map_err(|error| damaged(&error))?;
        let name = part.name().map_err(|error| damaged(&error))?.to_lowercase();
        let is_read = [".xml", ".rels"].iter().any(|end| name.ends_with(end));
        if !is_read {
            continue;
        }
        let is_sheet = name.contains("worksheets/");
        let most = match () {
            () if is_sheet => sheets_left,
            () if name.contains("sharedstrings") => LARGEST_STRINGS_BYTES,
            () => LARGEST_PART_BYTES,
        };
        let mut counted = Counted { inner: BufReader::new(part.take(most + 1)), bytes: 0 };
        let announced = announced(&mut counted);
        // What is not XML ends early: the rest counts too.
        std::io::copy(&mut counted, &mut std::io::sink()).map_err(|error| damaged(&error))?;
        let unpacked = counted.bytes;
        if unpacked > most {
            let most = most.min(LARGEST_SHEET_BYTES) >> 20;
            return Err(format!(
                "{} of the workbook unpacks to more than {most} MiB",
                quote(&name)
            ));
        }
        let [texts, formulas] = announced?;
        if texts > unpacked / SHORTEST_TEXT_BYTES || formulas > MOST_SHARED_FORMULAS {
            return Err(format!(
                "{} of the workbook announces more than it can hold",
                quote(&name)
            ));
        }
        if is_sheet {
            sheets_left -= unpacked;
        }
    }
    Ok(())
}

/// The largest numbers of texts and of shared formulas that a part announces, wherever its name says that it belongs; behind
/// what is no XML nothing, for there it is refused where it is read.
///
/// # Errors
/// A cell that says that it holds a number, and does not.
fn announced(part: &mut impl BufRead) -> Result<[u64; 2], String> {
    let mut reader = Reader::from_reader(part);
    // As leniently as the library that reads the workbook.
    reader.config_mut().check_end_names = false;
    let (mut buffer, mut most) = (Vec::new(), [0, 0]);
    // Whether the cell is said to hold a number, and whether its value is being read.
    let (mut number, mut value) = (false, false);
    loop {
        buffer.clear();
        let event = reader.read_event_into(&mut buffer);
        match event {
            Ok(Event::Start(element) | Event::Empty(element)) => {
                match element.local_name().as_ref() {
                    "sst" => most[0] = count(&element, "uniqueCount").max(most[0]),
                    "f" => most[1] = count(&element, "si").max(most[1]),
                    "c" => number = attribute(&element, "t").is_some_and(|kind| kind == "n"),
                    _ => {}
                }
                value = element.local_name().as_ref() == "v";
            }
            Ok(Event::Text(text)) if number && value => {
                let text = text.xml10_content();
                if !text.chars().all(|c| c.is_ascii_digit() || "+-.eE".contains(c)) {
                    return Err(format!("a number of the workbook is {}", quote(&text)));
                }
            }
            Ok(Event::End(_)) => value = false,
            Ok(Event::Eof) | Err(_) => return Ok(most),
            Ok(_) => {}
        }
    }
}

/// A number that an element states; 0 where it states none, and as much as there is where it is no number.
fn count(element: &BytesStart, name: &str) -> u64 {
    attribute(element, name).map_or(0, |stated| stated.trim().parse().unwrap_or(u64::MAX))
}

fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let mut attributes = element.attributes();
    let mut named = attributes.with_checks(false).flatten();
    let named = named.find(|attribute| attribute.key.local_name().as_ref() == name)?;
    Some(named.value.to_string())
}

/// What is read, and how much of it.
struct Counted<R> {
    inner: R,
    bytes: u64,
}

impl<R: BufRead> Read for Counted<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let read = self.inner.read(out)?;
        self.bytes += read as u64;
        Ok(read)
    }
}

impl<R: BufRead> BufRead for Counted<R> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, read: usize) {
        self.bytes += read as u64;
        self.inner.consume(read);
    }
}
