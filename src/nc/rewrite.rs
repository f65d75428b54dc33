//! A program whose moves lead elsewhere: their coordinates exchanged, everything else word for word.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use nalgebra::Vector3;

use super::grammar::{Form, Grammar};
use super::lines::{Line, text};
use super::listing::{Block, Listing};
use super::program::{Action, Move, Path as Way};
use super::read::read_at_most;
use super::reading::Reading;
use super::run::{self, Written};
use super::word::{Fault, Word};
use crate::error::{Error, Result};

/// A move of a program, with what its block says around it.
#[derive(Debug, Clone, Copy)]
pub struct Driven {
    /// The line of its block.
    pub line: usize,
    /// What it does, machine coordinates.
    pub motion: Move,
    /// Machine coordinates of the zero of the work offset in force, mm; `None` of a move in machine coordinates, which stays
    /// as it is.
    pub zero_mm: Option<Vector3<f64>>,
    written: Written,
}

impl Driven {
    /// Whether the control would stop at every point between (G61).
    pub fn stops_between(&self) -> bool {
        self.written.exact_stop
    }
}

/// Where the control is, as the new program has it, machine coordinates, mm.
pub type At = [f64; 3];

/// A program that can be written anew.
#[derive(Debug)]
pub struct Rewriting<'a> {
    listing: Listing<'a>,
    source: &'a str,
    reading: &'a Reading,
    moves: Vec<Driven>,
    decimals: usize,
}

impl<'a> Rewriting<'a> {
    /// Follows a program; its numbers are to have so many decimals of a millimetre.
    ///
    /// # Errors
    /// When it cannot be followed, or is in a language whose blocks are not exchanged.
    pub fn of(
        source: &'a str,
        file: &'a Path,
        reading: &'a Reading,
        decimals: usize,
    ) -> Result<Self> {
        let listing = Listing::new(source, file, reading, &mut Err)?;
        if Grammar::of(reading.dialect).form == Form::Klartext {
            return Err(listing
                .whole("a program in Klartext is not corrected")
                .hint("write it for a control of DIN/ISO words"));
        }
        let ran = run::run(&listing, reading, run::MOST_BLOCKS, &mut Err)?;
        if let Some(line) = listing.unclosed {
            return Err(listing.cut_off(line));
        }
        let moves = ran.steps.iter().zip(ran.written).filter_map(|(step, written)| {
            let Action::Move(motion) = step.action else { return None };
            let offset = reading.work_offsets_mm.get(&written.work_offset).copied();
            let zero_mm = offset.filter(|_| !written.machine_coordinates);
            Some(Driven { line: step.line, motion, zero_mm, written })
        });
        let moves = moves.collect();
        // The mark in front of a text is no part of it.
        let source = source.strip_prefix('\u{feff}').unwrap_or(source);
        Ok(Self { listing, source, reading, moves, decimals })
    }

    /// The moves in the order in which they are driven.
    pub fn moves(&self) -> &[Driven] {
        &self.moves
    }

    /// The step of a coordinate of a move as it will be written, mm.
    pub fn step_mm(&self, of: &Driven) -> f64 {
        let step = 10f64.powi(-(self.digits(of) as i32));
        if of.written.inch { step * INCH_MM } else { step }
    }

    fn digits(&self, of: &Driven) -> usize {
        self.decimals + usize::from(of.written.inch)
    }

    /// What the control will be at when a coordinate is written for it, mm.
    pub fn rounded_mm(&self, of: &Driven, target_mm: f64, axis: usize, at: &At) -> f64 {
        let from = Self::origin_mm(of, axis, at);
        let step = self.step_mm(of);
        from + ((target_mm - from) / step).round() * step
    }

    /// What coordinates of its block count from.
    fn origin_mm(of: &Driven, axis: usize, at: &At) -> f64 {
        match of.zero_mm {
            Some(zero_mm) if !of.written.incremental => zero_mm[axis],
            _ => at[axis],
        }
    }

    /// The lines of a move that leads over these points, from where the control is; the points are such as
    /// [`rounded_mm`](Self::rounded_mm) gives.
    pub fn lines(&self, of: &Driven, from: &At, points: &[At]) -> String {
        let Some(block) = self.listing.block_of(of.line) else { return String::new() };
        let words = self.listing.words(block);
        let line = text(self.source, block.line);
        // What the block puts in force holds from its first part on.
        let in_force = words.iter().filter(|word| match word.letter {
            b'F' => true,
            b'G' => !matches!(word.whole(), Some(0..=3 | 9)),
            _ => false,
        });
        let in_force: Vec<&str> = in_force.filter_map(|word| spelled(line, word)).collect();
        let in_force = in_force.join(" ");
        let motion = if of.motion.rapid { "G00" } else { "G01" };
        let mut told = String::new();
        let mut at = *from;
        // A part that block delete leaves out is left out with its block.
        let delete = if line.trim_start().starts_with('/') { "/" } else { "" };
        for (k, point) in points.iter().enumerate() {
            let coordinates = self.coordinates(of, &at, point);
            at = *point;
            if k + 1 == points.len() {
                let arc = of.motion.path != Way::Line;
                told.push_str(&exchanged(line, words, &coordinates, arc.then_some(motion)));
            } else if k == 0 {
                let gap = if in_force.is_empty() { "" } else { " " };
                let _ = writeln!(told, "{delete}{in_force}{gap}{motion} {coordinates}");
            } else {
                let _ = writeln!(told, "{delete}{coordinates}");
            }
        }
        told
    }

