//! The command line: one file a subcommand, and the only room that prints.
//!
//! Data goes to stdout, talk to stderr. Exit codes: 0 done; 1 a file or a value cannot be used; 2 the
//! command line is wrong; 3 a log does not belong to its program; 4 the data cannot determine what was
//! asked for; 5 a result cannot be written; 130 interrupted.

mod align;
mod analyse;
mod archive;
mod ask;
mod blind;
mod browser;
mod check;
mod common;
mod compare;
mod compensate;
mod correct;
mod demo;
mod design;
mod diagnose;
mod errors;
mod estimate;
mod history;
mod identify;
mod init;
mod init_from;
mod machines;
mod manual;
mod output;
mod paper;
mod plan;
mod program;
mod reference;
mod results;
mod show;
mod shown_table;
mod simulate;
mod stage;
mod time;
mod volume;

use std::io::Write as _;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use common::Common;
use output::Talk;

use crate::error::Result;

/// Programs for a telescoping ball-bar, alignment of its logs, identification of the machine.
#[derive(Parser)]
#[command(version, about, long_about = LONG_ABOUT, after_help = AFTER_HELP)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

const LONG_ABOUT: &str = "Programs for a telescoping ball-bar, alignment of its logs, identification of the machine.\n\n\
`init` writes the two files that you begin with: a machine file says what the machine is, a test file says what is tested, with what, and what was measured. \
`plan` says what it takes and what it will determine, `program` writes the NC programs, the machine runs them, `analyse` makes coefficients and a report of the logs, `diagnose` says what the model gets wrong.";

const AFTER_HELP: &str = "Examples:
  ballbar init vmc                             a machine file and a test file to begin with
  ballbar demo                                 the whole chain on measured logs, in a few seconds
  ballbar plan test.toml                       what a test takes and what it will determine
  ballbar program test.toml -o out             write the NC programs of a test
  ballbar check out/O1001.nc --test test.toml  what is wrong with a program that was edited
  ballbar analyse test.toml -o out             align the logs, identify, write the report
  ballbar diagnose test.toml                   what the model gets wrong, and why
  ballbar compare out/2026-03-02-XY out/2026-04-07-XY
                                               what changed since
  ballbar history out                          a machine over time
  ballbar volume out/2026-03-02-XYZ            how far the tool is off, anywhere
  ballbar compensate out/2026-03-02-XYZ --for linuxcnc
                                               what the control takes, and what it leaves
  ballbar identify test.toml --json | jq .     coefficients for another program
  ballbar reference coincidence_mm             what a key of a file means

Exit codes:
  0  done
  1  a file or a value cannot be used
  2  the command line is wrong
  3  a log does not belong to its program
  4  the data cannot determine what was asked for
  5  a result cannot be written
  130  interrupted; nothing was written, or all";

#[derive(Subcommand)]
enum Command {
    Init(init::Arguments),
    Plan(plan::Arguments),
    Program(program::Arguments),
    Check(check::Arguments),
    Time(time::Arguments),
    Simulate(simulate::Arguments),
    Align(align::Arguments),
    Identify(identify::Arguments),
    #[command(visible_alias = "analyze")]
    Analyse(analyse::Arguments),
    Diagnose(diagnose::Arguments),
    Compare(compare::Arguments),
    History(history::Arguments),
    Volume(volume::Arguments),
    Compensate(compensate::Arguments),
    Correct(correct::Arguments),
    Design(design::Arguments),
    Blind(blind::Arguments),
    Demo(demo::Arguments),
    Machines(machines::Arguments),
    Reference(reference::Arguments),
    Show(show::Arguments),
    Paper(paper::Arguments),
    Completions(manual::Completions),
    Man(manual::Man),
}

impl Command {
    /// Whether it writes to the directory of results, whatever its arguments say.
    fn writes(&self) -> bool {
        match self {
            Self::Plan(_)
            | Self::Program(_)
            | Self::Simulate(_)
            | Self::Align(_)
            | Self::Identify(_)
            | Self::Analyse(_)
            | Self::Diagnose(_)
            | Self::Design(_)
            | Self::Compensate(_)
            | Self::Correct(_)
            | Self::Demo(_) => true,
            Self::Check(_)
            | Self::Time(_)
            | Self::Blind(_)
            // Where they write, a file may be named.
            | Self::Compare(_)
            | Self::History(_)
            | Self::Volume(_)
            // What is begun goes to a folder that it checks itself.
            | Self::Init(_)
            | Self::Machines(_)
            | Self::Show(_)
            | Self::Reference(_)
            | Self::Paper(_)
            | Self::Completions(_)
            | Self::Man(_) => false,
        }
    }
}

/// Runs the program: parses the command line, does it, prints errors, gives the exit code.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refused(&error),
    };
    let talk = Talk::new(&cli.common);
    results::heed_interrupts();
    match cli.run(&talk) {
        Ok(()) => {
            talk.took();
            ExitCode::SUCCESS
        }
        Err(error) => {
            talk.error(&error);
            ExitCode::from(error.kind.exit_code())
        }
    }
}

/// Help, the version, or a command line that cannot be understood: of the last JSON for who asks for it.
fn refused(error: &clap::Error) -> ExitCode {
    let wants_json = std::env::args_os().any(|argument| argument == "--json");
    if error.use_stderr() && wants_json {
        let _ = writeln!(std::io::stderr(), "{}", output::usage_json(&error.to_string()));
    } else {
        let _ = error.print();
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

impl Cli {
    fn run(&self, talk: &Talk) -> Result<()> {
        let common = &self.common;
        if self.command.writes() {
            results::check_directory(common)?;
        }
        match &self.command {
            Command::Init(arguments) => arguments.run(common, talk),
            Command::Plan(arguments) => arguments.run(common, talk),
            Command::Program(arguments) => arguments.run(common, talk),
            Command::Check(arguments) => arguments.run(common, talk),
            Command::Time(arguments) => arguments.run(common, talk),
            Command::Simulate(arguments) => arguments.run(common, talk),
            Command::Align(arguments) => arguments.run(common, talk),
            Command::Identify(arguments) => arguments.run(common, talk),
            Command::Analyse(arguments) => arguments.run(common, talk),
            Command::Diagnose(arguments) => arguments.run(common, talk),
            Command::Compare(arguments) => arguments.run(common, talk),
            Command::History(arguments) => arguments.run(common, talk),
            Command::Volume(arguments) => arguments.run(common, talk),
            Command::Compensate(arguments) => arguments.run(common, talk),
            Command::Correct(arguments) => arguments.run(common, talk),
            Command::Design(arguments) => arguments.run(common, talk),
            Command::Blind(arguments) => arguments.run(common, talk),
            Command::Demo(arguments) => arguments.run(common, talk),
            Command::Machines(arguments) => arguments.run(common, talk),
            Command::Show(arguments) => arguments.run(common),
            Command::Reference(arguments) => arguments.run(common),
            Command::Paper(arguments) => arguments.run(common, talk),
            Command::Completions(arguments) => arguments.run(&mut Cli::command()),
            Command::Man(arguments) => arguments.run(&Cli::command(), common, talk),
        }
    }
}
