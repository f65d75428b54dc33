//! `ballbar compare`: what changed from one analysis to another.

use std::path::{Path, PathBuf};

use clap::Args;

use super::common::Common;
use super::output::{self, Talk};
use super::results::{Page, path_from};
use crate::error::Result;
use crate::monitor::{Comparison, Past, resolved};
use crate::report;

/// Say what changed from one analysis to another, beyond the uncertainties of both
///
/// Scales, squarenesses, reversals, straightness, circular values and findings, each with the difference, its standard
/// deviation and a verdict. Of equal tests the difference is known better than either value. What is of another machine,
/// place, bar or test is said, and only what is comparable is compared. With -o, a page with pictures is written.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar compare out/2026-03-02-XY out/2026-04-07-XY
  ballbar compare before/analysis.json after/analysis.json -o change.html
  ballbar compare before after --json | jq '.quantities[] | select(.verdict == \"changed\")'")]
pub(super) struct Arguments {
    /// The earlier analysis.json, or the folder it is in
    #[arg(value_name = "BEFORE")]
    before: PathBuf,
    /// The later one
    #[arg(value_name = "AFTER")]
    after: PathBuf,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let files = [resolved(&self.before)?, resolved(&self.after)?];
        talk.reads(&files);
        let (before, after) = (Past::read(&files[0])?, Past::read(&files[1])?);
        let both = [&before, &after];
        let comparison = Comparison::of(&before, &after);
        let page = Page::of(common, "compare.html");
        let from = page.as_ref().map_or(Path::new("."), Page::directory);
        let name = |past: &Past| {
            path_from(from, &past.file).unwrap_or_else(|_| past.file.display().to_string())
        };
        let json = report::comparison_json(&comparison, both, &name);
        let written = if let Some(page) = &page {
            let text = report::comparison_page(&comparison, both, &name)?;
            Some(page.write(common, &files, vec![(page.name().to_owned(), text)])?)
        } else {
            if common.open {
                talk.say("nothing to open: name a page with `-o change.html`");
            }
            None
        };
        if common.json {
            output::print_json("compare", json)?;
        } else {
            output::print_summary(&report::comparison_text(&comparison, both))?;
        }
        if let Some(written) = written {
            written.told(talk);
        }
        Ok(())
    }
}
