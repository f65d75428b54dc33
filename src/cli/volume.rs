//! `ballbar volume`: the map of the volumetric error.

use std::path::Path;

use clap::Args;
use nalgebra::Vector3;

use super::common::Common;
use super::errors::{Errors, numbers};
use super::output::{self, Talk};
use super::results::{Page, path_from};
use crate::compensate::{Field, MOST_POINTS, Measured, Volume, VolumeMap};
use crate::error::{Error, Result};
use crate::machine::{Axis, Machine};
use crate::report::{self, Mapped};

/// Map the volumetric error: how far the tool is from where it should be, anywhere
///
/// The displacement of the tool against the workpiece over the volume that was measured, the travel or a box, with both
/// uncertainties, and what a laser would read along axes (ISO 230-2) and diagonals (ISO 230-6). Where nothing was measured near,
/// that is said. Writes volume.html, volume.csv and volume.json. A test is analysed first, as `analyse` does.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar volume out/2026-03-02-XYZ
  ballbar volume out/2026-03-02-XYZ --travel --tool 0,0,-250
  ballbar volume test.toml --box 300,500,150,350,-350,-150 -o map --json | jq .near")]
pub(super) struct Arguments {
    #[command(flatten)]
    errors: Errors,
    /// Over the whole travel of the machine, instead of what was measured
    #[arg(long, conflicts_with = "in_box")]
    travel: bool,
    /// Over a box of machine coordinates, mm: lowest and highest X, then Y, then Z
    #[arg(long = "box", value_name = "X,X,Y,Y,Z,Z", allow_hyphen_values = true, value_parser = numbers::<6>)]
    in_box: Option<[f64; 6]>,
    /// Tip of the tool in the frame of the last slide on the tool side, mm [default: the ball of the first mounting]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    tool: Option<[f64; 3]>,
    /// Leave the rigid motion of the workpiece in, and count from the middle of the test
    #[arg(long)]
    keep_rigid: bool,
    /// Points along each axis
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u8).range(2..=MOST_POINTS as i64))]
    points: u8,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let (read, analysed) = self.errors.read(talk)?;
        let errors = &analysed.errors;
        let tool_ball_mm = self.tool.map_or(errors.mountings[0].1.tool_ball_mm, Vector3::from);
        let volume = Volume {
            ends_mm: self.ends_mm(&errors.machine, Measured::by(errors).range_mm())?,
            points: usize::from(self.points),
            keep_rigid: self.keep_rigid,
        };
        let field = Field::new(errors, tool_ball_mm)?;
        let page = Page::or_out(common, "volume.html");
        let name = |file: &Path| {
            path_from(page.directory(), file).unwrap_or_else(|_| file.display().to_string())
        };
        let mapped = Mapped {
            test: analysed.test.clone(),
            file: name(&analysed.file),
            compensation: analysed.compensation.clone(),
            errors,
            tool_ball_mm,
            map: VolumeMap::of(&field, &volume),
        };
        let json = output::json_text("volume", report::volume_json(&mapped));
        let ready = vec![
            (page.name().to_owned(), report::volume_page(&mapped)?),
            (page.beside("csv"), report::volume_csv(&mapped)),
            (page.beside("json"), json.clone()),
        ];
        let written = page.write(common, &read, ready)?;
        if common.json {
            output::print(&json)?;
        } else {
            output::print_summary(&report::volume_text(&mapped))?;
        }
        written.told(talk);
        Ok(())
    }

    /// The ends of the volume, mm.
    fn ends_mm(&self, machine: &Machine, measured: [Vector3<f64>; 2]) -> Result<[Vector3<f64>; 2]> {
        let travel = Axis::ALL.map(|axis| machine.slide(axis).travel_mm);
        let of_travel = |k: usize| Vector3::from(travel.map(|ends| ends[k]));
        let [low, high] = match self.in_box {
            Some([a, b, c, d, e, f]) => [Vector3::new(a, c, e), Vector3::new(b, d, f)],
            None if self.travel => [of_travel(0), of_travel(1)],
            None => measured,
        };
        for axis in Axis::ALL {
            let k = axis.index();
            let [least, most] = travel[k];
            if low[k] > high[k] || (self.in_box.is_some() && (low[k] < least || high[k] > most)) {
                return Err(Error::input(format!(
                    "the box goes from {} to {} mm in {axis}, and the travel from {least} to {most} mm",
                    low[k], high[k]
                ))
                .hint("give machine coordinates within the travel, the lower one first: `--box X,X,Y,Y,Z,Z`"));
            }
        }
        Ok([low, high])
    }
}
