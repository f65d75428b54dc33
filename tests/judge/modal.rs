//! What G words say and what of it stays in force.

use std::collections::BTreeSet;

use ballbar::machine::Dialect;

use crate::power::{PowerOn, Unstated};
use crate::words::{Block, Refused, Spoken, Word, refuse};

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

/// Feeds are between these, mm/min.
const SLOWEST_MM_MIN: f64 = 0.001;
const FASTEST_MM_MIN: f64 = 1e6;

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
        for spoken in &block.spoken {
            let group = self.spoken(*spoken);
            if !groups.insert(group) {
                return refuse(block.line, format!("a second word of the group of {spoken:?}"));
            }
        }
        for word in block.words.iter().filter(|word| word.letter == 'G') {
            let group = match dialect {
                Dialect::Siemens => self.siemens(word, block.line)?,
                Dialect::Heidenhain => return refuse(block.line, "a G word in Klartext"),
                Dialect::Fanuc | Dialect::LinuxCnc => self.code(word, block.line, dialect)?,
            };
            if !groups.insert(group) {
                let what = format!("a second G word of the group of G{}", word.value);
                return refuse(block.line, what);
            }
        }
        // F of a dwell of a Siemens is its time.
        let time = dialect == Dialect::Siemens && self.once == Some(Once::Dwell);
        if let Some(feed) = block.words.iter().find(|word| word.letter == 'F' && !time) {
            let unit_mm = if self.inch { 25.4 } else { 1.0 };
            let mm_min = feed.value * unit_mm;
            if mm_min != 0.0 && !(SLOWEST_MM_MIN..=FASTEST_MM_MIN).contains(&mm_min) {
                return refuse(block.line, "a feed that no control has");
            }
            self.feed_mm_s = Some(mm_min / 60.0).filter(|feed_mm_s| *feed_mm_s > 0.0);
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
        self.iso(tenths as u32, fanuc)
            .map_or_else(|| refuse(line, format!("G{} is not known here", word.value)), Ok)
    }

    /// G words of a Siemens control: some are others, some mean something else.
    fn siemens(&mut self, word: &Word, line: usize) -> Result<u8, Refused> {
        let whole = !word.point && word.value >= 0.0;
        let group = match word.value as u32 {
            _ if !whole => None,
            9 => Some(14),
            60 | 64 => Some(6),
            153 => Some(self.only(Once::MachineCoordinates)),
            700 => self.iso(200, false),
            71 | 710 => self.iso(210, false),
            code @ (0..=4 | 17..=19 | 40 | 54..=57 | 90 | 91 | 94) => self.iso(10 * code, false),
            _ => None,
        };
        group.map_or_else(|| refuse(line, format!("G{} is not known here", word.value)), Ok)
    }

    /// Puts in force what is said in a word; its group.
    fn spoken(&mut self, spoken: Spoken) -> u8 {
        let mut ends = |group, number| {
            self.stated.insert(group);
            number
        };
        match spoken {
            Spoken::Motion(motion) => {
                self.motion = motion;
                ends(Unstated::Motion, 1)
            }
            Spoken::Plane(normal) => {
                self.normal = normal;
                ends(Unstated::Plane, 2)
            }
            Spoken::Unit(inch) => {
                self.inch = inch;
                ends(Unstated::Unit, 3)
            }
            Spoken::NoRadius => ends(Unstated::Cutter, 8),
            Spoken::NoLength => ends(Unstated::Length, 9),
            Spoken::NoCycle => ends(Unstated::Cycle, 10),
            Spoken::NoRotation => ends(Unstated::Rotation, 11),
            Spoken::NoScaling => ends(Unstated::Scaling, 13),
            Spoken::NoShift => ends(Unstated::Shift, 15),
            Spoken::NoTransformation => ends(Unstated::Transformation, 16),
            Spoken::NoMirror => ends(Unstated::Mirror, 17),
            Spoken::Dynamics(group) => 18 + group,
            Spoken::MachineCoordinates => self.only(Once::MachineCoordinates),
            Spoken::Dwell => self.only(Once::Dwell),
        }
    }

    /// What all have, and what a Fanuc has, by tenths of the number; its group.
    fn iso(&mut self, tenths: u32, fanuc: bool) -> Option<u8> {
        let mut state = |group| {
            self.stated.insert(group);
        };
        Some(match tenths {
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
            _ => return None,
        })
    }

    fn only(&mut self, once: Once) -> u8 {
        self.once = Some(once);
        0
    }

    /// What a motion depends on that the program has not stated.
    pub(crate) fn unstated(&self, dialect: Dialect) -> BTreeSet<Unstated> {
        use Unstated::{
            Cutter, Cycle, Distance, Feed, Length, Mirror, Motion as Kind, Offset, Polar, Rotation,
            Scaling, Shift, Transformation, Unit,
        };
        let mut needs = BTreeSet::from([Kind, Cutter]);
        if dialect != Dialect::Heidenhain {
            // G53 does without a work offset, and `check` asks for it before the first motion all the same: a first block
            // states it.
            needs.extend([Unit, Distance, Offset, Feed, Length, Cycle]);
        }
        if self.once != Some(Once::MachineCoordinates) {
            match dialect {
                Dialect::Fanuc => needs.extend([Rotation, Polar, Scaling]),
                Dialect::LinuxCnc => {}
                Dialect::Siemens => needs.extend([Shift, Transformation]),
                Dialect::Heidenhain => needs.extend([Shift, Mirror, Rotation, Scaling]),
            }
        }
        if matches!(self.motion, Motion::Arc(_)) {
            needs.insert(Unstated::Plane);
        }
        needs.difference(&self.stated).copied().collect()
    }
}
