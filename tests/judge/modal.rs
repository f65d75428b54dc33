//! What G words say and what of it stays in force.

use std::collections::BTreeSet;

use ballbar::machine::Dialect;

use crate::power::{PowerOn, Unstated};
use crate::words::{Block, Refused, Word, refuse};

/// How a block moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    Rapid,
    Line,
    /// About the normal of the plane: +1 for G03, -1 for G02.
    Arc(i8),
}

/// A G word that holds in its block only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Once {
    Dwell,
    MachineCoordinates,
    /// Look-ahead: the letter of its argument, and the argument that switches it on.
    LookAhead(char, u32),
}

/// What is in force.
#[derive(Debug, Clone)]
pub(crate) struct Modal {
    pub(crate) motion: Motion,
    /// Normal of the plane: 0, 1, 2.
    pub(crate) normal: usize,
    pub(crate) inch: bool,
    pub(crate) incremental: bool,
    pub(crate) offset: u8,
    pub(crate) feed_mm_s: Option<f64>,
    pub(crate) stated: BTreeSet<Unstated>,
    /// In force in this block alone.
    pub(crate) once: Option<Once>,
}

impl Modal {
    pub(crate) fn new(power: &PowerOn, offset: u8) -> Self {
        Self {
            motion: if power.has(Unstated::Motion) { Motion::Line } else { Motion::Rapid },
            normal: if power.has(Unstated::Plane) { 1 } else { 2 },
            inch: power.has(Unstated::Unit),
            incremental: power.has(Unstated::Distance),
            offset: if power.has(Unstated::Offset) { 54 + (offset - 53) % 6 } else { offset },
            feed_mm_s: None,
            stated: BTreeSet::new(),
            once: None,
        }
    }

    /// Obeys the G words of a block, then its F.
    pub(crate) fn obey(&mut self, block: &Block, dialect: Dialect) -> Result<(), Refused> {
        self.once = None;
        let mut groups = BTreeSet::new();
        for word in block.words.iter().filter(|word| word.letter == 'G') {
            let group = self.code(word, block.line, dialect)?;
            if !groups.insert(group) {
                let what = format!("a second G word of the group of G{}", word.value);
                return refuse(block.line, what);
            }
        }
        if let Some(feed) = block.words.iter().find(|word| word.letter == 'F') {
            if feed.value < 0.0 {
                return refuse(block.line, "a negative feed");
            }
            let unit_mm = if self.inch { 25.4 } else { 1.0 };
            self.feed_mm_s = Some(feed.value * unit_mm / 60.0).filter(|feed_mm_s| *feed_mm_s > 0.0);
        }
        Ok(())
    }

    fn code(&mut self, word: &Word, line: usize, dialect: Dialect) -> Result<u8, Refused> {
        let fanuc = dialect == Dialect::Fanuc;
        let tenths = (word.value * 10.0).round();
        let exact = (word.value * 10.0 - tenths).abs() < 1e-6 && word.value >= 0.0;
        if !exact || word.point != (tenths % 10.0 > 0.5) {
            return refuse(line, format!("G{} is not known", word.value));
        }
        let mut state = |group| {
            self.stated.insert(group);
        };
        Ok(match tenths as u32 {
            code @ (0 | 10 | 20 | 30) => {
                state(Unstated::Motion);
                self.motion = match code {
                    0 => Motion::Rapid,
                    10 => Motion::Line,
                    20 => Motion::Arc(-1),
                    _ => Motion::Arc(1),
                };
                1
            }
            code @ (170 | 180 | 190) => {
                state(Unstated::Plane);
                self.normal = (190 - code as usize) / 10;
                2
            }
            code @ (200 | 210) => {
                state(Unstated::Unit);
                if self.inch != (code == 200) {
                    // A feed that was stated in the other unit holds no longer.
                    self.feed_mm_s = None;
                }
                self.inch = code == 200;
                3
            }
            code @ (900 | 910) => {
                state(Unstated::Distance);
                self.incremental = code == 910;
                4
            }
            code @ (540 | 550 | 560 | 570 | 580 | 590) => {
                state(Unstated::Offset);
                self.offset = (code / 10) as u8;
                5
            }
            610 | 640 => 6,
            611 if !fanuc => 6,
            940 => {
                state(Unstated::Feed);
                7
            }
            400 => {
                state(Unstated::Cutter);
                8
            }
            490 => {
                state(Unstated::Length);
                9
            }
            800 => {
                state(Unstated::Cycle);
                10
            }
            690 if fanuc => {
                state(Unstated::Rotation);
                11
            }
            150 if fanuc => {
                state(Unstated::Polar);
                12
            }
            500 if fanuc => {
                state(Unstated::Scaling);
                13
            }
            90 if fanuc => 14,
            40 => self.only(Once::Dwell),
            530 => self.only(Once::MachineCoordinates),
            50 if fanuc => self.only(Once::LookAhead('P', 10_000)),
            51 if fanuc => self.only(Once::LookAhead('Q', 1)),
            80 if fanuc => self.only(Once::LookAhead('P', 1)),
            _ => return refuse(line, format!("G{} is not known here", word.value)),
        })
    }

    fn only(&mut self, once: Once) -> u8 {
        self.once = Some(once);
        0
    }

    /// What a motion depends on that the program has not stated.
    pub(crate) fn unstated(&self, dialect: Dialect) -> BTreeSet<Unstated> {
        let mut needs = BTreeSet::from([
            Unstated::Unit,
            Unstated::Distance,
            // G53 does without, and `check` asks for it before the first motion all the same: a first block states it.
            Unstated::Offset,
            Unstated::Feed,
            Unstated::Motion,
            Unstated::Cutter,
            Unstated::Length,
            Unstated::Cycle,
        ]);
        if self.once != Some(Once::MachineCoordinates) && dialect == Dialect::Fanuc {
            needs.extend([Unstated::Rotation, Unstated::Polar, Unstated::Scaling]);
        }
        if matches!(self.motion, Motion::Arc(_)) {
            needs.insert(Unstated::Plane);
        }
        needs.difference(&self.stated).copied().collect()
    }
}
