//! A page that the user may name as a file: `-o change.html`.

use std::path::{Path, PathBuf};

use super::own::Own;
use super::{Files, Written};
use crate::cli::common::Common;
use crate::error::Result;

/// Where a page goes.
pub(crate) struct Page {
    directory: PathBuf,
    name: String,
}

impl Page {
    /// The page that `-o` names, or of this name in the directory that it names; `None` without it.
    pub(crate) fn of(common: &Common, name: &str) -> Option<Self> {
        let output = common.output.as_ref()?;
        let is_page = output.extension().is_some_and(|e| e.eq_ignore_ascii_case("html"));
        let named = output.file_name().and_then(|file| file.to_str());
        Some(match (is_page && !output.is_dir(), named) {
            (true, Some(named)) => {
                let parent = output.parent().filter(|parent| *parent != Path::new(""));
                let directory = parent.unwrap_or(Path::new(".")).to_path_buf();
                Self { directory, name: named.to_owned() }
            }
            _ => Self { directory: output.clone(), name: name.to_owned() },
        })
    }

    /// The same, and without `-o` in the usual directory.
    pub(crate) fn or_out(common: &Common, name: &str) -> Self {
        Self::of(common, name).unwrap_or_else(|| Self {
            directory: common.directory().to_path_buf(),
            name: name.to_owned(),
        })
    }

    pub(crate) fn directory(&self) -> &Path {
        &self.directory
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// A file of the same name and another ending.
    pub(crate) fn beside(&self, ending: &str) -> String {
        Path::new(&self.name).with_extension(ending).display().to_string()
    }

    /// Writes files where the page goes.
    pub(crate) fn write(
        &self,
        common: &Common,
        read: &[PathBuf],
        ready: Vec<(String, String)>,
    ) -> Result<Written> {
        let own = Own { directory: self.directory.clone(), measured: None };
        let mut files = Files::in_own(common, &own, read.to_vec());
        for (name, text) in ready {
            files.add(name, text);
        }
        files.write()
    }
}
