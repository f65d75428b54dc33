//! `ballbar blind`: the standing trial.

use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::sync::Mutex;

use clap::Args;
use serde_json::json;

use super::archive::Archive;
use super::common::Common;
use super::output::{self, Talk};
use super::results::Files;
use crate::diagnose::{Finding, Separation};
use crate::error::{Error, Result};
use crate::model::Form;
use crate::report::trial_json;
use crate::trial::{
    Class, Course, Grid, IN_GRID, Outcome, REQUIRED, Request, Session, grid_table, table,
};

/// Hide effects at random, diagnose without knowing, and count what comes out
///
/// Each trial simulates a campaign - built in: three runs of 3D6 at 500 mm/min and two at 1500 mm/min, each
/// on a day of its own - with nothing, one effect, two, or one that the library of causes does not have
/// hidden in it, and diagnoses it. Every run's noise is that of the sample measurements, 0.15 um a reading.
#[allow(clippy::struct_excessive_bools)] // switches of a command line
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar blind                                20 trials of each class
  ballbar blind --full --seed 3                300 single, small and none, 200 two, 100 outside
  ballbar blind --class single --size 0.5 --trials 50 --list
  ballbar blind --trial two:17                 one of them again, with all that was found
  ballbar blind test.toml --repeats 5          on the programs of a test
  ballbar blind --grid --full --list           campaigns of all kinds, rates for each kind
  ballbar blind --grid --trial none:17         one of them again
  ballbar blind --archive --trials 2 -o DIR    the campaigns themselves, for other programs

Classes: single (1 um rms), small (as the noise), sizes (0.3, 0.5, 2 times the noise), none, two (1 um
each), outside (a bump, a joint or a friction tilt of 1 um)")]
pub(super) struct Arguments {
    /// A test file whose programs are driven, instead of the built-in campaign
    #[arg(value_name = "TEST")]
    test: Option<PathBuf>,
    /// How often the plan of TEST is repeated, instead of its runs
    #[arg(long, requires = "test", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: Option<u32>,
    /// Draw every campaign: test, machine, motion, readings a second, runs, noise, feed
    #[arg(long, conflicts_with_all = ["test", "repeats"])]
    grid: bool,
    /// Where everything random begins
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Trials of each class
    #[arg(long, default_value_t = 20, value_name = "N")]
    trials: usize,
    /// As many trials as it takes to state the rates
    #[arg(long, conflicts_with = "trials")]
    full: bool,
    /// Only this class: single, small, sizes, none, two, outside; give it again for several
    #[arg(long, value_name = "CLASS", value_parser = class)]
    class: Vec<Class>,
    /// Size of every hidden effect, um rms outside of the model, instead of that of its class
    #[arg(long, value_name = "UM", value_parser = size_um)]
    size: Option<f64>,
    /// A line for each trial, as it ends; with --json on stderr
    #[arg(long)]
    list: bool,
    /// Do one trial again and print all that was found
    #[arg(long, value_name = "CLASS:INDEX", value_parser = request, conflicts_with_all = ["class", "full", "trials", "list"])]
    trial: Option<Request>,
    /// With `--grid --trial`: write its machine, test, programs and logs, and what is true, for the other commands
    #[arg(long, requires_all = ["trial", "grid"])]
    write: bool,
    /// Write the campaigns as a data set instead of diagnosing them: a zip for each, what is true, a description
    #[arg(long, conflicts_with_all = ["test", "trial", "list"])]
    archive: bool,
}

fn class(name: &str) -> std::result::Result<Class, String> {
    Class::parse(name).ok_or_else(|| {
        let names: Vec<&str> = Class::ALL.iter().map(|class| class.name()).collect();
        format!("classes are {}", names.join(", "))
    })
}

fn size_um(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(um) if (1e-3..=100.0).contains(&um) => Ok(um),
        _ => Err("a size from 0.001 to 100 um".to_owned()),
    }
}

