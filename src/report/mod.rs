//! Results for people and for other programs: terminal summary, `analysis.json`, samples as CSV, and one
//! self-contained HTML file.
//!
//! Everything here is a function of its input alone: no clock, no network, no random order. The same
//! files give the same bytes.
//!
//! [`Analysis`] is the one place where numbers are gathered; terminal, JSON and the tables of the HTML
//! report read it and nothing else. Curves are drawn from the identifications themselves.

mod analysis;
mod arc_table;
mod cautions;
mod diagnosis;
mod figures;
#[cfg(test)]
mod fixture;
mod gather;
pub mod html;
mod machine_errors;
mod mountings;
mod numbers;
mod outlook;
mod paper;
mod path_plot;
mod proposal;
mod samples;
mod svg;
mod svg_chart;
mod svg_polar;
mod terminal;
mod text;
mod ticks;
mod traces;
mod units;

pub use analysis::{
    Analysis, ArcResult, BallBarFacts, Correlation, FeedOverride, MachineFacts, MarkResult,
    MeanResult, MountingFacts, NoiseResult, ParameterResult, PauseResult, Pivots, RejectedSample,
    RepeatResult, RunResult, SampleCounts, TestFacts,
};
pub use diagnosis::{
    ArcFacts, BinFacts, DiagnosisFacts, FeatureFacts, FindingFacts, LeftOutFacts, MovedFacts,
    NumberFacts, OffTimeFacts, PictureFacts, PointFacts, ProgramGainFacts, RivalFacts,
    RunGainFacts, StructureFacts, ViewFacts, WrongSettingFacts, diagnosis_text,
};
pub use machine_errors::{Hysteresis, MachineErrors, Reversal, Scale, Squareness};
pub use outlook::{
    ClearanceFacts, ComparedSquareness, Comparison, ForeseenErrors, ForeseenHysteresis,
    ForeseenReversal, ForeseenScale, ForeseenSquareness, MountingOutlook, OperatorFacts,
    ParameterOutlook, PlanReport, Planned, SightFacts, Spread, TestOutlook, TimeFacts, TravelFacts,
    UnseenTerm, VolumeFacts, plan_page, plan_summary,
};
pub use paper::{nearest_text, paper_json, paper_page, paper_text};
pub use path_plot::path_page;
pub use proposal::{proposal_json, proposal_text, some_of, unseen_of};
pub use samples::{write_aligned, write_samples};
pub use terminal::{runs_table, summary};
