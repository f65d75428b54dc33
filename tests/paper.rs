//! `docs/paper.md` says what the program computes. `BALLBAR_UPDATE_DOCS=1` writes it anew.

use std::path::Path;

use ballbar::paper::{Comparison, Geometry, search};
use ballbar::report::paper_page;

#[test]
fn the_page_about_the_paper_is_true() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/paper.md");
    let update = std::env::var_os("BALLBAR_UPDATE_DOCS").is_some();
    let paper = Comparison::compute(Geometry::DESIGN, &|| {}).unwrap();
    // The search takes seconds with optimisation and minutes without: there, only the rest is compared.
    let nearest = (update || !cfg!(debug_assertions)).then(|| search(&|| {}).unwrap());
    let page = paper_page(&paper, nearest.as_ref());
    if update {
        std::fs::write(&file, &page).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap().replace("\r\n", "\n");
    let same = if nearest.is_some() { written == page } else { written.starts_with(&page) };
    assert!(same, "docs/paper.md is not what is computed; BALLBAR_UPDATE_DOCS=1 writes it anew");
}
