//! Results for people and for other programs, a folder a document.
//!
//! | folder | document |
//! | --- | --- |
//! | `analysis` | `analysis.json`, `report.html`, `samples-RUN.csv`, the summary |
//! | `circular` | circular tests of ISO 230-4 and tolerances: part of the analysis |
//! | `ranked` | features of the plane of each circular test, ranked: part of the analysis |
//! | `diagnosis` | what the model gets wrong: part of the analysis, and by itself |
//! | `plan` | `plan.json`, `plan.html`: what a test will be |
//! | `comparison` | what changed from one analysis to another |
//! | `history` | a machine over time |
//! | `volume` | the map of the volumetric error |
//! | `compensation` | tables for a control, and what they leave |
//! | `design` | a test that was designed |
//! | `paper` | the paper's tables, computed again |
//! | `program` | the path of a program and its speed |
//!
//! In each, `facts` holds what is written, as plain numbers; `gather` makes it of results; `verdict`, `cautions` and
//! `words` are its sentences; `terminal`, `html` and `figures` show it. `text` and `draw` serve all of them.
//!
//! Everything here is a function of its input alone: no clock, no network, no random order. The same
//! files give the same bytes.

mod analysis;
mod circular;
mod comparison;
mod compensation;
mod design;
mod diagnosis;
mod draw;
#[cfg(test)]
mod fixture;
mod history;
mod paper;
mod plan;
mod program;
mod ranked;
mod text;
mod trial;
mod volume;

pub use analysis::facts::{
    Analysis, BallBarFacts, Before, Correlation, MachineFacts, MountingFacts, NoiseResult,
    ParameterResult, Pivots, RepeatResult, TestFacts,
};
pub use analysis::html;
pub use analysis::machine_errors::{Hysteresis, MachineErrors, Reversal, Scale, Squareness};
pub use analysis::means::MeanResult;
pub use analysis::place::PlaceResult;
pub use analysis::run_facts::{
    ArcResult, FeedOverride, MarkResult, PauseResult, RejectedSample, RunResult, SampleCounts,
};
pub use analysis::samples::{write_aligned, write_samples};
pub use analysis::shown::Shown;
pub use analysis::terminal::{place_text, runs_table, summary};
pub use circular::facts::{
    CircularFacts, CircularResult, CircularValue, ConformityItem, ConformityResult, Verdict,
    WayResult,
};
pub use comparison::facts::comparison_json;
pub use comparison::html::comparison_page;
pub use comparison::terminal::comparison_text;
pub use compensation::facts::compensation_json;
pub use compensation::terminal::compensation_text;
pub use compensation::{Compensated, changed_between_repeats};
pub use design::facts::{proposal_json, unseen_of};
pub use design::terminal::proposal_text;
pub use diagnosis::facts::{DiagnosisFacts, FindingFacts};
pub use diagnosis::owner::OwnerFacts;
pub use diagnosis::settings::WrongSettingFacts;
pub use diagnosis::terminal::diagnosis_text;
pub use diagnosis::verdict::VerdictFacts;
pub use history::facts::history_json;
pub use history::html::history_page;
pub use history::terminal::history_text;
pub use paper::facts::paper_json;
pub use paper::page::paper_page;
pub use paper::terminal::{nearest_text, paper_text};
pub use plan::facts::{
    ClearanceFacts, ComparedSquareness, Comparison, ForeseenErrors, ForeseenHysteresis,
    ForeseenReversal, ForeseenScale, ForeseenSquareness, MountingOutlook, OperatorFacts,
    ParameterOutlook, PlanReport, SightFacts, Spread, TestOutlook, TimeFacts, TravelFacts,
    UnseenTerm, VolumeFacts,
};
pub use plan::html::plan_page;
pub use plan::planned::Planned;
pub use plan::terminal::plan_summary;
pub use program::html::path_page;
pub use ranked::facts::{FeatureResult, RankingFacts, RankingResult};
pub use text::words::list;
pub use trial::facts::trial_json;
pub use volume::Mapped;
pub use volume::facts::{volume_csv, volume_json};
pub use volume::html::volume_page;
pub use volume::terminal::volume_text;
