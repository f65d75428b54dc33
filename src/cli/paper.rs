//! `ballbar paper`: the paper's tables beside what comes out here.

use clap::Args;

use super::common::Common;
use super::output::Talk;
use super::results::Files;
use crate::error::Result;
use crate::paper::{self, Comparison, Geometry};
use crate::report;

/// Compute the paper's Section 4 and Tables 2 to 4 again
///
/// Prints ranks and condition numbers of the paper beside those that come out here, with every pivot on
/// its carriage and with the pivot of X on the base, and says where they differ and why.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar paper
  ballbar paper --search --page -o docs
  ballbar paper --json | jq .strategies")]
pub(super) struct Arguments {
    /// Search the geometry whose condition numbers are nearest to the paper's
    #[arg(long)]
    search: bool,
    /// Write the page paper.md, with the result of the search
    #[arg(long)]
    page: bool,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let bar = talk.progress(Comparison::STEPS, "ranks");
        let comparison = Comparison::compute(Geometry::DESIGN, &|| bar.inc(1));
        talk.ended(&bar);
        let comparison = comparison?;
        let nearest = if self.search || self.page {
            let bar = talk.progress(paper::search_steps(), "geometries");
            let nearest = paper::search(&|| bar.inc(1));
            talk.ended(&bar);
            Some(nearest?)
        } else {
            None
        };
        let mut files = Files::of(common, Vec::new());
        if self.page {
            let page = report::paper_page(&comparison, nearest.as_ref());
            files.add("paper.md", page);
        }
        let json = format!("{:#}\n", report::paper_json(&comparison, nearest.as_ref()));
        let text = report::paper_text(&comparison)
            + &nearest.as_ref().map_or_else(String::new, report::nearest_text);
        files.deliver(common.json, talk, &json, &text)
    }
}