fn request(text: &str) -> std::result::Result<Request, String> {
    let (name, index) = text.split_once(':').ok_or("write CLASS:INDEX, such as two:17")?;
    let index = index.parse().map_err(|_| format!("`{index}` is no index"))?;
    Ok(Request { class: class(name)?, index })
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let size_mm = self.size.map(|um| um * 1e-3);
        if self.archive {
            let requests = self.requests(if self.grid { &IN_GRID } else { &REQUIRED });
            let (grid, seed, command) = (self.grid, self.seed, self.archive_command());
            let archive = Archive { grid, seed, size_mm, requests: &requests, command };
            return archive.run(common, talk);
        }
        if self.grid {
            return self.run_grid(&Grid { seed: self.seed, size_mm }, common, talk);
        }
        let course = match &self.test {
            Some(file) => Course::of(file, self.repeats)?,
            None => Course::built_in()?,
        };
        let session = Session::new(course, self.seed, size_mm)?;
        if let Some(request) = self.trial {
            return told(&session.replay(request)?, common);
        }
        let requests = self.requests(&REQUIRED);
        let run = |finished: Told<'_>| session.run(&requests, finished);
        let outcomes = self.outcomes(&requests, &run, common, talk)?;
        if common.json {
            let list: Vec<_> = outcomes.iter().map(trial_json).collect();
            let all =
                json!({ "seed": self.seed, "noise_um": 1e3 * session.noise_mm(), "trials": list });
            return output::print_json("blind", all);
        }
        output::print_summary(&table(&outcomes, session.noise_mm()))
    }

    fn run_grid(&self, grid: &Grid, common: &Common, talk: &Talk) -> Result<()> {
        if let (Some(request), true) = (self.trial, self.write) {
            let mut files = Files::of(common, Vec::new());
            for (name, text) in grid.files(request)?.files {
                files.add(name, text);
            }
            for file in files.write()?.files {
                output::print(&format!("{}\n", file.display()))?;
            }
            return Ok(());
        }
        if let Some(request) = self.trial {
            return told(&grid.trial(request, true), common);
        }
        let requests = self.requests(&IN_GRID);
        let run = |finished: Told<'_>| grid.run(&requests, finished);
        let outcomes = self.outcomes(&requests, &run, common, talk)?;
        if common.json {
            let list: Vec<_> = outcomes.iter().map(trial_json).collect();
            return output::print_json("blind", json!({ "seed": self.seed, "trials": list }));
        }
        output::print_summary(&grid_table(&outcomes))
    }

    /// Runs trials with a bar of progress and, where they are listed, a line for each.
    fn outcomes(
        &self,
        requests: &[Request],
        run: &dyn Fn(Told<'_>) -> Result<Vec<Outcome>>,
        common: &Common,
        talk: &Talk,
    ) -> Result<Vec<Outcome>> {
        let progress = talk.progress(requests.len(), "trials");
        let listed = self.list && !common.json;
        if !std::io::stderr().is_terminal() {
            // Hundreds of trials take an hour, and a bar is drawn on terminals alone.
            talk.say(&format!("{} trials, some seconds each", requests.len()));
        }
        let lines = Mutex::new(InOrder { requests, ready: Vec::new(), told: 0 });
        let outcomes = run(&|outcome| {
            if let (true, Ok(mut lines)) = (self.list, lines.lock()) {
                let due = lines.with(outcome);
                if listed {
                    // What cannot be written will be told with the table.
                    progress.suspend(|| output::print(&due)).ok();
                } else if !due.is_empty() {
                    // The standard output is for the JSON of all.
                    progress.suspend(|| talk.say(due.trim_end()));
                }
            }
            progress.inc(1);
        });
        talk.ended(&progress);
        if listed {
            output::print("\n")?;
        }
        outcomes
    }

    /// The command line of a data set, with all that makes it what it is.
    fn archive_command(&self) -> String {
        let mut command = "ballbar blind --archive".to_owned();
        if self.grid {
            command.push_str(" --grid");
        }
        let _ = write!(command, " --seed {}", self.seed);
        if self.full {
            command.push_str(" --full");
        } else {
            let _ = write!(command, " --trials {}", self.trials);
        }
        for class in &self.class {
            let _ = write!(command, " --class {class}");
        }
        if let Some(um) = self.size {
            let _ = write!(command, " --size {um}");
        }
        command
    }

    fn requests(&self, required: &[(Class, usize)]) -> Vec<Request> {
        let wanted = |class: Class| self.class.is_empty() || self.class.contains(&class);
        let each = required.iter().copied().filter(|(class, _)| wanted(*class));
        each.flat_map(|(class, full)| {
            let count = if self.full { full } else { self.trials };
            (0..count as u64).map(move |index| Request { class, index })
        })
        .collect()
    }
}

