//! The folder of a test's results under `out/`: named after its day and its name, of one measurement alone.

use std::path::{Path, PathBuf};

use jiff::Zoned;

use super::folder::measured_in;
use crate::cli::common::Common;
use crate::error::{Error, Kind, Place, Result};

/// Longer names of tests are cut, letters.
const LONGEST: usize = 60;
/// So many measurements of one name may be made in a day.
const MOST: u32 = 1000;

/// A folder, and what was measured that its results are of.
pub(crate) struct Own {
    pub(super) directory: PathBuf,
    /// SHA-256 of the readings; `None` in a directory that the user has chosen.
    pub(super) measured: Option<String>,
}

impl Own {
    /// The directory that the user names, or one of these readings alone: the same every time, and never one in which
    /// something else lies.
    ///
    /// # Errors
    /// When there are too many of that name.
    pub(crate) fn choose(
        common: &Common,
        name: &str,
        date: Option<&str>,
        measured: &str,
    ) -> Result<Self> {
        if let Some(directory) = &common.output {
            return Ok(Self { directory: directory.clone(), measured: None });
        }
        let date = date.map_or_else(|| Zoned::now().date().to_string(), str::to_owned);
        let named = format!("{date}-{}", as_file_name(name));
        for number in 1..=MOST {
            let numbered = if number == 1 { named.clone() } else { format!("{named}-{number}") };
            let directory = common.directory().join(numbered);
            let free = !directory.exists() || measured_in(&directory).as_deref() == Some(measured);
            if free {
                return Ok(Self { directory, measured: Some(measured.to_owned()) });
            }
        }
        Err(Error::new(Kind::Output, format!("there are {MOST} folders of this name"))
            .at(Place::file(&common.directory().join(named)))
            .hint("choose a directory with `-o DIR`, or give the test another name"))
    }

    /// The directory that the user names, or one under `out/`.
    pub(crate) fn named(common: &Common, name: &str) -> Self {
        let chosen = common.output.clone();
        let directory = chosen.unwrap_or_else(|| common.directory().join(name));
        Self { directory, measured: None }
    }

    /// Where the results go.
    pub(crate) fn directory(&self) -> &Path {
        &self.directory
    }
}

/// A name of a test as a name of a folder, on every system: letters and digits, and `-` between.
fn as_file_name(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '_' | '.') { c } else { ' ' };
    let words: String = name.chars().map(plain).collect();
    let joined = words.split_whitespace().collect::<Vec<_>>().join("-");
    let cut: String = joined.chars().take(LONGEST).collect();
    match cut.trim_matches(['-', '.']) {
        "" => "test".to_owned(),
        kept => kept.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::as_file_name;

    #[test]
    fn a_name_is_one_of_a_folder() {
        for (name, folder) in [
            ("HU40-T five days", "HU40-T-five-days"),
            ("Fr\u{e4}se 3: XY/YZ", "Fr\u{e4}se-3-XY-YZ"),
            ("../../etc", "etc"),
            ("a\u{0}b\nc\\d", "a-b-c-d"),
            (" ... ", "test"),
        ] {
            assert_eq!(as_file_name(name), folder, "{name}");
        }
        assert_eq!(as_file_name(&"x".repeat(500)).len(), 60);
    }
}
