//! Which files were written into a directory, and what they were.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Read;

use sha2::{Digest, Sha256};

/// SHA-256 of a content, in hexadecimal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Hash(String);

impl Hash {
    pub(super) fn of(content: &[u8]) -> Self {
        Self::told(&Sha256::digest(content))
    }

    /// Of all that a reader gives.
    pub(super) fn of_reader(reader: &mut impl Read) -> std::io::Result<Self> {
        let mut hasher = Sha256::new();
        let mut buffer = vec![0; 1 << 16];
        loop {
            match reader.read(&mut buffer)? {
                0 => return Ok(Self::told(&hasher.finalize())),
                count => hasher.update(&buffer[..count]),
            }
        }
    }

    fn told(bytes: &[u8]) -> Self {
        Self(bytes.iter().fold(String::new(), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        }))
    }
}

/// Names and hashes of the files that were written into a directory.
#[derive(Debug, Clone, Default)]
pub(super) struct Manifest(BTreeMap<String, Hash>);

impl Manifest {
    /// Reads the lines that [`to_text`](Self::to_text) writes; what is no such line names no file of ours.
    pub(super) fn parse(text: &str) -> Self {
        let lines = text.lines().filter_map(|line| line.split_once("  "));
        Self(lines.map(|(hash, name)| (name.to_owned(), Hash(hash.to_owned()))).collect())
    }

    /// As `sha256sum -c` reads it.
    pub(super) fn to_text(&self) -> String {
        self.0.iter().fold(String::new(), |mut text, (name, Hash(hash))| {
            let _ = writeln!(text, "{hash}  {name}");
            text
        })
    }

    pub(super) fn of(&self, name: &str) -> Option<&Hash> {
        self.0.get(name)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    pub(super) fn enter(&mut self, name: &str, hash: Hash) {
        self.0.insert(name.to_owned(), hash);
    }

    pub(super) fn forget(&mut self, name: &str) {
        self.0.remove(name);
    }
}
