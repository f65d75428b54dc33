//! The instrument's clock beside the machine's.

use crate::motion::{BlockKind, Trajectory};

/// Where the program is when the instrument's clock shows a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockMoment {
    /// Program time, s, operator's pauses counted as zero; negative before the program begins.
    pub program_s: f64,
    /// How many operator's pauses have ended: the leg of the time map.
    pub leg: usize,
    /// Whether the operator pauses.
    pub in_pause: bool,
}

/// `program = log · (1 + ppm · 1e-6) - start_s - pauses so far`, all on the machine's clock but `log`.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// How long before the program the log begins, s.
    pub start_s: f64,
    /// By how much the machine's clock runs faster than the instrument's, parts per million.
    pub ppm: f64,
    /// How long each operator's pause is, in the order of the program, s.
    pub pauses_s: Vec<f64>,
    /// Program time of each pause, s.
    stops_s: Vec<f64>,
    /// Program time and all pauses, s.
    end_s: f64,
}

impl Clock {
    /// The clock of a run; `pauses_s` has one entry for each operator's pause of the trajectory.
    pub(super) fn new(trajectory: &Trajectory, start_s: f64, ppm: f64, pauses_s: Vec<f64>) -> Self {
        let stops_s = stops_s(trajectory);
        let end_s = trajectory.end_s() + pauses_s.iter().sum::<f64>();
        Self { start_s, ppm, pauses_s, stops_s, end_s }
    }

    /// Program time of every operator's pause, s.
    pub fn stops_s(&self) -> &[f64] {
        &self.stops_s
    }

    /// The moment of a log time.
    pub fn at(&self, log_s: f64) -> ClockMoment {
        self.moment(self.machine_s(log_s))
    }

    /// Time since the program began at a log time, s of the machine's clock, operator's pauses included;
    /// negative before.
    pub(super) fn machine_s(&self, log_s: f64) -> f64 {
        log_s * (1.0 + self.ppm * 1e-6) - self.start_s
    }

    /// The moment of a time since the program began, s of the machine's clock, operator's pauses included.
    pub(super) fn moment(&self, machine_s: f64) -> ClockMoment {
        let mut program_s = machine_s;
        for (leg, (&stop_s, &pause_s)) in self.stops_s.iter().zip(&self.pauses_s).enumerate() {
            if program_s < stop_s {
                return ClockMoment { program_s, leg, in_pause: false };
            }
            if program_s < stop_s + pause_s {
                return ClockMoment { program_s: stop_s, leg, in_pause: true };
            }
            program_s -= pause_s;
        }
        ClockMoment { program_s, leg: self.stops_s.len(), in_pause: false }
    }

    /// Log time at which a leg (the number of pauses that have ended) reaches a program time, s.
    pub fn log_time_s(&self, program_s: f64, leg: usize) -> f64 {
        let paused_s: f64 = self.pauses_s.iter().take(leg).sum();
        (program_s + self.start_s + paused_s) / (1.0 + self.ppm * 1e-6)
    }

    /// Time since the program began at its end, s of the machine's clock, operator's pauses included.
    pub(super) fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Log time of the end of the program, s.
    pub(super) fn end_log_s(&self) -> f64 {
        (self.end_s + self.start_s) / (1.0 + self.ppm * 1e-6)
    }
}

/// Program time of every operator's pause, s.
pub(super) fn stops_s(trajectory: &Trajectory) -> Vec<f64> {
    let stops = trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Stop);
    stops.map(|block| block.start_s).collect()
}
