//! A control: follows a program block by block, from wherever the machine stands.

use std::collections::BTreeSet;

use ballbar::machine::Dialect;

use crate::arcs;
use crate::modal::{Modal, Motion, Once};
use crate::path::{Point, Turn, minus};
use crate::power::{PowerOn, Unstated};
use crate::setting::Setting;
use crate::words::{Block, Part, Refused, Word, parts, refuse};

/// Where an axis stands: at a machine coordinate, or so far from where it stood at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Coordinate {
    pub(crate) of_start: bool,
    pub(crate) mm: f64,
}

/// A move of the tool ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Move {
    pub(crate) line: usize,
    pub(crate) rapid: bool,
    pub(crate) from: [Coordinate; 3],
    pub(crate) to: [Coordinate; 3],
    pub(crate) turn: Option<Turn>,
    pub(crate) feed_mm_s: f64,
}

/// What a block makes happen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Event {
    Move(Move),
    /// The machine waits for the operator, who reads this.
    Stop(String),
    /// The spindle turns from this line on.
    Spindle(usize),
}

/// What a program does, and what that depends on beside the program.
#[derive(Debug)]
pub(crate) struct Driven {
    pub(crate) events: Vec<Event>,
    pub(crate) depends: BTreeSet<Unstated>,
    /// Where it ends.
    pub(crate) end: [Coordinate; 3],
}

/// Eight digits of a length, mm.
const FARTHEST_MM: f64 = 99_999.999;
/// More events than this are no program of a test.
const MOST_EVENTS: usize = 400_000;
/// Where another work offset than that of the test is, as seen from it, mm: nobody knows.
const ELSEWHERE_MM: Point = [35.0, -22.0, -60.0];
/// What somebody left in force shifts, turns and shrinks by so much.
const LEFT_LENGTH_MM: f64 = -120.0;
const LEFT_CUTTER_MM: f64 = 8.0;
const LEFT_ROTATION_RAD: f64 = 0.5;
const LEFT_SCALE: f64 = 0.6;
const LEFT_SHIFT_MM: f64 = 60.0;

/// Drives a program.
pub(crate) fn drive(text: &str, setting: &Setting, power: &PowerOn) -> Result<Driven, Refused> {
    let parts = parts(text, setting.dialect)?;
    let mut control = Control {
        setting,
        power,
        parts: &parts,
        modal: Modal::new(power, setting.offset),
        at: [Coordinate { of_start: true, mm: 0.0 }; 3],
        programmed: [0.0; 3],
        driven: Driven {
            events: Vec::new(),
            depends: BTreeSet::new(),
            end: [Coordinate { of_start: true, mm: 0.0 }; 3],
        },
    };
    let ended = control.part(0, 0)?;
    let last = parts[0].blocks.last().map_or(0, |block| block.line);
    if !ended {
        return refuse(last, "the program has no end");
    }
    control.driven.end = control.at;
    Ok(control.driven)
}

struct Control<'a> {
    setting: &'a Setting,
    power: &'a PowerOn,
    parts: &'a [Part],
    modal: Modal,
    at: [Coordinate; 3],
    /// The last coordinates in the work offset, mm.
    programmed: Point,
    driven: Driven,
}

