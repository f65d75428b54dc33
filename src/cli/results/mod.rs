//! Files of results: all of a command appear together or none, and nothing of the user's is replaced.
//!
//! What was written into a directory stands in its `.ballbar/written`, with hashes: a file that is not as it stands
//! there was made or edited by somebody, and stays unless the user says `--overwrite`.

mod folder;
mod interrupt;
mod manifest;
mod own;
mod page;
mod path_from;
mod rename;

use std::path::{Path, PathBuf};

use super::browser;
use super::common::Common;
use super::output::{Talk, print, print_summary};
use crate::error::{Error, Kind, Place, Result};
use crate::file_name;

use folder::{Folder, cannot_write};
use manifest::{Hash, Manifest};

pub(super) use interrupt::heed as heed_interrupts;
pub(super) use own::Own;
pub(super) use page::Page;
pub(super) use path_from::path_from;

/// The files of a command: nothing is written before all are ready.
pub(super) struct Files {
    directory: PathBuf,
    /// SHA-256 of the readings that they are of, in a folder that the program has named.
    measured: Option<String>,
    overwrite: bool,
    /// Whether what is there stays, whoever wrote it.
    keep: bool,
    /// Whether the page is to be opened when it is written.
    open: bool,
    /// What the command has read: none of it is replaced.
    read: Vec<PathBuf>,
    /// Which files of an earlier command these take the place of, whether or not they are among them.
    replaced: fn(&str) -> bool,
    /// Names and contents.
    ready: Vec<(String, Vec<u8>)>,
}

/// What became of files.
pub(super) struct Written {
    /// In the order in which they were added.
    pub(super) files: Vec<PathBuf>,
    /// Those of an earlier command that are gone.
    pub(super) removed: Vec<PathBuf>,
    /// Whether a page of them is to be opened.
    open: bool,
    /// The folder, where it held results of the same readings that are not the same.
    pub(super) replaced: Option<PathBuf>,
}

impl Files {
    /// None yet; `read` are the files that the command has read.
    pub(super) fn of(common: &Common, read: Vec<PathBuf>) -> Self {
        Self {
            directory: common.directory().to_path_buf(),
            measured: None,
            overwrite: common.overwrite,
            keep: false,
            open: common.open,
            read,
            replaced: |_| false,
            ready: Vec::new(),
        }
    }

    /// None yet, for the folder of a test; `read` are the files that the command has read.
    pub(super) fn in_own(common: &Common, own: &Own, read: Vec<PathBuf>) -> Self {
        Self {
            directory: own.directory.clone(),
            measured: own.measured.clone(),
            ..Self::of(common, read)
        }
    }

    /// None yet, for a directory in which nothing is replaced: what is written there is edited by its user.
    pub(super) fn kept(directory: &Path) -> Self {
        Self {
            directory: directory.to_path_buf(),
            measured: None,
            overwrite: false,
            keep: true,
            open: false,
            read: Vec::new(),
            replaced: |_| false,
            ready: Vec::new(),
        }
    }

    /// These take the place of what was written before under such names: what is not written again would
    /// tell of another analysis.
    pub(super) fn instead_of(&mut self, replaced: fn(&str) -> bool) {
        self.replaced = replaced;
    }

    pub(super) fn add(&mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) {
        self.ready.push((name.into(), content.into()));
    }

    /// Writes all, prints the result as JSON or as a summary, and says what was written.
    pub(super) fn deliver(
        self,
        as_json: bool,
        talk: &Talk,
        json: &str,
        summary: &str,
    ) -> Result<()> {
        let written = self.write()?;
        if as_json {
            print(json)?;
        } else {
            print_summary(summary)?;
        }
        written.told(talk);
        Ok(())
    }

