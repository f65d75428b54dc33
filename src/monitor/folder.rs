//! Where analyses lie.

use std::path::{Path, PathBuf};

use crate::error::{Error, Kind, Place, Result};

/// Folders inside folders.
const DEEPEST: usize = 32;
/// Folders and files that are looked at.
const MOST_ENTRIES: usize = 1_000_000;
/// Analyses of one history: one a day for five years.
const MOST: usize = 2000;

/// The analysis that is meant by a file, or by a folder with one in it.
///
/// # Errors
/// When there is none, or more than one.
pub fn resolved(path: &Path) -> Result<PathBuf> {
    if !path.is_dir() {
        return Ok(path.to_path_buf());
    }
    let own = path.join("analysis.json");
    if own.is_file() {
        return Ok(own);
    }
    let refused =
        |what: &str, hint: String| Err(Error::input(what).at(Place::file(path)).hint(hint));
    match &find(path)?[..] {
        [one] => Ok(one.clone()),
        [] => refused(
            "there is no analysis.json in this folder",
            "name the folder of results of `ballbar analyse`".into(),
        ),
        [first, ..] => refused(
            "there is more than one analysis below this folder",
            format!("name one of them, such as {}", first.display()),
        ),
    }
}

/// All files below a folder that are called like an analysis, `*analysis*.json` or the same packed, in the order of
/// their names. Links to folders are not followed.
///
/// # Errors
/// When a folder cannot be read, or too much lies there.
pub fn find(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![(folder.to_path_buf(), 0)];
    let mut seen = 0;
    while let Some((folder, depth)) = open.pop() {
        let failed = |error: std::io::Error| {
            Error::input(format!("the folder cannot be read: {error}"))
                .at(Place::file(&folder))
                .hint("name the folder below which the analyses lie, such as `out`")
        };
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            seen += 1;
            let kind = entry.file_type().map_err(failed)?;
            let name = entry.file_name().to_string_lossy().to_lowercase();
            let path = entry.path();
            if kind.is_dir() && depth < DEEPEST && !name.starts_with('.') {
                open.push((path, depth + 1));
            } else if !kind.is_dir() && is_analysis(&name) {
                found.push(path);
            }
            if seen > MOST_ENTRIES || found.len() > MOST {
                return Err(Error::new(
                    Kind::Input,
                    format!(
                        "below this folder lie more than {MOST} analyses, or {MOST_ENTRIES} files"
                    ),
                )
                .at(Place::file(&folder))
                .hint("name a folder of the one machine"));
            }
        }
    }
    found.sort();
    Ok(found)
}

fn is_analysis(name: &str) -> bool {
    let name = name.strip_suffix(".gz").unwrap_or(name);
    name.strip_suffix(".json").is_some_and(|stem| stem.contains("analysis"))
}
