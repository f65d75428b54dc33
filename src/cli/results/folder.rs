//! The directory of results while it is written to, by one command at a time.
//!
//! Beside the results lies `.ballbar`:
//!
//! | in it | is |
//! | --- | --- |
//! | `written` | names and hashes of what was written, as `sha256sum` has them |
//! | `measured` | SHA-256 of the readings that all of it is of; only in a folder that the program has named |
//! | `lock` | locked by the command that writes |
//! | `staged` | files that are not complete yet; of no worth once their command is dead |
//! | `next` | a complete set that is taking its place: `new` the files that come, `old` those that go, `written` |
//!
//! Files are staged and on the disk before `staged` becomes `next` in one rename. From there on the set is decided:
//! a command that is killed between two files leaves the rest to the next one.

use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::manifest::{Hash, Manifest};
use super::rename::rename;
use crate::error::{Error, Kind, Place, Result};
use crate::input::is_in_use;

/// The directory of results, locked.
pub(super) struct Folder {
    directory: PathBuf,
    /// Its `.ballbar`.
    own: PathBuf,
    lock: File,
    /// Directories that were not there before, the innermost first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Makes the directory if it is not there, waits until nobody else writes to it, and sets it right.
    pub(super) fn open(directory: &Path, overwrite: bool) -> Result<Self> {
        let own = directory.join(".ballbar");
        let failed = |error| cannot_write(directory, &error);
        let missing = directory.ancestors().take_while(|ancestor| !ancestor.exists());
        let made: Vec<PathBuf> = missing.map(Path::to_path_buf).collect();
        loop {
            fs::create_dir_all(&own).map_err(failed)?;
            let lock = File::create(own.join("lock")).map_err(failed)?;
            match lock.lock() {
                // A file system without locks has one user.
                Err(error) if error.kind() != ErrorKind::Unsupported => return Err(failed(error)),
                _ => {}
            }
            // Whoever had it may have cleaned up behind himself.
            if own.join("lock").exists() {
                let folder = Self { directory: directory.to_path_buf(), own, lock, made };
                folder.set_right(overwrite)?;
                return Ok(folder);
            }
        }
    }

    /// Takes the folder for what was measured; says whether results of the same were here before.
    ///
    /// # Errors
    /// When it holds results of something else.
    pub(super) fn claim(&self, measured: &str) -> Result<bool> {
        match measured_in(&self.directory) {
            Some(there) if there == measured => Ok(true),
            None if !self.own.join("written").exists() => {
                let file = self.own.join("measured");
                fs::write(&file, measured).map_err(|error| cannot_write(&file, &error))?;
                Ok(false)
            }
            _ => Err(Error::new(Kind::Output, "another command has just written here")
                .at(Place::file(&self.directory))
                .hint("run it again: it will take the next folder")),
        }
    }

    /// What was written here.
    pub(super) fn manifest(&self) -> Manifest {
        // Where it cannot be read, no file is known to be ours.
        Manifest::parse(&fs::read_to_string(self.own.join("written")).unwrap_or_default())
    }

