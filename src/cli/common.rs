//! What every subcommand can be told.

use std::path::PathBuf;

use clap::Args;

/// Options that every subcommand takes.
#[derive(Args)]
pub(super) struct Common {
    /// Directory for results; made if it is not there
    #[arg(short, long, global = true, default_value = "out", value_name = "DIR")]
    pub(super) output: PathBuf,
    /// Replace files in it that were not written by this program, or edited since
    #[arg(long, global = true)]
    pub(super) overwrite: bool,
    /// Print results as JSON on stdout instead of text
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// Print nothing but results and errors
    #[arg(short, long, global = true)]
    pub(super) quiet: bool,
}
