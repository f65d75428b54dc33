//! How a file that is written names another one.

use std::path::{Component, Path, PathBuf};

use crate::error::{Error, Kind, Place, Result};

/// The way from a directory of results to a file, with slashes on every system: both can be moved, and mailed, together.
/// What lies on another drive is named from its root.
pub(crate) fn path_from(directory: &Path, file: &Path) -> Result<String> {
    let (from, to) = (whole(directory), whole(file));
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let path = if common == 0 {
        // Not the one without links: on Windows that begins with `\\?\`, after which a slash divides nothing.
        std::path::absolute(file).unwrap_or(to)
    } else {
        let up = from.components().skip(common).map(|_| Component::ParentDir);
        up.chain(to.components().skip(common)).collect()
    };
    let text = path.to_str().ok_or_else(|| {
        Error::new(Kind::Output, "a test file cannot name a file whose path is no text")
            .at(Place::file(file))
            .hint("give the file and its directories names in UTF-8")
    })?;
    Ok(if cfg!(windows) { text.replace('\\', "/") } else { text.to_owned() })
}

/// The path from the root, without links as far as there is something.
fn whole(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    for there in absolute.ancestors() {
        if let (Ok(whole), Ok(rest)) = (there.canonicalize(), absolute.strip_prefix(there)) {
            return whole.join(rest);
        }
    }
    absolute
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_leads_from_one_to_the_other() {
        let directory = tempfile::tempdir().unwrap();
        let root = directory.path();
        std::fs::create_dir_all(root.join("a/b")).unwrap();
        for (from, to, way) in [
            ("a", "a/m.toml", "m.toml"),
            ("a/new/er", "a/m.toml", "../../m.toml"),
            ("a/b", "m.toml", "../../m.toml"),
            (".", "a/b/m.toml", "a/b/m.toml"),
            ("a/../a/b", "a/m.toml", "../m.toml"),
        ] {
            assert_eq!(path_from(&root.join(from), &root.join(to)).unwrap(), way, "{from} {to}");
        }
    }
}
