//! Files of results: they appear whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::output::{Talk, print, print_summary};
use crate::error::{Error, Kind, Place, Result};

/// Files that belong together: nothing is written before all are ready.
#[derive(Default)]
pub(super) struct Files {
    ready: Vec<(PathBuf, Vec<u8>)>,
}

impl Files {
    pub(super) fn add(&mut self, file: PathBuf, content: impl Into<Vec<u8>>) {
        self.ready.push((file, content.into()));
    }

    /// Refuses to replace files that were read.
    pub(super) fn keep(&self, read: &[PathBuf]) -> Result<()> {
        let whole = |file: &Path| std::fs::canonicalize(file).ok();
        let read: Vec<PathBuf> = read.iter().filter_map(|file| whole(file)).collect();
        let replaced = self
            .ready
            .iter()
            .find(|(file, _)| whole(file).is_some_and(|file| read.contains(&file)));
        let Some((file, _)) = replaced else { return Ok(()) };
        Err(Error::new(Kind::Output, "this would replace a file that was read")
            .at(Place::file(file))
            .hint("choose another directory with `-o DIR`"))
    }

    /// Writes all, prints the result as JSON or as a summary, and says what was written.
    pub(super) fn deliver(
        self,
        as_json: bool,
        talk: &Talk,
        json: &str,
        summary: &str,
    ) -> Result<()> {
        let files = self.write()?;
        if as_json {
            print(json)?;
        } else {
            print_summary(summary)?;
        }
        for file in files {
            talk.say(&format!("wrote {}", file.display()));
        }
        Ok(())
    }

    /// Writes all, each to a temporary file beside its place and then under its name.
    pub(super) fn write(self) -> Result<Vec<PathBuf>> {
        let mut staged = Vec::new();
        for (file, content) in &self.ready {
            staged.push((stage(file, content)?, file));
        }
        for (temporary, file) in staged {
            temporary.persist(file).map_err(|error| cannot_write(file, &error.error))?;
        }
        Ok(self.ready.into_iter().map(|(file, _)| file).collect())
    }
}

/// Refuses a directory that results could not be written to, before any work is done for them; nothing is made.
pub(super) fn check_directory(directory: &Path) -> Result<()> {
    let there = directory.ancestors().find(|ancestor| ancestor.exists());
    let there = there.unwrap_or_else(|| Path::new("."));
    if there.is_file() {
        return Err(Error::new(
            Kind::Output,
            "a file stands where the directory of results should be",
        )
        .at(Place::file(there))
        .hint("choose another directory with `-o DIR`"));
    }
    // Whether one may write cannot be read off the permissions; the file is gone at once.
    tempfile::tempfile_in(there).map_err(|error| cannot_write(directory, &error))?;
    Ok(())
}

fn stage(file: &Path, content: &[u8]) -> Result<tempfile::NamedTempFile> {
    let directory = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(directory).map_err(|error| cannot_write(directory, &error))?;
    if file.is_dir() {
        return Err(Error::new(Kind::Output, "a directory stands where the file should go")
            .at(Place::file(file))
            .hint("choose another directory with `-o`"));
    }
    let write = || -> std::io::Result<tempfile::NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        let mut temporary = with_usual_permissions(&mut builder).tempfile_in(directory)?;
        temporary.write_all(content)?;
        temporary.flush()?;
        Ok(temporary)
    };
    write().map_err(|error| cannot_write(file, &error))
}

/// Temporary files are private by default; results are for everybody, as the umask allows.
#[cfg(unix)]
fn with_usual_permissions<'a, 'b>(
    builder: &'a mut tempfile::Builder<'b, 'b>,
) -> &'a mut tempfile::Builder<'b, 'b> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(std::fs::Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn with_usual_permissions<'a, 'b>(
    builder: &'a mut tempfile::Builder<'b, 'b>,
) -> &'a mut tempfile::Builder<'b, 'b> {
    builder
}

fn cannot_write(file: &Path, error: &std::io::Error) -> Error {
    Error::new(Kind::Output, format!("cannot write: {error}"))
        .at(Place::file(file))
        .hint("choose a directory that can be written with `-o DIR`")
}
