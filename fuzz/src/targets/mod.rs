//! One function for each reader: what the commands do with an input, as far as it is accepted.

mod align;
mod analysis;
mod b5r;
mod check;
mod effect;
mod files;
mod log;
mod machine;
mod model;
mod motion;
mod past;
mod plan;
mod program;
mod scenario;
mod simulate;
mod tables;
mod test;
mod workbook;

/// A reader.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// What it is called, and where its corpus is.
    pub name: &'static str,
    /// What mutations begin with; the reader takes some of them, or there would be nothing to change.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Words of its language.
    pub words: &'static [&'static str],
    /// Inputs that are too large to be kept as files.
    pub made: &'static [fn() -> Vec<u8>],
    /// Reads an input and goes on as the commands do; says whether it was accepted.
    pub read: fn(&[u8]) -> bool,
}

/// All of them.
pub const ALL: [Target; 18] = [
    machine::TARGET,
    test::TARGET,
    scenario::TARGET,
    model::TARGET,
    effect::TARGET,
    log::TARGET,
    motion::TARGET,
    workbook::TARGET,
    b5r::TARGET,
    program::TARGET,
    check::TARGET,
    plan::TARGET,
    simulate::TARGET,
    align::TARGET,
    analysis::TARGET,
    past::TARGET,
    tables::TARGET,
    files::TARGET,
];

/// A message is what a person reads: it is made of every error, and must not fail either.
fn told(error: &ballbar::Error) {
    let text = error.to_string();
    assert!(!text.is_empty(), "an error says something");
}

/// Whether it was accepted; what was not is told.
fn accepted<T>(result: &Result<T, ballbar::Error>) -> bool {
    if let Err(error) = result {
        told(error);
    }
    result.is_ok()
}
