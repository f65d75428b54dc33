//! A run as it was measured: what its files hold, read once.

use std::sync::Arc;

use super::input::RunInput;
use crate::align::{self, Alignment, OffCentre};
use crate::error::{Error, Kind, Place, Result};
use crate::log::{self, Log, Recording};
use crate::machine::{Axis, Machine};
use crate::motion::Trajectory;
use crate::nc;
use crate::plan::{Run, Test};

/// What is said of balls that stand off.
const OFF_CENTRE: &str =
    "from where the program means it, so the bar read where it should be out of its range";

/// A log and the program that ran, before they are laid over each other.
///
/// Where the balls are, how long the bar is and which machine it was stand in the test and in the machine
/// file, and both may be taken otherwise later: see [`aligned`](Self::aligned).
#[derive(Debug, Clone)]
pub struct MeasuredRun {
    /// What it is called.
    pub name: String,
    /// Index of its mounting.
    pub mounting: usize,
    /// Where the override knob stood, as a share of 1.
    pub feed_override: f64,
    /// What the instrument read.
    pub log: Log,
    /// What the machine was told; runs of one program share it.
    pub source: Arc<nc::Source>,
    /// What the control recorded of its motion.
    pub motion: Option<Arc<Recording>>,
}

/// The runs of one repeat, as they were measured.
#[derive(Debug)]
pub(super) struct MeasuredRepeat {
    /// Names of the runs.
    pub(super) names: String,
    /// The runs, or why the files of one cannot be read.
    pub(super) runs: Vec<Result<MeasuredRun>>,
}

impl MeasuredRepeat {
    pub(super) fn all(repeats: Vec<Vec<MeasuredRun>>) -> Vec<Self> {
        let of = |runs: Vec<MeasuredRun>| Self {
            names: runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>().join(", "),
            runs: runs.into_iter().map(Ok).collect(),
        };
        repeats.into_iter().map(of).collect()
    }

    pub(super) fn aligned(&self, test: &Test, machine: &Machine) -> Result<Vec<RunInput>> {
        let aligned =
            |run: &Result<MeasuredRun>| run.as_ref().map_err(Clone::clone)?.aligned(test, machine);
        self.runs.iter().map(aligned).collect()
    }
}

impl MeasuredRun {
    /// Reads the files of a run of a test.
    ///
    /// # Errors
    /// When a file cannot be read or the log is none.
    pub fn read(test: &Test, run: &Run) -> Result<Self> {
        Ok(Self {
            name: run.name.clone(),
            mounting: run.mounting,
            feed_override: run.feed_override,
            log: log::read(&run.log, &test.log_format_of(run.mounting))?,
            source: Arc::new(nc::Source::read(&run.program)?),
            motion: match &run.motion {
                Some(file) => Some(Arc::new(Recording::read(file)?)),
                None => None,
            },
        })
    }

    /// The log laid over the program as this test and this machine have it; nothing is read anew.
    ///
    /// # Errors
    /// When the program cannot be followed, or the log does not belong to it.
    pub fn aligned(&self, test: &Test, machine: &Machine) -> Result<RunInput> {
        let mut reading = nc::Reading::of(machine);
        for mounting in test.mountings() {
            reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
        }
        // Two mountings may use the same offset, one after the other: the run's own counts.
        let mounting = &test.mountings()[self.mounting];
        reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
        let bar = test.bar_of(self.mounting);
        let program = self.source.program(&reading)?;
        let driven = match &self.motion {
            Some(motion) => Some(Trajectory::recorded(&program, machine, motion)?),
            None => None,
        };
        let run = align::Run {
            log: &self.log,
            program: &program,
            rig: align::Rig { machine, mounting: &mounting.mounting, bar: &bar },
            feed_override: self.feed_override,
            driven: driven.as_ref(),
        };
        if let Some(log) = self.log.by_angle() {
            if let Some(motion) = &self.motion {
                return Err(Error::input(
                    "a log by angle has no times that a recorded motion could belong to",
                )
                .at(Place::file(motion.file()))
                .hint("leave `motion` out of the run, or take a log with times"));
            }
            let alignment = align::by_angle(&run, log)?;
            return Ok(RunInput::new(self.name.clone(), self.mounting, bar.length_mm, alignment));
        }
        if let Some(misread) = align::misread(&run, &test.log_format_of(self.mounting)) {
            return Err(Error::new(Kind::Mismatch, misread.what)
                .at(Place::file(self.log.file()))
                .hint(format!(
                    "write `{}` under `[log]` in {}",
                    misread.lines,
                    test.file().display()
                )));
        }
        let alignment = align::align(&run);
        let laid = alignment.as_ref().ok();
        let alignment = if let Some(off_centre) = align::off_centre(&run, laid) {
            self.laid_off_centre(off_centre)?
        } else if let Some((mut laid, within_mm)) = align::read_while_it_waited(&run, laid) {
            laid.log_notes.push(format!(
                "the bar read where the program has it wait out of its range: so far off was the machine there, or the ball. Readings beyond {within_mm:.2} mm were taken as out of range"
            ));
            laid
        } else {
            alignment?
        };
        Ok(RunInput::new(self.name.clone(), self.mounting, bar.length_mm, alignment))
    }

    /// A log of balls that stand so far off that the bar read where it should be out of its range, with a caution.
    fn laid_off_centre(&self, off_centre: OffCentre) -> Result<Alignment> {
        match off_centre {
            OffCentre::Laid { offset_mm, within_mm, mut alignment } => {
                // What rounds to nothing, its arcs do not show.
                let shown = Axis::ALL.map(|axis| (axis, offset_mm[axis.index()]));
                let shown = shown.into_iter().filter(|(_, mm)| mm.abs() >= 0.005);
                let parts: Vec<String> = shown.map(|(axis, mm)| format!("{axis} {mm:+.2}")).collect();
                alignment.log_notes.push(format!(
                    "the tool ball was {:.2} mm ({} mm) {OFF_CENTRE}; readings beyond {within_mm:.2} mm were taken as out of range. Bring the balls together and set the work offset there before the next run",
                    offset_mm.norm(),
                    parts.join(", ")
                ));
                Ok(*alignment)
            }
            OffCentre::TooFar(size_mm) => Err(Error::new(
                Kind::Mismatch,
                format!("the tool ball was {size_mm:.2} mm {OFF_CENTRE}"),
            )
            .at(Place::file(self.log.file()))
            .hint(
                "bring the balls together again and set the work offset there, or check `coincidence_mm`; then repeat the run",
            )),
        }
    }
}