impl Control<'_> {
    /// Runs a program of the file; true when the whole run is over with it.
    fn part(&mut self, index: usize, depth: usize) -> Result<bool, Refused> {
        let parts = self.parts;
        for block in &parts[index].blocks {
            if self.driven.events.len() > MOST_EVENTS {
                return refuse(block.line, "it does not end");
            }
            let function = self.block(block)?;
            match function {
                None | Some(1 | 5 | 8 | 9) => {}
                Some(0) => self.driven.events.push(Event::Stop(block.comment.clone())),
                Some(2 | 30) => return Ok(true),
                Some(3 | 4) => self.driven.events.push(Event::Spindle(block.line)),
                Some(98) => {
                    let (called, times) = self.called(block)?;
                    if depth == 4 {
                        return refuse(block.line, "a call too deep");
                    }
                    for _ in 0..times {
                        if self.part(called, depth + 1)? {
                            return Ok(true);
                        }
                    }
                }
                Some(99) if depth > 0 => return Ok(false),
                Some(function) => return refuse(block.line, format!("M{function} is not known")),
            }
        }
        if depth > 0 {
            let line = parts[index].blocks.last().map_or(0, |block| block.line);
            return refuse(line, "a subprogram without M99");
        }
        Ok(false)
    }

    fn called(&self, block: &Block) -> Result<(usize, u32), Refused> {
        let number = whole(block, 'P');
        let found = self.parts.iter().position(|part| number.is_some() && part.number == number);
        let times = if word(block, 'L').is_some() { whole(block, 'L') } else { Some(1) };
        match (found, times) {
            (Some(found), Some(times @ 1..=9999)) => Ok((found, times)),
            _ => refuse(block.line, "a call that leads nowhere"),
        }
    }

    /// Obeys all of a block but its M word, which is returned.
    fn block(&mut self, block: &Block) -> Result<Option<u32>, Refused> {
        let line = block.line;
        for (index, word) in block.words.iter().enumerate() {
            let twice = block.words[..index].iter().any(|before| before.letter == word.letter);
            if word.letter != 'G' && twice {
                return refuse(line, format!("{} twice", word.letter));
            }
        }
        self.modal.obey(block, self.setting.dialect)?;
        let function = word(block, 'M').map(|_| whole(block, 'M'));
        if function == Some(None) {
            return refuse(line, "an M word that is no whole number");
        }
        let function = function.flatten();
        match self.modal.once {
            Some(Once::Dwell) => self.dwell(block, function)?,
            Some(Once::LookAhead(letter, on)) => {
                let argument = whole(block, letter);
                if block.words.len() != 2 || !(argument == Some(0) || argument == Some(on)) {
                    return refuse(line, "a look-ahead that is not known");
                }
            }
            _ => self.motion(block, function)?,
        }
        Ok(function)
    }

    fn dwell(&self, block: &Block, function: Option<u32>) -> Result<(), Refused> {
        let fanuc = self.setting.dialect == Dialect::Fanuc;
        let times = match self.setting.dialect {
            Dialect::Fanuc => "PXU",
            Dialect::Siemens => "F",
            Dialect::LinuxCnc | Dialect::Heidenhain => "P",
        };
        if self.setting.dialect == Dialect::Siemens && block.words.len() + block.spoken.len() != 2 {
            return refuse(block.line, "a dwell with something else");
        }
        let given: Vec<&Word> = block.words.iter().filter(|w| times.contains(w.letter)).collect();
        let motion = |w: &&Word| w.letter == 'G' && w.value < 3.5;
        let [time] = given[..] else { return refuse(block.line, "a dwell of no time") };
        if time.value < 0.0
            || (fanuc && time.letter == 'P' && time.point)
            || block.words.iter().any(|w| !"GMFST".contains(w.letter) && !times.contains(w.letter))
            || block.words.iter().any(|w| motion(&w))
            || matches!(function, Some(98 | 99))
        {
            return refuse(block.line, "a dwell with something else");
        }
        Ok(())
    }

    fn motion(&mut self, block: &Block, function: Option<u32>) -> Result<(), Refused> {
        let line = block.line;
        let linuxcnc = self.setting.dialect == Dialect::LinuxCnc;
        let tolerant = linuxcnc
            && block.words.iter().any(|w| w.letter == 'G' && (61.0..64.5).contains(&w.value));
        let allowed = |w: &Word| match w.letter {
            'P' => function == Some(98) || tolerant,
            'L' => function == Some(98),
            'Q' => tolerant,
            letter => "GMFSTXYZIJKR".contains(letter),
        };
        if let Some(word) = block.words.iter().find(|word| !allowed(word)) {
            return refuse(line, format!("{} belongs to nothing", word.letter));
        }
        for word in block.words.iter().filter(|word| "XYZIJKR".contains(word.letter)) {
            if self.length_mm(word).abs() > FARTHEST_MM {
                return refuse(line, format!("{} beyond what a control takes", word.letter));
            }
        }
        let moves = |letters: &str| block.words.iter().any(|w| letters.contains(w.letter));
        let in_machine = self.modal.once == Some(Once::MachineCoordinates);
        if !moves("XYZIJKR") {
            return if in_machine { refuse(line, "G53 without a coordinate") } else { Ok(()) };
        }
        let arc = matches!(self.modal.motion, Motion::Arc(_));
        if moves("IJKR") && !arc {
            return refuse(line, "a centre without an arc");
        }
        if in_machine && (self.modal.motion != Motion::Rapid || self.modal.incremental) {
            return refuse(line, "G53 that is obeyed by some controls only");
        }
        self.driven.depends.extend(self.modal.unstated(self.setting.dialect));
        let to = self.target(block, in_machine);
        let rapid = self.modal.motion == Motion::Rapid;
        let feed_mm_s = match (rapid, self.modal.feed_mm_s) {
            (true, _) => 0.0,
            (false, Some(feed_mm_s)) if self.power.has(Unstated::Feed) => 1000.0 * feed_mm_s,
            (false, Some(feed_mm_s)) => feed_mm_s,
            (false, None) => return refuse(line, "a feed move without F"),
        };
        let turn = match self.modal.motion {
            Motion::Arc(sense) => Some(self.turn(block, to, sense)?),
            _ => None,
        };
        if turn.is_some() || self.at != to {
            let from = self.at;
            self.driven.events.push(Event::Move(Move { line, rapid, from, to, turn, feed_mm_s }));
        }
        self.at = to;
        Ok(())
    }

    /// The length of a word, mm.
    fn length_mm(&mut self, word: &Word) -> f64 {
        let unit_mm = if self.modal.inch { 25.4 } else { 1.0 };
        if word.point || self.setting.dialect != Dialect::Fanuc || word.value.abs() < 1e-12 {
            return word.value * unit_mm;
        }
        self.driven.depends.insert(Unstated::Point);
        if self.power.has(Unstated::Point) {
            return word.value * unit_mm;
        }
        word.value * unit_mm / if self.modal.inch { 1e4 } else { 1e3 }
    }

    fn target(&mut self, block: &Block, in_machine: bool) -> [Coordinate; 3] {
        let mut to = self.at;
        let given: [Option<f64>; 3] =
            ['X', 'Y', 'Z'].map(|letter| word(block, letter).map(|word| self.length_mm(&word)));
        if in_machine {
            for (to, given) in to.iter_mut().zip(given) {
                *to = given.map_or(*to, |mm| Coordinate { of_start: false, mm });
            }
            return to;
        }
        if self.modal.incremental {
            for (axis, given) in given.into_iter().enumerate() {
                to[axis].mm += given.unwrap_or(0.0);
                self.programmed[axis] += given.unwrap_or(0.0);
            }
            return to;
        }
        for (programmed, given) in self.programmed.iter_mut().zip(given) {
            *programmed = given.unwrap_or(*programmed);
        }
        let zero_mm = self.zero_mm();
        let point = self.shifted();
        let turned = [Unstated::Rotation, Unstated::Polar].iter().any(|left| self.power.has(*left));
        for (axis, to) in to.iter_mut().enumerate() {
            let with_the_other = turned && axis < 2 && (given[0].or(given[1])).is_some();
            if given[axis].is_some() || with_the_other {
                *to = Coordinate { of_start: false, mm: zero_mm[axis] + point[axis] };
            }
        }
        to
    }

    fn zero_mm(&mut self) -> Point {
        let centre_mm = self.setting.centre_mm;
        if self.modal.offset == self.setting.offset {
            return centre_mm;
        }
        self.driven.depends.insert(Unstated::OtherOffset);
        std::array::from_fn(|axis| centre_mm[axis] + ELSEWHERE_MM[axis])
    }

    /// The programmed point as what was left in force bends it, until the program ends that.
    fn shifted(&self) -> Point {
        let left = |group| self.power.has(group) && !self.modal.stated.contains(&group);
        let [mut x, mut y, mut z] = self.programmed;
        if left(Unstated::Polar) {
            let angle_rad = y.to_radians();
            (x, y) = (x * angle_rad.cos(), x * angle_rad.sin());
        }
        if left(Unstated::Scaling) {
            (x, y, z) = (x * LEFT_SCALE, y * LEFT_SCALE, z * LEFT_SCALE);
        }
        if left(Unstated::Rotation) {
            let (sin, cos) = LEFT_ROTATION_RAD.sin_cos();
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
        }
        if left(Unstated::Transformation) {
            let (sin, cos) = LEFT_ROTATION_RAD.sin_cos();
            (y, z) = (y * cos - z * sin, y * sin + z * cos);
        }
        if left(Unstated::Mirror) {
            x = -x;
        }
        if left(Unstated::Shift) {
            (x, y) = (x + LEFT_SHIFT_MM, y - LEFT_SHIFT_MM);
        }
        if left(Unstated::Length) {
            z += LEFT_LENGTH_MM;
        }
        if left(Unstated::Cutter) {
            x += LEFT_CUTTER_MM;
        }
        [x, y, z]
    }

    fn turn(&mut self, block: &Block, to: [Coordinate; 3], sense: i8) -> Result<Turn, Refused> {
        let known = self.at.iter().chain(&to).all(|coordinate| !coordinate.of_start);
        if !known {
            return refuse(block.line, "an arc from nobody knows where");
        }
        let (from, to) = (self.at.map(|c| c.mm), to.map(|c| c.mm));
        let normal = self.modal.normal;
        if let Some(pole) = block.pole {
            let mut centre_mm = from;
            for axis in (0..3).filter(|axis| *axis != normal) {
                let Some(word) = pole[axis] else { return refuse(block.line, "an arc of no pole") };
                centre_mm[axis] = self.zero_mm()[axis] + self.length_mm(&word);
            }
            return arcs::about(from, to, normal, sense, centre_mm)
                .or_else(|what| refuse(block.line, what));
        }
        let offsets =
            ['I', 'J', 'K'].map(|letter| word(block, letter).map(|word| self.length_mm(&word)));
        let radius_mm = word(block, 'R').map(|word| self.length_mm(&word));
        let made = match (offsets, radius_mm) {
            ([None, None, None], Some(radius_mm)) => {
                arcs::of_radius(from, to, normal, sense, radius_mm)
            }
            (offsets, None) if offsets[normal].is_none() && offsets.iter().any(Option::is_some) => {
                let offset = offsets.map(|offset| offset.unwrap_or(0.0));
                arcs::about(from, to, normal, sense, minus(from, offset.map(|mm| -mm)))
            }
            _ => Err("an arc without one centre"),
        };
        made.or_else(|what| refuse(block.line, what))
    }
}

fn word(block: &Block, letter: char) -> Option<Word> {
    block.words.iter().find(|word| word.letter == letter).copied()
}

/// The number of a word without a point, if it is a whole one.
fn whole(block: &Block, letter: char) -> Option<u32> {
    let word = word(block, letter)?;
    (!word.point && word.value >= 0.0 && word.value.fract().abs() < 1e-12)
        .then_some(word.value as u32)
}