    /// What stands under a name, if something does.
    pub(super) fn hash_of(&self, name: &str) -> Result<Option<Hash>> {
        let file = self.directory.join(name);
        if file.is_dir() {
            return Err(Error::new(Kind::Output, "a directory stands where the file should go")
                .at(Place::file(&file))
                .hint("choose another directory with `-o`"));
        }
        match File::open(&file).and_then(|mut content| Hash::of_reader(&mut content)) {
            Ok(hash) => Ok(Some(hash)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(cannot_write(&file, &error)),
        }
    }

    /// Writes a file where it waits for the others.
    pub(super) fn stage(&self, name: &str, content: &[u8]) -> Result<()> {
        let (place, staged) = (self.directory.join(name), self.own.join("staged/new"));
        let write = || {
            fs::create_dir_all(&staged)?;
            let mut file = File::create(staged.join(name))?;
            file.write_all(content)?;
            if let Ok(before) = fs::metadata(&place) {
                file.set_permissions(before.permissions())?;
            }
            file.sync_all()
        };
        write().map_err(|error| cannot_write(&place, &error))
    }

    /// Puts the staged files in their places, and takes away what the manifest has no more: all, or none.
    pub(super) fn exchange(self, manifest: &Manifest) -> Result<()> {
        let staged = self.own.join("staged");
        let decide = || {
            let mut file = File::create(staged.join("written"))?;
            file.write_all(manifest.to_text().as_bytes())?;
            file.sync_all()?;
            // Windows renames no directory in which a file is open.
            drop(file);
            synchronise(&staged.join("new"))?;
            synchronise(&staged)?;
            rename(&staged, &self.own.join("next"))?;
            synchronise(&self.own)
        };
        decide().map_err(|error| cannot_write(&self.directory, &error))?;
        let mut moved = Vec::new();
        if let Err(error) = self.carry(&mut moved) {
            for (from, to) in moved.iter().rev() {
                // What cannot be put back is finished by the next command.
                rename(to, from).map_err(|_| error.clone())?;
            }
            let _ = fs::remove_dir_all(self.own.join("next"));
            return Err(error);
        }
        Ok(())
    }

    /// Every file to its place, the manifest last; what was moved is noted.
    fn carry(&self, moved: &mut Vec<(PathBuf, PathBuf)>) -> Result<()> {
        let (next, old) = (self.own.join("next"), self.own.join("next/old"));
        let failed = |place: &Path| {
            let place = place.to_path_buf();
            move |error: std::io::Error| cannot_write(&place, &error)
        };
        let mut rename =
            |from: PathBuf, to: PathBuf| rename(&from, &to).map(|()| moved.push((from, to)));
        fs::create_dir_all(&old).map_err(failed(&self.directory))?;
        let (before, after) = (self.manifest(), manifest_in(&next));
        let new = names_in(&next.join("new")).map_err(failed(&self.directory))?;
        let gone = before.names().filter(|name| after.of(name).is_none()).map(str::to_owned);
        for name in new.iter().cloned().chain(gone) {
            let place = self.directory.join(&name);
            if fs::symlink_metadata(&place).is_ok() {
                rename(place.clone(), old.join(&name)).map_err(failed(&place))?;
            }
            let coming = next.join("new").join(&name);
            if coming.exists() {
                rename(coming, place.clone()).map_err(failed(&place))?;
            }
        }
        synchronise(&self.directory).map_err(failed(&self.directory))?;
        rename(next.join("written"), self.own.join("written")).map_err(failed(&self.directory))?;
        // What is left of it says nothing any more; the next command takes it away if this one cannot.
        let _ = fs::remove_dir_all(next);
        Ok(())
    }

    /// Finishes a set that was decided, and takes away what was not.
    fn set_right(&self, overwrite: bool) -> Result<()> {
        let next = self.own.join("next");
        if next.join("written").exists() {
            if !overwrite {
                self.check_unfinished(&next)?;
            }
            self.carry(&mut Vec::new())?;
        }
        for leftover in [next, self.own.join("staged")] {
            if leftover.exists() {
                fs::remove_dir_all(&leftover).map_err(|error| cannot_write(&leftover, &error))?;
            }
        }
        Ok(())
    }

    /// Nobody has edited a file since the command was killed that was about to replace it.
    fn check_unfinished(&self, next: &Path) -> Result<()> {
        let (before, after) = (self.manifest(), manifest_in(next));
        let failed = |error| cannot_write(&self.directory, &error);
        for name in names_in(&next.join("new")).map_err(failed)? {
            let Some(there) = self.hash_of(&name)? else { continue };
            if ![before.of(&name), after.of(&name)].contains(&Some(&there)) {
                let what = "a command was killed before it had replaced this file, which is not as it was written";
                return Err(Error::new(Kind::Output, what)
                    .at(Place::file(&self.directory.join(name)))
                    .hint("move it elsewhere, or let `--overwrite` finish what was begun"));
            }
        }
        Ok(())
    }
}

impl Drop for Folder {
    /// Leaves nothing of a set that was not written, and of a directory only what was there.
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(self.own.join("staged"));
        if !self.own.join("written").exists() && !self.own.join("next").exists() {
            let _ = fs::remove_file(self.own.join("measured"));
            let _ = fs::remove_file(self.own.join("lock"));
            let _ = fs::remove_dir(&self.own);
            for directory in &self.made {
                let _ = fs::remove_dir(directory);
            }
        }
        let _ = self.lock.unlock();
    }
}

/// Sets a directory right that a command has left which was killed while it wrote; one that is being written to is.
pub(super) fn set_right(directory: &Path, overwrite: bool) -> Result<()> {
    let own = directory.join(".ballbar");
    if !own.join("next").exists() && !own.join("staged").exists() {
        return Ok(());
    }
    let lock = File::create(own.join("lock")).map_err(|error| cannot_write(directory, &error))?;
    if let Err(TryLockError::WouldBlock) = lock.try_lock() {
        return Ok(());
    }
    Folder { directory: directory.to_path_buf(), own, lock, made: Vec::new() }.set_right(overwrite)
}

/// What was measured that the results in a directory are of, where the program has named it.
pub(super) fn measured_in(directory: &Path) -> Option<String> {
    fs::read_to_string(directory.join(".ballbar/measured")).ok()
}

fn manifest_in(next: &Path) -> Manifest {
    Manifest::parse(&fs::read_to_string(next.join("written")).unwrap_or_default())
}

/// Names in a directory, in order.
fn names_in(directory: &Path) -> std::io::Result<Vec<String>> {
    let entries = fs::read_dir(directory)?;
    let mut names = entries
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<std::io::Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// Waits until the names in a directory are on the disk.
#[cfg(unix)]
fn synchronise(directory: &Path) -> std::io::Result<()> {
    File::open(directory)?.sync_all()
}

/// Other systems write the names with the files.
#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "elsewhere it can fail")]
fn synchronise(_directory: &Path) -> std::io::Result<()> {
    Ok(())
}

pub(super) fn cannot_write(file: &Path, error: &std::io::Error) -> Error {
    let hint = if is_in_use(error) {
        "close it in the program that shows it, such as Excel, or choose another directory with `-o DIR`"
    } else {
        "choose a directory that can be written with `-o DIR`"
    };
    Error::new(Kind::Output, format!("cannot write: {error}")).at(Place::file(file)).hint(hint)
}
