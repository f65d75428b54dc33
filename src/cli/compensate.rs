//! `ballbar compensate`: files for a control that compensates.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use nalgebra::Vector3;

use super::common::Common;
use super::errors::{Errors, numbers};
use super::output::{self, Talk};
use super::results::{Files, path_from};
use crate::compensate::{Compensating, Compensation, Control, Limits, Named, Worth};
use crate::error::{Error, Place, Result};
use crate::input;
use crate::machine::{Axis, Machine};
use crate::report::{self, Compensated};

/// Write what the control takes to compensate the machine, and say what it leaves
///
/// Tables, parameters or G-code, as the control has them, with a page that says how they are loaded, how to see at one point that
/// the sign is right, what was active when the machine was measured, what did not fit, and what is left of each error. The
/// files are read back as the control will before they are written: what is left is by what was read.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar compensate out/2026-03-02-XYZ --for linuxcnc
  ballbar compensate out/2026-03-02-XYZ --for siemens --tables 20 --points 400 -o tables
  ballbar compensate test.toml --for csv --step 10 --json | jq .after")]
pub(super) struct Arguments {
    #[command(flatten)]
    errors: Errors,
    /// The control
    #[arg(long = "for", value_name = "CONTROL", value_parser = PossibleValuesParser::new(Control::ALL.map(Control::name)).map(|name| Control::named(&name).unwrap_or(Control::Csv)))]
    control: Control,
    /// Tip of the tool in the frame of the last slide on the tool side, mm [default: the ball of the first mounting]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    tool: Option<[f64; 3]>,
    /// Machine coordinates of the other slides while one moves, mm [default: the middle of the test]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    at: Option<[f64; 3]>,
    /// Distance of the points of a table, mm [default: a twentieth of what was measured, or what the points allow]
    #[arg(long, value_name = "MM", value_parser = step)]
    step: Option<f64>,
    /// Points that a table of the control has at the most [default: as it comes]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=5000))]
    points: Option<u16>,
    /// Tables for other axes that the control has at the most (siemens) [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=62))]
    tables: Option<u8>,
    /// Detection unit of the axes, um (fanuc) [default: 1]
    #[arg(long, value_name = "UM", value_parser = unit)]
    unit: Option<f64>,
    /// A file that was active when the machine was measured; again for each
    #[arg(long, value_name = "FILE")]
    on_top: Vec<PathBuf>,
}

fn within(text: &str, [low, high]: [f64; 2]) -> std::result::Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (low..=high).contains(number));
    number.ok_or_else(|| format!("`{text}` is no number from {low} to {high}"))
}

fn step(text: &str) -> std::result::Result<f64, String> {
    within(text, [0.1, 1000.0])
}

fn unit(text: &str) -> std::result::Result<f64, String> {
    within(text, [0.001, 10.0])
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let (mut read, analysed) = self.errors.read(talk)?;
        let first = &analysed.errors.mountings[0].1;
        let tool_ball_mm = self.tool.map_or(first.tool_ball_mm, Vector3::from);
        let Worth { errors, shrunk, before_mm, after_mm, unknown } =
            analysed.worth(tool_ball_mm)?;
        let asked = Compensating {
            control: self.control,
            limits: self.limits(),
            tool_ball_mm,
            place_mm: self.place_mm(&errors.machine, errors.frame.middle_mm)?,
            existing: self.existing()?,
        };
        let of = Compensation::of(&errors, &asked)?;
        read.extend(self.on_top.iter().cloned());
        let directory = common.directory();
        let file = path_from(directory, &analysed.file)
            .unwrap_or_else(|_| analysed.file.display().to_string());
        let told = Compensated {
            test: analysed.test.clone(),
            machine: errors.machine.name().to_owned(),
            file,
            active: analysed.compensation.clone(),
            found: &analysed.found,
            shrunk,
            shrunk_mm: [before_mm, after_mm],
            unknown,
            changed: errors.changed,
            of: &of,
        };
        let text = report::compensation_text(&told);
        let json = output::json_text("compensation", report::compensation_json(&told));
        let mut files = Files::of(common, read);
        for (name, content) in &of.written.files {
            files.add(name.as_str(), content.as_str());
        }
        files.add(format!("compensation-{}.txt", self.control.name()), text.as_str());
        files.deliver(common.json, talk, &json, &text)
    }

    fn limits(&self) -> Limits {
        let usual = self.control.limits();
        Limits {
            most_points: self.points.map_or(usual.most_points, usize::from),
            most_tables: self.tables.map_or(usual.most_tables, usize::from),
            unit_mm: self.unit.map_or(usual.unit_mm, |um| 1e-3 * um),
            step_mm: self.step,
        }
    }

    /// Where the other slides are.
    fn place_mm(&self, machine: &Machine, middle_mm: Vector3<f64>) -> Result<Vector3<f64>> {
        let place_mm = self.at.map_or(middle_mm, Vector3::from);
        for axis in Axis::ALL {
            let [low, high] = machine.slide(axis).travel_mm;
            let at = place_mm[axis.index()];
            if !(low..=high).contains(&at) {
                return Err(Error::input(format!(
                    "{axis} {at} mm is beyond the travel of {low} to {high} mm"
                ))
                .hint("`--at` takes machine coordinates within the travel"));
            }
        }
        Ok(place_mm)
    }

    /// Names, without folders, and texts of the files that were active.
    fn existing(&self) -> Result<Vec<Named>> {
        let each = self.on_top.iter().map(|file| {
            let bytes = input::read_small(file, "compensation")?;
            let text = String::from_utf8(bytes).map_err(|_| {
                Error::input("this file of a control is no text").at(Place::file(file))
            })?;
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Ok((name, text))
        });
        each.collect()
    }
}
