//! A reading from the log to the picture: where it was taken, what the fit computes there, what became of it.

use crate::align::{Part, Sample, Section};

/// One reading of a run that was identified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// The reading with its time and its place: what was observed.
    pub sample: Sample,
    /// Deviation that the model computes, mm.
    pub computed_mm: f64,
    /// Observed minus computed, mm.
    pub residual_mm: f64,
    /// What the readings before it on the same stretch of an arc do not foretell of its residual, in standard
    /// deviations; `None` where it takes no part.
    pub whitened: Option<f64>,
    /// Weight in the fit, 0 to 1.
    pub weight: f64,
    /// Why it takes no part in the fit; `None` where it does.
    pub apart: Option<Apart>,
}

/// Why a reading takes no part in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Apart {
    /// The bar is on its way to the sphere or from it.
    Ramp,
    /// The machine stands.
    Standstill,
    /// The operator has it.
    Pause,
    /// Nothing tells its time.
    TimeUnknown,
    /// An axis turns round so near to it that its sense is not known.
    Reversal,
    /// Its arc begins or ends so near to it that it may be of the standstill or the motion there.
    End,
}

impl Apart {
    /// In a word, as files have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Ramp => "ramp",
            Self::Standstill => "standstill",
            Self::Pause => "pause",
            Self::TimeUnknown => "time unknown",
            Self::Reversal => "reversal",
            Self::End => "end of arc",
        }
    }

    /// What is kept from a moment at which something turns, steps or ends, s: three standard deviations of the time of a sample, by how
    /// much that moment itself may be elsewhere, or `guard_s`, whichever is most.
    pub(super) fn kept_s(sample: &Sample, guard_s: f64, elsewhere_s: f64) -> f64 {
        guard_s.max(3.0 * sample.time_sigma_s).max(elsewhere_s)
    }

    /// Why a sample takes no part: only one on an arc does, where the sense of every axis is known, that is, where no axis
    /// [turns round](crate::align::Following::turns_s) within three standard deviations of its time, or within `guard_s`, and
    /// where the arc neither begins nor ends so near, nor [comes to its speed](Section::comes_to_speed_s). A mean of readings
    /// keeps `half_s` more, as far as they go from its middle.
    pub(super) fn of(
        sample: &Sample,
        turns_s: &[[f64; 2]],
        sections: &[Section],
        guard_s: f64,
        half_s: f64,
    ) -> Option<Self> {
        let section = match sample.part {
            Part::Ramp => return Some(Self::Ramp),
            Part::Dwell => return Some(Self::Standstill),
            Part::Stop => return Some(Self::Pause),
            Part::Arc(index) => &sections[index],
        };
        if !sample.time_sigma_s.is_finite() {
            return Some(Self::TimeUnknown);
        }
        let next = turns_s.partition_point(|turn| turn[1] < sample.program_s);
        let kept_s = |elsewhere_s: f64| half_s + Self::kept_s(sample, guard_s, elsewhere_s);
        let near = |time_s: f64, kept_s: f64| (time_s - sample.program_s).abs() < kept_s;
        // Within the while of a turn its sense is not known at all.
        let turns = |index: usize| {
            turns_s.get(index).is_some_and(|[from_s, to_s]| {
                near(sample.program_s.clamp(*from_s, *to_s), kept_s(0.0))
            })
        };
        let [after_s, before_s] = section.comes_to_speed_s().map(kept_s);
        if near(section.start_s, after_s) || near(section.end_s, before_s) {
            Some(Self::End)
        } else if turns(next) || next.checked_sub(1).is_some_and(turns) {
            Some(Self::Reversal)
        } else {
            None
        }
    }
}

/// With less weight than this a sample counts as rejected: Huber's weight at some 10 sigma.
const REJECTED: f64 = 0.13;

impl Record {
    /// Whether the fit used it.
    pub fn used(&self) -> bool {
        self.apart.is_none()
    }

    /// Whether the fit used it and hardly believed it: its residual was too large.
    pub fn rejected(&self) -> bool {
        self.used() && self.weight < REJECTED
    }

    /// Whether it was certainly read on an arc, though maybe where an axis turns round: times that end some milliseconds from where
    /// readings were chosen lay one of the feed-in or of a standstill on the end of an arc.
    pub fn is_on_arc(&self) -> bool {
        self.section().is_some() && matches!(self.apart, None | Some(Apart::Reversal))
    }

    /// Index of the section of the program that it lies on; `None` off the arcs.
    pub fn section(&self) -> Option<usize> {
        match self.sample.part {
            Part::Arc(section) => Some(section),
            Part::Ramp | Part::Dwell | Part::Stop => None,
        }
    }
}
