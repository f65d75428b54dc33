//! Completions and man pages.

use clap::{Args, Command};
use clap_complete::Shell;

use super::common::Common;
use super::output::{self, Talk};
use super::results::Files;
use crate::error::{Error, Kind, Result};

/// Print the completions of a shell on stdout
#[derive(Args)]
pub(super) struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    pub(super) fn run(&self, whole: &mut Command) -> Result<()> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, whole, "ballbar", &mut text);
        output::print(&String::from_utf8_lossy(&text))
    }
}

/// Write the man pages
#[derive(Args)]
pub(super) struct Man {}

impl Man {
    // The other subcommands have arguments to look at.
    #[expect(clippy::unused_self)]
    pub(super) fn run(&self, whole: &Command, common: &Common, talk: &Talk) -> Result<()> {
        let mut files = Files::of(common, Vec::new());
        let pages = std::iter::once(whole.clone())
            .chain(whole.get_subcommands().filter(|c| !c.is_hide_set()).cloned());
        for page in pages {
            let name = match page.get_name() {
                "ballbar" => "ballbar".to_owned(),
                subcommand => format!("ballbar-{subcommand}"),
            };
            let mut text = Vec::new();
            clap_mangen::Man::new(page).title(name.clone()).render(&mut text).map_err(|error| {
                Error::new(Kind::Output, format!("cannot make the man page: {error}"))
            })?;
            files.add(format!("{name}.1"), text);
        }
        files.write()?.told(talk);
        Ok(())
    }
}
