//! `--open`: a page in the browser of the user.

use std::path::PathBuf;

use super::output::Talk;

/// Opens the first page among files; nothing of the results hangs on it.
pub(super) fn open(files: &[PathBuf], talk: &Talk) {
    let is_page = |file: &&PathBuf| file.extension().is_some_and(|e| e == "html");
    let Some(page) = files.iter().find(is_page) else {
        talk.say("nothing to open: no page was written");
        return;
    };
    // From the root: Windows takes `out/..` for an option of the browser's.
    let whole = std::path::absolute(page).unwrap_or_else(|_| page.clone());
    if let Err(error) = open::that_detached(whole) {
        talk.say(&format!("{} cannot be opened here: {error}", page.display()));
    }
}
