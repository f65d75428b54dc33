//! `ballbar history`: a machine over time.

use std::path::{Path, PathBuf};

use clap::Args;

use super::common::Common;
use super::output::{self, Talk};
use super::results::{Page, path_from};
use crate::error::{Error, Place, Result};
use crate::monitor::{History, Past, find};
use crate::report;

/// Show a machine over time: each quantity of all analyses below a folder, with its trend
///
/// Reads every file called *analysis*.json below the folder, in the order of the days of the tests, and writes history.html
/// and history.json. A file that cannot be read, that has no day, is of another machine or of the same readings as another
/// is listed with the reason; that is no failure (exit code 0) as long as one analysis is left.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar history
  ballbar history measurements -o reports
  ballbar history out --machine \"VMC 3\" --json | jq '.series[] | select(.trend.verdict == \"drifts\")'")]
pub(super) struct Arguments {
    /// The folder below which the analyses lie
    #[arg(value_name = "FOLDER", default_value = "out")]
    folder: PathBuf,
    /// The machine, by its name or serial number, where the folder has several; else the one with most tests
    #[arg(long, value_name = "NAME")]
    machine: Option<String>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let files = find(&self.folder)?;
        talk.reads(&files);
        let progress = talk.progress(files.len(), "reading");
        let read = files.iter().map(|file| {
            let past = Past::read(file);
            progress.inc(1);
            (file.clone(), past)
        });
        let (history, left_out) = History::of(read.collect(), self.machine.as_deref());
        talk.ended(&progress);
        let told = |of: &crate::monitor::LeftOut| format!("{}: {}", of.file.display(), of.reason);
        for of in &left_out {
            talk.say(&format!("left out: {}", told(of)));
        }
        let Some(history) = history else {
            let what = match (&self.machine, left_out.first()) {
                (Some(machine), _) if !files.is_empty() => {
                    format!("no analysis below this folder is of a machine `{machine}`")
                }
                (_, Some(of)) => format!("no analysis below this folder can be used: {}", told(of)),
                _ => "there is no analysis below this folder".to_owned(),
            };
            return Err(Error::input(what).at(Place::file(&self.folder)).hint(
                "name the folder below which the results of `ballbar analyse` lie, such as `out`",
            ));
        };
        let page = Page::or_out(common, "history.html");
        let name = |file: &Path| {
            path_from(page.directory(), file).unwrap_or_else(|_| file.display().to_string())
        };
        let json = report::history_json(&history, &name);
        let html = report::history_page(&history, &name)?;
        let text = output::json_text("history", json);
        let written = page.write(
            common,
            &files,
            vec![(page.name().to_owned(), html), (page.beside("json"), text.clone())],
        )?;
        if common.json {
            output::print(&text)?;
        } else {
            output::print_summary(&report::history_text(&history))?;
        }
        written.told(talk);
        Ok(())
    }
}
