//! A program before it is known what it drives.

use std::path::{Path, PathBuf};

use super::program::Program;
use super::read::{read, text_of};
use super::reading::Reading;
use crate::error::Result;

/// The text of a program: what it drives hangs on the control, on its work offsets above all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file it stands in.
    pub file: PathBuf,
    /// The text.
    pub text: String,
}

impl Source {
    /// Reads the file, gzipped or not.
    ///
    /// # Errors
    /// When the file cannot be read or is not text.
    pub fn read(file: &Path) -> Result<Self> {
        Ok(Self { file: file.to_path_buf(), text: text_of(file)? })
    }

    /// What a control makes of it.
    ///
    /// # Errors
    /// When it cannot be followed, with the place of the word.
    pub fn program(&self, reading: &Reading) -> Result<Program> {
        read(&self.text, &self.file, reading)
    }
}
