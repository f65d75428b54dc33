//! `ballbar correct`: a program made right beforehand.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use nalgebra::Vector3;
use serde_json::json;

use super::check::text_of;
use super::common::Common;
use super::errors::numbers;
use super::output::{self, Talk};
use super::results::Files;
use crate::compensate::{Analysed, Corrected, Correcting, Field, Shrunk, Worth, correct};
use crate::error::{Error, Place, Result};
use crate::machine::Machine;
use crate::monitor::resolved;
use crate::nc::{self, Reading, Rewriting, Severity};
use crate::plan::Test;
use crate::report::changed_between_repeats;

/// Correct a program beforehand, for a control that cannot compensate
///
/// Every point of the program is moved by the error that the analysis foretells there, so that the tool goes where the program
/// meant; lines and arcs are divided where that bends them, each slide counts with the sense in which it moves, and everything else stays word for
/// word. The result is read back and checked before it is written, as NAME-corrected.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar correct O1001.nc --analysis out/2026-03-02-XYZ --test test.toml
  ballbar correct part.nc --analysis out/2026-03-02-XYZ --offset 54=310.2,-84.5,-220 --tool 0,0,-180")]
pub(super) struct Arguments {
    /// The program, gzipped or not
    #[arg(value_name = "PROGRAM")]
    program: PathBuf,
    /// analysis.json, or the folder it is in
    #[arg(long, value_name = "ANALYSIS")]
    analysis: PathBuf,
    /// The machine file, where it is not where the analysis names it
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// The test file that a ball-bar program is of: its work offset and tool
    #[arg(short, long, value_name = "TEST")]
    test: Option<PathBuf>,
    /// The mounting of the test file; without it, the first
    #[arg(long, value_name = "NAME", requires = "test")]
    mounting: Option<String>,
    /// Machine coordinates of the zero of a work offset, mm; again for several
    #[arg(long, value_name = "54=X,Y,Z", value_parser = offset)]
    offset: Vec<(u8, [f64; 3])>,
    /// Tip of the tool in the frame of the last slide on the tool side, mm [default: the ball of the mounting]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    tool: Option<[f64; 3]>,
    /// How far the path may be off between two points, um
    #[arg(long, value_name = "UM", default_value_t = 0.5, value_parser = within::<TOLERANCES>)]
    tolerance: f64,
    /// Largest correction, um; a larger one is refused with its block
    #[arg(long, value_name = "UM", default_value_t = 200.0, value_parser = within::<LIMITS>)]
    limit: f64,
}

/// Tolerances and limits, in hundredths of a micrometre.
const TOLERANCES: u8 = 0;
const LIMITS: u8 = 1;

fn within<const OF: u8>(text: &str) -> std::result::Result<f64, String> {
    let [low, high] = if OF == TOLERANCES { [0.01, 100.0] } else { [1.0, 500.0] };
    let number = text.parse::<f64>().ok().filter(|um| (low..=high).contains(um));
    number.ok_or_else(|| format!("`{text}` is no number from {low} to {high}"))
}

/// `54=310.2,-84.5,-220`.
fn offset(text: &str) -> std::result::Result<(u8, [f64; 3]), String> {
    let (number, zero) = text.split_once('=').ok_or("write 54=X,Y,Z")?;
    let number = number.trim().trim_start_matches(['G', 'g']).parse::<u8>().ok();
    let number = number.filter(|number| (54..=59).contains(number));
    Ok((number.ok_or("the work offsets are 54 to 59")?, numbers::<3>(zero)?))
}

