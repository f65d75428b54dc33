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
        // Built, a subcommand knows the options that all have, and the program that it is called with.
        let mut whole = whole.clone();
        whole.build();
        let subcommands = whole.get_subcommands().filter(|c| !c.is_hide_set());
        let subcommands = subcommands.filter(|c| c.get_name() != "help").cloned();
        let pages = subcommands.map(|page| {
            let name = format!("ballbar-{}", page.get_name());
            (page, name)
        });
        let pages: Vec<_> =
            std::iter::once((whole.clone(), "ballbar".to_owned())).chain(pages).collect();
        for (page, name) in pages {
            let mut text = Vec::new();
            let page = clap_mangen::Man::new(page).title(name.clone());
            page.source(concat!("ballbar ", env!("CARGO_PKG_VERSION"))).render(&mut text).map_err(
                |error| Error::new(Kind::Output, format!("cannot make the man page: {error}")),
            )?;
            let text = String::from_utf8_lossy(&text).replace("\n.SH EXTRA\n", "\n.SH EXAMPLES\n");
            files.add(format!("{name}.1"), text);
        }
        files.write()?.told(talk);
        Ok(())
    }
}