    fn coordinates(&self, of: &Driven, at: &At, point: &At) -> String {
        let unit = if of.written.inch { INCH_MM } else { 1.0 };
        let digits = self.digits(of);
        let each = ['X', 'Y', 'Z'].iter().enumerate().map(|(axis, letter)| {
            let number = (point[axis] - Self::origin_mm(of, axis, at)) / unit;
            let number = format!("{number:.digits$}");
            let number = number.trim_end_matches('0');
            let number = if number == "-0." { "0." } else { number };
            format!("{letter}{number}")
        });
        each.collect::<Vec<_>>().join(" ")
    }

    /// The program with these lines, by their number, exchanged.
    pub fn with(&self, exchanged: &BTreeMap<usize, String>) -> String {
        let mut told = String::with_capacity(self.source.len() * 2);
        for (line, text) in self.listing.all_lines() {
            told.push_str(exchanged.get(&line.number).map_or(text, String::as_str));
            told.push('\n');
        }
        // What has no end of its last line gets none.
        if told.ends_with("\n\n") || !self.source.ends_with('\n') {
            told.pop();
        }
        told
    }

    /// Reads a text that was written anew, and follows it over the points that it should lead over.
    ///
    /// # Errors
    /// When it leads elsewhere: a block that says where the machine is already does not move it in the program as it was, and
    /// does in this one.
    pub fn verify(&self, text: &str, points: &[At]) -> Result<()> {
        let again = read_at_most(text, self.listing.file, self.reading, run::MOST_BLOCKS)?;
        let ends = again.steps.iter().filter_map(|step| match step.action {
            Action::Move(motion) => Some((step.line, motion.end_mm)),
            _ => None,
        });
        let mut expected = points.iter();
        for (line, end_mm) in ends {
            let there =
                expected.next().is_some_and(|to| (end_mm - Vector3::from(*to)).amax() < SAME_MM);
            if !there {
                let words = text.lines().nth(line.saturating_sub(1)).unwrap_or("").to_owned();
                return Err(self
                    .listing
                    .whole(format!("the corrected program would not go where it should by `{words}`"))
                    .hint("a block that says where the machine is already cannot be corrected: remove its coordinates"));
            }
        }
        if expected.next().is_some() {
            return Err(self
                .listing
                .whole("the corrected program would not go everywhere it should"));
        }
        Ok(())
    }

    /// An error of the block of a move.
    pub fn refused(&self, of: &Driven, what: String, hint: &str) -> Error {
        let at = self.listing.block_of(of.line).map(|block: &Block| block.line);
        let at = at.unwrap_or(Line { number: of.line, start: 0 });
        self.listing.locate(at, Fault::line(what).hint(hint))
    }
}

/// Two places that differ by less were rounded, mm.
const SAME_MM: f64 = 1e-6;
/// How many millimetres an inch has.
const INCH_MM: f64 = 25.4;

/// A word as it stands in its line.
fn spelled<'a>(line: &'a str, word: &Word) -> Option<&'a str> {
    let start = word.start as usize;
    line.get(start..start + word.width as usize)
}

/// A line with other coordinates, in the place of the first of its own; the words of an arc go, and `motion` takes the place
/// of its G word.
fn exchanged(line: &str, words: &[Word], coordinates: &str, motion: Option<&str>) -> String {
    let mut told = String::with_capacity(line.len() + coordinates.len());
    let mut done = 0;
    let mut placed = false;
    let arc = |word: &Word| {
        word.letter == b'G' && matches!(word.whole(), Some(2 | 3)) && motion.is_some()
    };
    let names_motion = words.iter().any(arc);
    for word in words {
        let of_arc = motion.is_some() && matches!(word.letter, b'I' | b'J' | b'K' | b'R');
        let coordinate = matches!(word.letter, b'X' | b'Y' | b'Z');
        if !(of_arc || coordinate || arc(word)) {
            continue;
        }
        let (start, end) = (word.start as usize, (word.start + word.width) as usize);
        told.push_str(line.get(done..start).unwrap_or(""));
        done = end;
        if arc(word) {
            told.push_str(motion.unwrap_or(""));
        } else if placed {
            // Nor the blank before it.
            told.truncate(told.trim_end_matches(' ').len());
        } else {
            if let Some(motion) = motion.filter(|_| !names_motion) {
                told.push_str(motion);
                told.push(' ');
            }
            told.push_str(coordinates);
            placed = true;
        }
    }
    told.push_str(line.get(done..).unwrap_or(""));
    told
}