    /// Writes all, or nothing.
    pub(super) fn write(self) -> Result<Written> {
        let (removed, replaced) = (Vec::new(), None);
        let mut written = Written { files: Vec::new(), removed, open: self.open, replaced };
        if self.ready.is_empty() {
            return Ok(written);
        }
        self.check_names()?;
        let _quiet = interrupt::hold();
        let folder = Folder::open(&self.directory, self.overwrite)?;
        let again = self.measured.as_ref().map(|measured| folder.claim(measured)).transpose()?;
        let before = folder.manifest();
        let mut manifest = before.clone();
        for name in before.names() {
            let again = self.ready.iter().any(|(ready, _)| ready == name);
            // One that was edited is not ours any more.
            if (self.replaced)(name) && !again && folder.hash_of(name)?.as_ref() == before.of(name)
            {
                manifest.forget(name);
                written.removed.push(self.directory.join(name));
            }
        }
        for (name, content) in &self.ready {
            let hash = Hash::of(content);
            self.allow(name, &hash, &folder, &before)?;
            if again == Some(true) && before.of(name).is_some_and(|there| *there != hash) {
                written.replaced = Some(self.directory.clone());
            }
            folder.stage(name, content)?;
            manifest.enter(name, hash);
            written.files.push(self.directory.join(name));
            if interrupt::came() {
                drop(folder);
                interrupt::leave();
            }
        }
        folder.exchange(&manifest)?;
        Ok(written)
    }

    /// A name is that of a file in the directory, and no two files have one.
    fn check_names(&self) -> Result<()> {
        let faulty = |name: &str, what: &str| {
            Err(Error::new(Kind::Output, what)
                .at(Place::file(Path::new(name)))
                .hint("give the file that it is named after another name"))
        };
        for (index, (name, _)) in self.ready.iter().enumerate() {
            if name.is_empty() || !name.chars().all(file_name::may_have) {
                return faulty(name, "a file of results cannot have this name");
            }
            if self.ready[..index].iter().any(|(other, _)| other == name) {
                return faulty(name, "two files of results would have this name");
            }
        }
        Ok(())
    }

    /// Whether a file may stand under its name, where perhaps one stands already.
    fn allow(&self, name: &str, hash: &Hash, folder: &Folder, before: &Manifest) -> Result<()> {
        let file = self.directory.join(name);
        let Some(there) = folder.hash_of(name)?.filter(|there| there != hash) else {
            return Ok(());
        };
        let refused = |what: &str, hint: &str| {
            Err(Error::new(Kind::Output, what).at(Place::file(&file)).hint(hint))
        };
        if self.keep {
            return refused(
                "there is such a file already",
                "name a folder of its own for the new files",
            );
        }
        let whole = |file: &Path| std::fs::canonicalize(file).ok();
        let place = whole(&file);
        if self.read.iter().any(|read| place.is_some() && whole(read) == place) {
            return refused(
                "this would replace a file that was read",
                "choose another directory with `-o DIR`",
            );
        }
        if before.of(name) != Some(&there) && !self.overwrite {
            return refused(
                "this would replace a file that was not written here, or was edited since",
                "choose another directory with `-o DIR`; `--overwrite` replaces it",
            );
        }
        Ok(())
    }
}

impl Written {
    /// Opens the page, where that is wanted.
    pub(super) fn shown(&self, talk: &Talk) {
        if self.open {
            browser::open(&self.files, talk);
        }
    }

    /// Says what was written, and what is gone; opens the page, where that is wanted.
    pub(super) fn told(&self, talk: &Talk) {
        self.shown(talk);
        for file in &self.files {
            talk.say(&format!("wrote {}", file.display()));
        }
        if let Some(folder) = &self.replaced {
            let folder = folder.display();
            talk.say(&format!("replaced the results of the same logs that were in {folder}"));
        }
        for file in &self.removed {
            talk.say(&format!("removed {}: it was of an earlier analysis", file.display()));
        }
    }
}

/// Refuses a directory that results could not be written to, before any work is done for them, and sets right what
/// a command left there that was killed while it wrote; nothing is made.
pub(super) fn check_directory(common: &Common) -> Result<()> {
    let directory = common.directory();
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
    folder::set_right(directory, common.overwrite)
}
