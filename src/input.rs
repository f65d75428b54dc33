//! Files on their way in: plain or gzipped, whole or an error.

use std::borrow::Cow;
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::sync::OnceLock;

use crate::error::{Error, Place, Result};

/// No log or program comes near this: an hour at 2000 readings a second has a tenth of it.
const LARGEST_BYTES: u64 = 1 << 28;

/// The content of a file, unpacked if it is gzipped; `what` names it in messages, such as "log".
pub(crate) fn read(file: &Path, what: &str) -> Result<Vec<u8>> {
    read_up_to(LARGEST_BYTES, file, what)
}

/// The same, where what unpacks to more bytes may be left at one more than those.
fn read_up_to(most_bytes: u64, file: &Path, what: &str) -> Result<Vec<u8>> {
    let bytes = whole(file, what)?;
    // What is plain is not copied.
    let plain = match unpacked_up_to(most_bytes, &bytes, file, what)? {
        Cow::Owned(plain) => Some(plain),
        Cow::Borrowed(_) => None,
    };
    Ok(plain.unwrap_or(bytes))
}

/// The content of a TOML file. It is small: a thousand arcs have a tenth of a megabyte, and what is read takes a hundred times
/// its size.
pub(crate) fn read_small(file: &Path, what: &str) -> Result<Vec<u8>> {
    let bytes = read_up_to(LARGEST_SMALL_BYTES, file, what)?;
    if bytes.len() as u64 > LARGEST_SMALL_BYTES {
        return Err(Error::input(format!("the {what} has more than 4 MiB"))
            .at(Place::file(file))
            .hint("this is no machine, test, scenario or model file"));
    }
    Ok(bytes)
}

/// Largest TOML file.
const LARGEST_SMALL_BYTES: u64 = 4 << 20;

/// What came from the standard input, which can be read once and may be asked for again.
static PIPED: OnceLock<Vec<u8>> = OnceLock::new();

/// The name of the standard input.
const PIPE: &str = "-";

/// All of the standard input.
fn piped() -> std::io::Result<Vec<u8>> {
    if let Some(bytes) = PIPED.get() {
        return Ok(bytes.clone());
    }
    let mut bytes = Vec::new();
    std::io::stdin().lock().take(LARGEST_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(PIPED.get_or_init(|| bytes).clone())
}

/// The bytes of a file that ends.
fn whole(file: &Path, what: &str) -> Result<Vec<u8>> {
    let told = |error: std::io::Error| {
        let refused =
            Error::input(format!("cannot read the {what}: {error}")).at(Place::file(file));
        match error.kind() {
            ErrorKind::NotFound => {
                refused.hint("check the path; paths inside a test file are relative to that file")
            }
            ErrorKind::IsADirectory => {
                refused.hint(format!("name a {what}, not the directory it is in"))
            }
            _ if is_in_use(&error) => {
                refused.hint("close it in the program that has it open, such as Excel")
            }
            _ => refused,
        }
    };
    if file == Path::new(PIPE) {
        return bounded(piped().map_err(told)?, file, what);
    }
    // A device never ends, and a pipe that nobody writes to never begins; what a shell pipes in does both.
    let metadata = std::fs::metadata(file).map_err(told)?;
    let kind = metadata.file_type();
    let piped = file.starts_with("/dev/fd") || file.starts_with("/dev/stdin");
    if !(kind.is_file() || kind.is_dir() || piped) {
        return Err(Error::input(format!("the {what} is not a file but a device or a pipe"))
            .at(Place::file(file))
            .hint("name a file"));
    }
    // Not every system says so when it is opened.
    if kind.is_dir() {
        return Err(told(ErrorKind::IsADirectory.into()));
    }
    // Room for all of it at once, and some more, into which the end is read.
    let mut bytes = Vec::with_capacity(metadata.len().min(LARGEST_BYTES) as usize + 64);
    let mut limited = std::fs::File::open(file).map_err(told)?.take(LARGEST_BYTES + 1);
    limited.read_to_end(&mut bytes).map_err(told)?;
    bounded(bytes, file, what)
}

/// Whether Windows neither opens nor moves a file because another program has it: Excel has every table that it shows.
pub(crate) fn is_in_use(error: &std::io::Error) -> bool {
    const SHARING_VIOLATION: i32 = 32;
    const LOCK_VIOLATION: i32 = 33;
    let number = error.raw_os_error();
    cfg!(windows) && [Some(SHARING_VIOLATION), Some(LOCK_VIOLATION)].contains(&number)
}

/// Bytes that are not too many.
fn bounded(bytes: Vec<u8>, file: &Path, what: &str) -> Result<Vec<u8>> {
    if bytes.len() as u64 > LARGEST_BYTES {
        return Err(Error::input(format!("the {what} has more than 256 MiB"))
            .at(Place::file(file))
            .hint("this is no log and no program of a ball-bar test; divide it if it is"));
    }
    Ok(bytes)
}

/// Unpacks gzip, which is known by its first two bytes: instruments and mail programs rename files.
pub(crate) fn unpacked<'a>(bytes: &'a [u8], file: &Path, what: &str) -> Result<Cow<'a, [u8]>> {
    unpacked_up_to(LARGEST_BYTES, bytes, file, what)
}

fn unpacked_up_to<'a>(
    most_bytes: u64,
    bytes: &'a [u8],
    file: &Path,
    what: &str,
) -> Result<Cow<'a, [u8]>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut plain = Vec::new();
    let mut unpacked = flate2::read::MultiGzDecoder::new(bytes).take(most_bytes + 1);
    let refused = |text: String| {
        Err(Error::input(text)
            .at(Place::file(file))
            .hint("copy it again from where it was made; `gzip -t` tells whether it is whole"))
    };
    match unpacked.read_to_end(&mut plain) {
        Ok(_) if plain.len() as u64 > LARGEST_BYTES => {
            refused(format!("the gzipped {what} unpacks to more than 256 MiB"))
        }
        Ok(_) => Ok(Cow::Owned(plain)),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
            refused(format!("the gzipped {what} is truncated"))
        }
        Err(error) => refused(format!("the gzipped {what} is corrupt: {error}")),
    }
}
