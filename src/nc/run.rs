//! Runs a program: block after block, through its subprograms, to its end.

use super::code::{Code, Miscellaneous};
use super::command::Command;
use super::grammar::{Dwell, Grammar};
use super::lines::Line;
use super::listing::{Block, Listing, Refuse};
use super::look_ahead::look_ahead;
use super::modal::Stated;
use super::position::{ARC, COORDINATES, Machine, Moved};
use super::program::{Action, Path, Step};
use super::reading::Reading;
use super::word::{Fault, Letters, Word};
use crate::error::Result;

/// More steps than this are kept of no program, a million and the ways to and from them: at a thousand a second a quarter of an
/// hour. With their times they take less than 1 GB; beyond 2^20 a list that doubles would take more.
const MOST_STEPS: usize = 1_040_000;
/// A program that runs more blocks than this repeats itself without bound: around a step stand a few that are none.
pub(crate) const MOST_BLOCKS: usize = 8 * MOST_STEPS;

/// So often a program may interrupt its motion, or go wrong and be followed further; one of a test has some hundred stops.
const MOST_MARKS: usize = 100_000;

/// Calls within calls that the control allows.
const DEEPEST_CALL: usize = 4;

/// Addresses that never move a linear axis by themselves.
const ANYWHERE: Letters = Letters::of(b"GMFST");

/// A program of the file that is running.
#[derive(Debug, Clone, Copy)]
struct Call {
    section: usize,
    /// The block that comes next.
    next: usize,
    /// How often it runs after this time.
    again: u32,
}

/// What comes after a block.
enum Next {
    Block,
    Call(Call),
    Return,
    End,
}

/// Something between two steps that no step tells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mark {
    /// The step that comes after it.
    pub(crate) step: usize,
    /// Where it stands.
    pub(crate) line: Line,
    /// The word that interrupts the look-ahead; none where a block could not be followed.
    pub(crate) word: Option<Word>,
}

/// A positioning from wherever the machine stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Opening {
    /// The step that comes after it.
    pub(crate) step: usize,
    /// Where it stands.
    pub(crate) line: Line,
    /// Where each axis stands after it, machine coordinates in mm, if that is known.
    pub(crate) to_mm: [Option<f64>; 3],
}

/// How the coordinates of a step are written.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "each is a group of words of its own")]
pub(crate) struct Written {
    pub(crate) incremental: bool,
    pub(crate) inch: bool,
    /// G61 is in force.
    pub(crate) exact_stop: bool,
    /// In machine coordinates, G53.
    pub(crate) machine_coordinates: bool,
    /// 54 to 59.
    pub(crate) work_offset: u8,
}

/// What running a program yields.
#[derive(Debug)]
pub(crate) struct Ran {
    /// What the machine does.
    pub(crate) steps: Vec<Step>,
    /// How each is written.
    pub(crate) written: Vec<Written>,
    /// What stands between, in order.
    pub(crate) marks: Vec<Mark>,
    /// How it gets from wherever the machine stands to its first move.
    pub(crate) openings: Vec<Opening>,
    /// The first block that moves the machine, and what had been stated before it.
    pub(crate) at_first_motion: Option<(Line, Stated)>,
    /// The same of the first arc.
    pub(crate) at_first_arc: Option<(Line, Stated)>,
    /// For every block of the listing whether it ran.
    pub(crate) reached: Vec<bool>,
}

/// Runs the main program of a listing. When `refuse` lets an error pass, the block is left out and the
/// run goes on.
pub(crate) fn run(
    listing: &Listing,
    reading: &Reading,
    most_blocks: usize,
    refuse: &mut Refuse<'_>,
) -> Result<Ran> {
    let mut runner = Runner {
        listing,
        reading,
        grammar: Grammar::of(reading.dialect),
        machine: Machine::new(reading),
        in_machine_coordinates: false,
        label: 0,
        ran: Ran {
            steps: Vec::with_capacity(listing.blocks.len()),
            written: Vec::with_capacity(listing.blocks.len()),
            marks: Vec::new(),
            openings: Vec::new(),
            at_first_motion: None,
            at_first_arc: None,
            reached: vec![false; listing.blocks.len()],
        },
        calls: vec![Call { section: 0, next: listing.sections[0].blocks.start, again: 0 }],
    };
    runner.run(most_blocks, refuse)?;
    Ok(runner.ran)
}

struct Runner<'a> {
    listing: &'a Listing<'a>,
    reading: &'a Reading,
    grammar: &'static Grammar,
    machine: Machine<'a>,
    /// The block that is run has G53.
    in_machine_coordinates: bool,
    /// The last comment that was run through.
    label: usize,
    ran: Ran,
    /// The main program, and above it the subprograms that are running.
    calls: Vec<Call>,
}

