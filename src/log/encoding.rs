//! From bytes to text.

use std::path::Path;

use crate::error::{Error, Place, Result};

const EXPORT: &str = "a log is text in UTF-8, plain or gzipped: export it as CSV (UTF-8)";

pub(super) fn as_text<'a>(bytes: &'a [u8], file: &Path) -> Result<&'a str> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let (wrong, what) = match std::str::from_utf8(bytes) {
        Ok(text) => match text.find('\0') {
            None => return Ok(text),
            Some(at) => (at, "the log is not text: it holds a NUL byte".to_owned()),
        },
        Err(e) => {
            let at = e.valid_up_to();
            (at, format!("the log is not UTF-8: byte 0x{:02X}", bytes[at]))
        }
    };
    let number = bytes[..wrong].split(|&b| b == b'\n').count();
    let start = bytes[..wrong].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
    let rest = &bytes[start..];
    let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
    let column = String::from_utf8_lossy(&rest[..wrong - start]).chars().count() + 1;
    let shown = String::from_utf8_lossy(&rest[..end]);
    Err(Error::input(what).at(Place::span(file, number, column, 1, &shown)).hint(EXPORT))
}
