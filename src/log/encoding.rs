//! From bytes to text, whichever program wrote them.

use std::borrow::Cow;
use std::path::Path;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

use crate::error::{Error, Place, Result};
use crate::plan::log_format::Format;

const EXPORT: &str = "a log is text, plain or gzipped, an Excel workbook (.xlsx) or a .b5r of Ballbar 20: export it as CSV (UTF-8), \
    or name its `encoding` under `[log]` in the test file";

/// A text that is not UTF-8 grows to three times its size at the most.
const LARGEST_OTHER_BYTES: usize = 1 << 27;

/// A text, and the name of its encoding.
type Decoded<'a> = (Cow<'a, str>, &'static str);

/// The text of a log, and the name of its encoding.
///
/// A byte order mark decides, then the test file. Without either, UTF-16 is known by its zeros and UTF-8 by being valid; what is
/// left is taken for Windows-1252. Numbers are the same in every code page of Windows: another one spoils the names of
/// columns at the most, and then they are not found.
pub(super) fn as_text<'a>(bytes: &'a [u8], file: &Path, format: &Format) -> Result<Decoded<'a>> {
    let (encoding, bytes) = match Encoding::for_bom(bytes) {
        Some((encoding, length)) => (Some(encoding), &bytes[length..]),
        None => (format.encoding.map(crate::plan::log_format::TextEncoding::get), bytes),
    };
    let guessed = encoding.is_none();
    let encoding = encoding.or_else(|| utf16(bytes)).unwrap_or(UTF_8);
    if encoding != UTF_8 {
        return decoded(bytes, encoding, file);
    }
    let (wrong, what) = match std::str::from_utf8(bytes) {
        Ok(text) => match text.find('\0') {
            None => return Ok((Cow::Borrowed(text), UTF_8.name())),
            Some(at) => (at, "the log is not text: it holds a NUL byte".to_owned()),
        },
        Err(_) if guessed && bytes.iter().all(|&byte| is_text(byte)) => {
            return decoded(bytes, WINDOWS_1252, file);
        }
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

fn decoded<'a>(bytes: &'a [u8], encoding: &'static Encoding, file: &Path) -> Result<Decoded<'a>> {
    let refused = |what: String| Err(Error::input(what).at(Place::file(file)).hint(EXPORT));
    let name = encoding.name();
    if bytes.len() > LARGEST_OTHER_BYTES {
        return refused(format!("the log has more than 128 MiB in {name}"));
    }
    match encoding.decode_without_bom_handling_and_without_replacement(bytes) {
        None => refused(format!("the log is not text in {name}")),
        Some(text) if text.contains('\0') => {
            refused(format!("the log is not text in {name}: it holds a NUL"))
        }
        Some(text) => Ok((text, name)),
    }
}

/// UTF-16 without its mark: in a log nearly every second byte is zero.
fn utf16(bytes: &[u8]) -> Option<&'static Encoding> {
    const LOOKED_AT: usize = 4096;
    let pairs = bytes[..bytes.len().min(LOOKED_AT)].chunks_exact(2);
    let (count, mut zeros) = (pairs.len(), [0, 0]);
    for pair in pairs {
        for (zeros, byte) in zeros.iter_mut().zip(pair) {
            *zeros += usize::from(*byte == 0);
        }
    }
    let most = |zeros: usize| zeros * 10 > count * 8;
    let few = |zeros: usize| zeros * 10 < count;
    match zeros {
        [first, second] if few(first) && most(second) => Some(UTF_16LE),
        [first, second] if most(first) && few(second) => Some(UTF_16BE),
        _ => None,
    }
}

/// Whether text in a code page of Windows may have a byte: a tab, the end of a line or of the file, a sign.
fn is_text(byte: u8) -> bool {
    matches!(byte, b'\t' | b'\n' | b'\r' | 0x0C | 0x1A) || byte >= b' '
}