impl Runner<'_> {
    fn run(&mut self, most_blocks: usize, refuse: &mut Refuse<'_>) -> Result<()> {
        let listing = self.listing;
        let (mut ran, mut refused) = (0, 0);
        while let Some(call) = self.calls.last_mut() {
            let section = &listing.sections[call.section];
            if call.next >= section.blocks.end {
                return refuse(listing.locate(section.last, self.no_end()));
            }
            let block = &listing.blocks[call.next];
            self.ran.reached[call.next] = true;
            call.next += 1;
            ran += 1;
            let steps = self.ran.steps.len();
            let marks = self.ran.marks.len().max(refused);
            if ran > most_blocks || steps > MOST_STEPS || marks > MOST_MARKS {
                let what = if steps > MOST_STEPS {
                    format!("the program makes more than {MOST_STEPS} moves")
                } else if marks > MOST_MARKS {
                    format!(
                        "more than {MOST_MARKS} blocks cannot be followed or interrupt the motion"
                    )
                } else {
                    format!("the program runs more than {most_blocks} blocks")
                };
                let fault = Fault::line(what)
                    .hint("look for a subprogram that is repeated too often: L of M98; or divide the program");
                return refuse(listing.locate(block.line, fault));
            }
            let next = match self.block(block) {
                Ok(next) if !block.faulty => next,
                Ok(_) => self.guess(block),
                Err(fault) => {
                    refused += 1;
                    refuse(listing.locate(block.line, fault))?;
                    self.guess(block)
                }
            };
            match next {
                Next::Block => {}
                Next::Call(call) => self.calls.push(call),
                Next::Return => self.leave(),
                Next::End => return Ok(()),
            }
        }
        Ok(())
    }

    /// Runs the current subprogram once more, or returns from it.
    fn leave(&mut self) {
        if let Some(call) = self.calls.last_mut() {
            if call.again > 0 {
                call.again -= 1;
                call.next = self.listing.sections[call.section].blocks.start;
            } else {
                self.calls.pop();
            }
        }
    }

    /// What a block that cannot be followed was meant to do: where it leads, and whether the program
    /// leaves.
    fn guess(&mut self, block: &Block) -> Next {
        let words = self.listing.words(block);
        self.machine.assume(words);
        self.mark(block, None);
        let function = |word: &Word| {
            (word.letter == b'M').then(|| self.grammar.miscellaneous(word).ok()).flatten()
        };
        let leaves = |word: &Word| {
            matches!(function(word), Some(Miscellaneous::End | Miscellaneous::Return))
        };
        match words.iter().find(|word| leaves(word)).and_then(function) {
            Some(Miscellaneous::Return) if self.calls.len() > 1 => Next::Return,
            Some(_) => Next::End,
            None => Next::Block,
        }
    }

    fn mark(&mut self, block: &Block, word: Option<Word>) {
        self.ran.marks.push(Mark { step: self.ran.steps.len(), line: block.line, word });
    }

    /// The file goes on no further, but the program has not ended.
    fn no_end(&self) -> Fault {
        let section = self.calls.last().map_or(0, |call| call.section);
        let section = &self.listing.sections[section];
        let line = section.last.number;
        match section.number {
            Some(number) if self.calls.len() > 1 => {
                Fault::line(format!("subprogram O{number} ends at line {line} without M99"))
                    .hint("the file may have been cut off; a subprogram returns by M99")
            }
            _ => Fault::line(format!("the program ends at line {line} without M30"))
                .hint("the file may have been cut off; a main program ends with M30 or M02"),
        }
    }

    fn step(&mut self, block: &Block, action: Action) {
        let modal = &self.machine.modal;
        self.ran.written.push(Written {
            incremental: modal.incremental,
            inch: modal.inch,
            exact_stop: modal.exact_stop,
            machine_coordinates: self.in_machine_coordinates,
            work_offset: modal.work_offset,
        });
        self.ran.steps.push(Step { line: block.line.number, label: self.label, action });
    }

    fn block(&mut self, block: &Block) -> std::result::Result<Next, Fault> {
        if block.label > 0 {
            self.label = block.label;
        }
        let words = self.listing.words(block);
        if words.is_empty() || block.faulty {
            return Ok(Next::Block);
        }
        let command = Command::new(words, &mut self.machine.modal, self.grammar)?;
        self.in_machine_coordinates =
            matches!(command.one_shot, Some((Code::MachineCoordinates, _)));
        match command.one_shot {
            Some((Code::Dwell, word)) => {
                let seconds = dwell(&command, word, &self.grammar.dwell)?;
                self.step(block, Action::Dwell { seconds });
            }
            Some((Code::LookAhead(function), word)) => look_ahead(&command, function, word)?,
            _ => {
                let mut letters = ANYWHERE.and(COORDINATES).and(ARC);
                if let Some((Miscellaneous::Call, _)) = command.miscellaneous {
                    letters = letters.and(Letters::of(b"PL"));
                }
                if command.tolerance {
                    letters = letters.and(Letters::of(b"PQ"));
                }
                command.allow_only(letters)?;
                if let Some((Code::MachineCoordinates, word)) = command.one_shot {
                    self.mark(block, Some(*word));
                }
                let moved = self.machine.motion(&command)?;
                if moved != Moved::Not {
                    let stated = self.machine.modal.stated;
                    self.ran.at_first_motion.get_or_insert((block.line, stated));
                    if matches!(moved, Moved::Along(motion) if motion.path != Path::Line) {
                        self.ran.at_first_arc.get_or_insert((block.line, stated));
                    }
                }
                match moved {
                    Moved::Not => {}
                    Moved::Along(motion) => self.step(block, Action::Move(motion)),
                    Moved::Opening(to_mm) => {
                        let step = self.ran.steps.len();
                        self.ran.openings.push(Opening { step, line: block.line, to_mm });
                    }
                }
            }
        }
        self.miscellaneous(block, &command)
    }

    /// The M word of a block takes effect after its motion.
    fn miscellaneous(
        &mut self,
        block: &Block,
        command: &Command,
    ) -> std::result::Result<Next, Fault> {
        let Some((function, word)) = command.miscellaneous else {
            return Ok(Next::Block);
        };
        match function {
            Miscellaneous::Stop => self.step(block, Action::Stop),
            Miscellaneous::OptionalStop if self.reading.optional_stop => {
                self.step(block, Action::Stop);
            }
            Miscellaneous::OptionalStop | Miscellaneous::NoMotion => self.mark(block, Some(*word)),
            Miscellaneous::End => {
                self.step(block, Action::End);
                return Ok(Next::End);
            }
            Miscellaneous::Call => return self.call(command, word),
            Miscellaneous::Return if self.calls.len() > 1 => return Ok(Next::Return),
            Miscellaneous::Return => {
                return Err(Fault::word(word, "M99 in the main program repeats it for ever")
                    .hint("end the main program with M30"));
            }
        }
        Ok(Next::Block)
    }

    fn call(&self, command: &Command, word: &Word) -> std::result::Result<Next, Fault> {
        let Some(program) = command.word(b'P') else {
            return Err(Fault::word(word, "M98 without P")
                .hint("write the number of the subprogram: M98 P1000"));
        };
        let section = program.whole().and_then(|number| self.listing.section(number));
        let Some(section) = section else {
            let number = program.value;
            return Err(Fault::word(program, format!("the file has no subprogram O{number}"))
                .hint("subprograms are read from the same file, after the main program; repeats are written by L"));
        };
        let again = match command.word(b'L').map(|word| (word, word.whole())) {
            None => 0,
            Some((_, Some(times @ 1..))) => times - 1,
            Some((word, _)) => {
                return Err(Fault::word(
                    word,
                    "the number of repeats is not a whole number from 1",
                )
                .hint("L3 runs the subprogram three times"));
            }
        };
        if self.calls.len() > DEEPEST_CALL {
            return Err(Fault::word(word, format!("a call more than {DEEPEST_CALL} deep"))
                .hint("the control allows four calls within each other"));
        }
        Ok(Next::Call(Call { section, next: self.listing.sections[section].blocks.start, again }))
    }
}