/// One trial with all that its diagnosis says.
fn told(outcome: &Outcome, common: &Common) -> Result<()> {
    if common.json {
        return output::print_json("trial", trial_json(outcome));
    }
    if let Some(failure) = &outcome.failure {
        return Err(Error::input(failure.clone()));
    }
    let mut text = line(outcome);
    for finding in outcome.findings.iter().flatten() {
        text.push_str(&described(finding));
    }
    output::print(&text)
}

/// A finding with its numbers and its rivals.
fn described(finding: &Finding) -> String {
    let mut text = format!("found, {:.3} um rms:\n", 1e3 * finding.rms_mm);
    let _ = match &finding.element.form {
        Form::Cause(shape) => writeln!(text, "  {}", shape.name()),
        Form::Empirical(curve) => {
            let by_sense = if curve.with_sense { ", by direction" } else { "" };
            let (seat, knots) = (curve.seat, curve.knots.len());
            writeln!(text, "  curve of {seat} over the {}{by_sense}, {knots} knots", curve.variable)
        }
    };
    for number in &finding.numbers {
        let sigma = number.sigma.map_or(String::new(), |sigma| format!(" +- {sigma:.4}"));
        let _ = writeln!(text, "    {} = {:.4}{sigma}", number.name, number.value);
    }
    for rival in &finding.rivals {
        let apart = match rival.separation {
            Separation::Same => "the same in these runs",
            Separation::Undecided => "not decided within the noise",
            Separation::Apart => "explains less",
        };
        let _ = writeln!(text, "    or {}: {:.2} %, {apart}", rival.name(), 100.0 * rival.share);
    }
    text
}

/// What is called after each trial.
type Told<'a> = &'a (dyn Fn(&Outcome) + Sync);

/// Lines of trials, told in the order in which they were asked for.
struct InOrder<'a> {
    requests: &'a [Request],
    ready: Vec<(Request, String)>,
    told: usize,
}

impl InOrder<'_> {
    /// The lines that are due with this outcome.
    fn with(&mut self, outcome: &Outcome) -> String {
        let request = Request { class: outcome.class, index: outcome.index };
        self.ready.push((request, line(outcome)));
        let mut due = String::new();
        while let Some(next) = self.requests.get(self.told) {
            let Some(place) = self.ready.iter().position(|(of, _)| of == next) else { break };
            due.push_str(&self.ready.swap_remove(place).1);
            self.told += 1;
        }
        due
    }
}

/// A trial in a line.
fn line(outcome: &Outcome) -> String {
    let hidden: Vec<String> = outcome
        .hidden
        .iter()
        .map(|(e, share)| format!("{e} [{:.0} % seen]", 100.0 * share))
        .collect();
    let found: Vec<String> = outcome
        .judgement
        .found
        .iter()
        .map(|found| match found.correlation {
            Some(r) => format!("{} [r {r:.4}]", found.text),
            None => found.text.clone(),
        })
        .collect();
    let or = |list: Vec<String>, none: &str| {
        if list.is_empty() { none.to_owned() } else { list.join(" + ") }
    };
    let seconds = &outcome.seconds;
    let mut text = format!(
        "{}:{} {} | {:.3} um | {} | {} | {:.1} {:.1} {:.1} s",
        outcome.class,
        outcome.index,
        outcome.judgement.verdict.name(),
        1e3 * outcome.size_mm,
        or(hidden, "nothing"),
        or(found, outcome.failure.as_deref().unwrap_or("nothing")),
        seconds.simulate_s,
        seconds.identify_s,
        seconds.diagnose_s
    );
    for (run, why) in &outcome.left_out {
        let _ = write!(text, " | without {run}: {why}");
    }
    if !outcome.strata.is_empty() {
        let values: Vec<&str> = outcome.strata.iter().map(|(_, value)| value.as_str()).collect();
        let _ = write!(text, " | {}", values.join(", "));
    }
    for off in outcome.off_by.iter().filter(|off| off.alls.abs() > 2.0) {
        let _ =
            write!(text, " | {} {:+.1} of all, {:+.1} of noise", off.name, off.alls, off.noises);
    }
    text.push('\n');
    text
}
