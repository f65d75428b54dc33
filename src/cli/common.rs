//! What every subcommand can be told.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

/// Options that every subcommand takes.
#[allow(clippy::struct_excessive_bools)] // switches of a command line
#[derive(Args)]
pub(super) struct Common {
    /// Directory for results; made if it is not there [default: out; of an analysis a folder in it]
    #[arg(short, long, global = true, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    /// Replace files in it that were not written by this program, or edited since
    #[arg(long, global = true)]
    pub(super) overwrite: bool,
    /// Print results as JSON on stdout instead of text
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// Print nothing but results and errors
    #[arg(short, long, global = true)]
    pub(super) quiet: bool,
    /// Say what is read and how long each stage takes, on stderr
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub(super) verbose: bool,
    /// Open the page that was written in the browser
    #[arg(long, global = true)]
    pub(super) open: bool,
    /// Whether a terminal gets colours
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub(super) color: Color,
}

/// When to colour.
#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Color {
    /// Where a terminal shows them and `NO_COLOR` is not set
    Auto,
    /// Into files and pipes, too
    Always,
    /// Nowhere
    Never,
}

impl Common {
    /// Directory for results.
    pub(super) fn directory(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new("out"))
    }
}