/// The duration of G04, s.
fn dwell(command: &Command, word: &Word, written: &Dwell) -> std::result::Result<f64, Fault> {
    let hint = written.hint;
    if let Some(other) = command.motion.or(command.jump()) {
        return Err(
            Fault::word(other, format!("{} beside {}", other.name(), word.name())).hint(hint)
        );
    }
    if written.alone && command.len() > 2 {
        return Err(Fault::word(word, "a dwell is not alone in its block").hint(hint));
    }
    let beside = if written.alone { Letters::of(b"G") } else { ANYWHERE };
    command.allow_only(beside.and(written.letters))?;
    let given: Vec<&Word> =
        (b'A'..=b'Z').filter(|l| written.letters.has(*l)).filter_map(|l| command.word(l)).collect();
    let [time] = given[..] else {
        return Err(Fault::word(word, "a dwell needs one time").hint(hint));
    };
    if time.value < 0.0 {
        return Err(Fault::word(time, "the time of a dwell is negative").hint(hint));
    }
    if written.milliseconds && time.point && time.letter == b'P' {
        return Err(Fault::word(time, "the time of a dwell by P has a decimal point")
            .hint("P counts whole milliseconds; write X or U for seconds: G04 X2.0"));
    }
    let counts_s = !written.milliseconds || time.point;
    let seconds = if counts_s { time.value } else { time.value / 1e3 };
    if seconds > written.longest_s {
        let what = format!("a dwell lasts {} s at the most", written.longest_s);
        return Err(Fault::word(time, what).hint(hint));
    }
    Ok(seconds)
}
