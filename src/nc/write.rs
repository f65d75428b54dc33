//! Writing a planned path as a Fanuc program.

use askama::Template;
use nalgebra::Vector3;

use super::{Action, Program};
use crate::error::{Error, Kind, Result};
use crate::machine::{Controller, Machine};
use crate::plan::{Path, Step, Test};

#[derive(Template)]
#[template(path = "fanuc.nc", escape = "none")]
struct Fanuc {
    number: String,
    title: String,
    header: Vec<String>,
    blocks: Vec<String>,
}

/// The program of a path: header with machine, test and hash of the test file, safe start, G64, the
/// arcs in G01 chords, M30.
///
/// Chord blocks carry no N number: there are more of them than numbers. Every axis word has a decimal
/// point, because without one it counts in least increments. Coordinates are those of the mounting's
/// work offset, whose zero is the workpiece ball.
pub fn write(test: &Test, machine: &Machine, path: &Path) -> Result<String> {
    let plan = test.plan()?;
    let mounting = &test.mountings()[path.mounting];
    let mut writer = Writer {
        controller: machine.controller(),
        blocks: Vec::new(),
        sequence: 0,
        at: None,
        feed: number(plan.feed_mm_s * 60.0),
        feeding: false,
        feed_written: false,
    };
    writer.block("G21 G17 G90 G94 G40 G49 G80");
    writer.block(&format!("G{}", mounting.work_offset));
    writer.block("G64");
    for step in &path.steps {
        writer.step(step);
    }
    writer.block("M30");
    let comment = |text: String| writer.comment(&text);
    let offset = &mounting.mounting.coincidence_mm;
    let program = Fanuc {
        number: format!("{:04}", plan.program_number + path.mounting as u32),
        title: comment(format!(
            "BALL-BAR {} R{} F{}",
            plan.strategy_name(),
            number(mounting.bar_length_mm).trim_end_matches('.'),
            number(plan.feed_mm_s * 60.0).trim_end_matches('.')
        )),
        header: vec![
            comment(format!("MACHINE {}", machine.name())),
            comment(format!("TEST {}", test.name())),
            comment(format!("SHA256 {}", &test.hash()[..16])),
            comment(format!(
                "MOUNTING {} - G{} ZERO IS THE WORKPIECE BALL",
                mounting.name, mounting.work_offset
            )),
            comment(format!(
                "MACHINE COORDINATES X{:.3} Y{:.3} Z{:.3}",
                offset.x, offset.y, offset.z
            )),
        ],
        blocks: writer.blocks,
    };
    let mut text = program.render().map_err(|error| {
        Error::new(Kind::Output, format!("the program template cannot be filled: {error}"))
    })?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(text)
}

/// A number with a decimal point and no more digits than it needs: `500.`, `333.3`.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').to_owned()
}

struct Writer<'a> {
    controller: &'a Controller,
    blocks: Vec<String>,
    sequence: u32,
    /// The words of the last position.
    at: Option<[String; 3]>,
    feed: String,
    feeding: bool,
    feed_written: bool,
}

