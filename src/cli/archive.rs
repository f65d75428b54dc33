//! `ballbar blind --archive`: the campaigns of the trials as a data set.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde_json::json;

use super::common::Common;
use super::output::{self, Talk};
use super::results::{Files, Own};
use crate::error::{Error, Kind, Result};
use crate::trial::{
    CampaignFiles, CampaignRow, Class, Course, Grid, Made, Request, Session, campaigns_csv,
};

/// Where it goes unless the user says otherwise.
const FOLDER: &str = "campaigns";

/// The table of all of them.
const TABLE: &str = "campaigns.csv";

/// Which campaigns.
pub(super) struct Archive<'a> {
    pub(super) grid: bool,
    pub(super) seed: u64,
    pub(super) size_mm: Option<f64>,
    pub(super) requests: &'a [Request],
    /// The command line that makes it again.
    pub(super) command: String,
}

/// What became of one campaign.
enum Done {
    Written {
        row: CampaignRow,
        file: PathBuf,
        bytes: usize,
        class: Class,
    },
    /// Nothing of its size can be hidden in it.
    Missing {
        campaign: String,
        why: String,
    },
}

fn is_campaign(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension == "zip")
}

impl Archive<'_> {
    pub(super) fn run(self, common: &Common, talk: &Talk) -> Result<()> {
        let own = Own::named(common, FOLDER);
        let progress = talk.progress(self.requests.len(), "campaigns");
        let begun = Mutex::new(false);
        let taken = |request: Request, made: Result<CampaignFiles>| {
            let made = match made {
                Err(error) if error.kind == Kind::Undetermined => {
                    progress.inc(1);
                    let campaign = format!("{}:{}", request.class, request.index);
                    return Ok(Done::Missing { campaign, why: error.what });
                }
                made => made?,
            };
            let zip = made.zip()?;
            let bytes = zip.len();
            let mut files = Files::in_own(common, &own, Vec::new());
            files.add(made.archive_name(), zip);
            // One writes at a time, and the first takes away what there was: zips of other campaigns, and a table that tells of
            // them, would pass for some of these. The table comes back when all are there.
            let mut begun = begun.lock().unwrap_or_else(PoisonError::into_inner);
            if !*begun {
                files.instead_of(|name| is_campaign(name) || name == TABLE);
            }
            let mut written = files.write()?.files;
            *begun = true;
            drop(begun);
            progress.inc(1);
            let file = written.pop().unwrap_or_default();
            Ok(Done::Written { row: made.row(), file, bytes, class: request.class })
        };
        let done = if self.grid {
            Grid { seed: self.seed, size_mm: self.size_mm }.campaigns(self.requests, &taken)
        } else {
            Session::new(Course::built_in()?, self.seed, self.size_mm)?
                .campaigns(self.requests, &taken)
        };
        talk.ended(&progress);
        let done = done?;
        let made = self.made(&done);
        let (mut rows, mut paths, mut bytes) = (Vec::new(), Vec::new(), 0);
        for one in done {
            if let Done::Written { row, file, bytes: of_one, .. } = one {
                rows.push(row);
                paths.push(file);
                bytes += of_one;
            }
        }
        if let (true, Some((campaign, why))) = (rows.is_empty(), made.missing.first()) {
            return Err(Error::new(
                Kind::Undetermined,
                format!("no campaign can be made: {campaign}: {why}"),
            )
            .hint("choose a smaller `--size`, or more `--trials`"));
        }
        let mut files = Files::in_own(common, &own, Vec::new());
        files.add("README.md", made.readme());
        files.add("CITATION.cff", made.citation());
        files.add(TABLE, campaigns_csv(&rows));
        paths.extend(files.write()?.files);
        for (campaign, why) in &made.missing {
            talk.say(&format!("no {campaign}: {why}"));
        }
        if common.json {
            let said = json!({
                "seed": self.seed, "campaigns": rows.len(), "bytes": bytes, "files": paths, "missing": made.missing,
            });
            return output::print_json("archive", said);
        }
        for path in &paths {
            output::print(&format!("{}\n", path.display()))?;
        }
        talk.say(&format!("{} campaigns, {:.1} MB", rows.len(), bytes as f64 * 1e-6));
        Ok(())
    }

    /// How it was made, and what of it there is.
    fn made(&self, done: &[Done]) -> Made {
        let count = |wanted: Class| {
            let of_class =
                |one: &&Done| matches!(one, Done::Written { class, .. } if *class == wanted);
            done.iter().filter(of_class).count()
        };
        let counts = Class::ALL.into_iter().map(|class| (class.name(), count(class)));
        let missing = done.iter().filter_map(|one| match one {
            Done::Missing { campaign, why } => Some((campaign.clone(), why.clone())),
            Done::Written { .. } => None,
        });
        Made {
            seed: self.seed,
            grid: self.grid,
            size_mm: self.size_mm,
            command: self.command.clone(),
            counts: counts.filter(|(_, count)| *count > 0).collect(),
            missing: missing.collect(),
        }
    }
}