/// What is corrected, and with what.
struct Ready {
    analysed: Analysed,
    reading: Reading,
    tool_ball_mm: Vector3<f64>,
    read: Vec<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let text = text_of(&self.program)?;
        let Ready { analysed, reading, tool_ball_mm, read } = self.ready()?;
        talk.reads(&read);
        let machine = analysed.errors.machine.clone();
        let Worth { errors, shrunk, before_mm, after_mm, .. } = analysed.worth(tool_ball_mm)?;
        let field = Field::new(&errors, tool_ball_mm)?;
        let decimals = machine.controller().decimals;
        let program = Rewriting::of(&text, &self.program, &reading, decimals)?;
        let correcting =
            Correcting { tolerance_mm: 1e-3 * self.tolerance, limit_mm: 1e-3 * self.limit };
        let corrected = correct(&program, &field, &correcting)?;
        let name = corrected_name(&self.program);
        checked(&text, &corrected.text, Path::new(&name), &machine, &reading)?;
        let mut files = Files::of(common, read);
        files.add(name, corrected.text.clone());
        let changed = errors.changed;
        let of = &analysed.compensation;
        let told = Told { corrected: &corrected, shrunk, before_mm, after_mm, changed, of };
        let json = output::json_text("correct", told.json());
        files.deliver(common.json, talk, &json, &told.text())
    }

    fn ready(&self) -> Result<Ready> {
        let file = resolved(&self.analysis)?;
        let analysed = Analysed::read(&file, self.machine.as_deref())?;
        let mut read =
            vec![self.program.clone(), file, analysed.errors.machine.file().to_path_buf()];
        let mut reading = Reading::of(&analysed.errors.machine);
        let mut tool_ball_mm = analysed.errors.mountings[0].1.tool_ball_mm;
        if let Some(file) = &self.test {
            let test = Test::read(file)?;
            analysed.is_of(&test.machine()?)?;
            let mountings = test.mountings();
            let named = |name: &String| mountings.iter().find(|mounting| mounting.name == *name);
            let mounting = self.mounting.as_ref().map_or(mountings.first(), named);
            let mounting = mounting.ok_or_else(|| {
                let names: Vec<&str> = mountings.iter().map(|m| m.name.as_str()).collect();
                Error::input("there is no such mounting")
                    .at(Place::file(file))
                    .hint(format!("the mountings are `{}`", names.join("`, `")))
            })?;
            tool_ball_mm = mounting.mounting.tool_ball_mm;
            reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
            read.push(file.clone());
        }
        for (number, zero_mm) in &self.offset {
            reading.work_offsets_mm.insert(*number, Vector3::from(*zero_mm));
        }
        if let Some(tool) = self.tool {
            tool_ball_mm = Vector3::from(tool);
        }
        Ok(Ready { analysed, reading, tool_ball_mm, read })
    }
}

/// `part-corrected.nc` of `part.nc.gz`.
fn corrected_name(program: &Path) -> String {
    let name = program.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.') {
        Some((stem, ending)) => format!("{stem}-corrected.{ending}"),
        None => format!("{name}-corrected"),
    }
}

/// What is wrong with the corrected program and was not with the one that it is of.
fn checked(
    before: &str,
    after: &str,
    name: &Path,
    machine: &Machine,
    reading: &Reading,
) -> Result<()> {
    let errors = |text: &str| -> Result<Vec<nc::Finding>> {
        let checked = nc::check(text, name, machine, reading, None)?;
        Ok(checked.findings.into_iter().filter(|f| f.severity == Severity::Error).collect())
    };
    let known = errors(before)?.len();
    let mut found = errors(after)?;
    if found.len() <= known {
        return Ok(());
    }
    let last = found.remove(found.len() - 1);
    Err(Error::input(format!("the corrected program would not do: {}", last.error.what)).hint(
        "correct with another tolerance; what `check` says of the program as it is may tell more",
    ))
}

/// What is told of it.
struct Told<'a> {
    corrected: &'a Corrected,
    shrunk: Shrunk,
    before_mm: f64,
    after_mm: f64,
    changed: Option<f64>,
    of: &'a Option<String>,
}

impl Told<'_> {
    fn json(&self) -> serde_json::Value {
        let of = self.corrected;
        json!({
            "moves": of.moves,
            "moves_left": of.left,
            "lines": of.points,
            "largest_um": 1e3 * of.largest_mm,
            "largest_line": of.largest_line,
            "rms_um": 1e3 * of.rms_mm,
            "points_not_measured_near": of.far.0,
            "farthest_mm": of.far.1,
            "directions_shrunk": self.shrunk.directions,
            "directions": self.shrunk.of,
            "volumetric_before_shrinking_um": 1e3 * self.before_mm,
            "volumetric_um": 1e3 * self.after_mm,
            "repeats_over_noise": self.changed,
            "compensation": self.of,
        })
    }

    fn text(&self) -> String {
        let of = self.corrected;
        let mut text = format!(
            "{} moves became {} lines; {} in machine coordinates stay as they are.\n\
             The largest correction is {:.1} um, of line {}; rms {:.1} um.\n\
             {} of {} directions of the errors are smaller than their uncertainty and were shrunk: of {:.2} um rms over the measured volume {:.2} um are corrected.\n",
            of.moves,
            of.points,
            of.left,
            1e3 * of.largest_mm,
            of.largest_line,
            1e3 * of.rms_mm,
            self.shrunk.directions,
            self.shrunk.of,
            1e3 * self.before_mm,
            1e3 * self.after_mm,
        );
        if of.far.0 > 0 {
            let _ = writeln!(
                text,
                "{} points lie up to {:.0} mm from what was measured: they have the correction of its end, and nobody has looked there.",
                of.far.0, of.far.1
            );
        }
        if let Some(times) = self.changed {
            let _ = writeln!(text, "{}", changed_between_repeats(times));
        }
        if let Some(compensation) = self.of {
            let _ = writeln!(
                text,
                "Active when it was measured, and needed with this program: {compensation}."
            );
        }
        text
    }
}