impl Writer<'_> {
    fn block(&mut self, words: &str) {
        let step = self.controller.sequence_step;
        self.sequence += step;
        // N goes to 99999 and begins anew then; the control does not mind.
        if self.sequence > 99_999 {
            self.sequence = step;
        }
        let block = match step {
            0 => words.to_owned(),
            _ => format!("N{} {words}", self.sequence),
        };
        self.blocks.push(block);
    }

    /// Upper case, and only characters that the machine file allows.
    fn comment(&self, text: &str) -> String {
        let allowed = &self.controller.comment_characters;
        text.to_uppercase()
            .chars()
            .filter(|c| {
                c.is_ascii_alphanumeric() || (allowed.contains(*c) && !"()%;\n\r".contains(*c))
            })
            .collect()
    }

    /// The three axis words of a point, rounded, never a negative zero.
    fn words(&self, point: &Vector3<f64>) -> [String; 3] {
        let decimals = self.controller.decimals;
        [('X', point.x), ('Y', point.y), ('Z', point.z)].map(|(letter, value)| {
            let text = format!("{value:.decimals$}");
            let zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
            format!("{letter}{}", if zero { text.trim_start_matches('-') } else { &text })
        })
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Comment(text) => {
                let comment = self.comment(text);
                self.blocks.push(format!("({comment})"));
            }
            Step::Rapid(point) => {
                let words = self.words(point);
                self.block(&format!("G00 {}", words.join(" ")));
                self.at = Some(words);
                self.feeding = false;
            }
            Step::Feed(point) => {
                let words = self.words(point);
                let feed =
                    if self.feed_written { String::new() } else { format!(" F{}", self.feed) };
                self.block(&format!("G01 {}{feed}", words.join(" ")));
                (self.at, self.feeding, self.feed_written) = (Some(words), true, true);
            }
            Step::Chords(points) => {
                for point in points {
                    let words = self.words(point);
                    // Points that rounding makes one are one.
                    if self.at.as_ref() == Some(&words) {
                        continue;
                    }
                    let mode = if self.feeding { "" } else { "G01 " };
                    self.blocks.push(format!("{mode}{}", words.join(" ")));
                    self.feeding = true;
                    self.at = Some(words);
                }
            }
            Step::Dwell(seconds) => self.block(&format!("G04 P{:.0}", seconds * 1000.0)),
            Step::Stop(text) => {
                let comment = self.comment(text);
                self.block(&format!("M00 ({comment})"));
            }
            Step::LookAhead(on) => {
                let words = if *on {
                    &self.controller.look_ahead_on
                } else {
                    &self.controller.look_ahead_off
                };
                if !words.is_empty() {
                    let words = words.clone();
                    self.block(&words);
                }
            }
        }
        // G01 is stated anew after every interruption, for the operator who starts in the middle.
        if !matches!(step, Step::Chords(_) | Step::Feed(_)) {
            self.feeding = false;
        }
    }
}

/// How a program that was read back compares with its plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadBack {
    /// Points compared.
    pub points: usize,
    /// Largest distance between a commanded and a planned coordinate, mm.
    pub worst_mm: f64,
    /// Largest sagitta of a chord on the sphere, mm.
    pub sag_mm: f64,
}

/// Compares every end point of a program with the plan, in order.
///
/// # Errors
/// When the program has another number of moves than the plan, with both.
pub fn read_back(program: &Program, test: &Test, path: &Path) -> Result<ReadBack> {
    let coincidence_mm = &test.mountings()[path.mounting].mounting.coincidence_mm;
    let sphere_mm = test.bar_of(path.mounting).length_mm;
    // The first rapid comes from an unknown place and is no step of the program.
    let planned: Vec<&Vector3<f64>> = path.points().skip(1).collect();
    let mut moves = program.steps.iter().filter_map(|step| match &step.action {
        Action::Move(motion) => Some(motion),
        _ => None,
    });
    let mut result = ReadBack { points: 0, worst_mm: 0.0, sag_mm: 0.0 };
    for point in &planned {
        let Some(motion) = moves.next() else { break };
        let off = (motion.end_mm - coincidence_mm - *point).amax();
        result.worst_mm = result.worst_mm.max(off);
        result.points += 1;
        let start = motion.start_mm - coincidence_mm;
        // Chords only: both ends on the sphere.
        if (start.norm() - sphere_mm).abs() < 0.01 && (point.norm() - sphere_mm).abs() < 0.01 {
            let chord = (motion.end_mm - motion.start_mm).norm();
            result.sag_mm = result.sag_mm.max(chord * chord / (8.0 * sphere_mm));
        }
    }
    let left = moves.count();
    if result.points < planned.len() || left > 0 {
        return Err(Error::input(format!(
            "the program makes {} moves, the plan {}",
            result.points + left,
            planned.len()
        ))
        .hint("write the program anew with `ballbar program`"));
    }
    Ok(result)
}
