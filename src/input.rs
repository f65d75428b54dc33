//! Files on their way in: plain or gzipped, whole or an error.

use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::error::{Error, Place, Result};

/// No log or program comes near this; a gzipped file that does is not one.
const LARGEST_BYTES: u64 = 1 << 30;

/// The content of a file, unpacked if it is gzipped; `what` names it in messages, such as "log".
pub(crate) fn read(file: &Path, what: &str) -> Result<Vec<u8>> {
    let bytes = std::fs::read(file).map_err(|error| {
        let refused =
            Error::input(format!("cannot read the {what}: {error}")).at(Place::file(file));
        match error.kind() {
            ErrorKind::NotFound => {
                refused.hint("check the path; paths inside a test file are relative to that file")
            }
            ErrorKind::IsADirectory => {
                refused.hint(format!("name a {what}, not the directory it is in"))
            }
            _ => refused,
        }
    })?;
    inflate(bytes, file, what)
}

/// Unpacks gzip, which is known by its first two bytes: instruments and mail programs rename files.
pub(crate) fn inflate(bytes: Vec<u8>, file: &Path, what: &str) -> Result<Vec<u8>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    let mut unpacked = flate2::read::MultiGzDecoder::new(bytes.as_slice()).take(LARGEST_BYTES + 1);
    let refused = |text: String| {
        Err(Error::input(text)
            .at(Place::file(file))
            .hint("copy it again from where it was made; `gzip -t` tells whether it is whole"))
    };
    match unpacked.read_to_end(&mut plain) {
        Ok(_) if plain.len() as u64 > LARGEST_BYTES => {
            refused(format!("the gzipped {what} unpacks to more than 1 GiB"))
        }
        Ok(_) => Ok(plain),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
            refused(format!("the gzipped {what} is truncated"))
        }
        Err(error) => refused(format!("the gzipped {what} is corrupt: {error}")),
    }
}
