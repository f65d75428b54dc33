//! Writing a planned path as a program of the control.

use askama::Template;
use nalgebra::Vector3;

use super::{comment, header};
use crate::error::{Error, Kind, Place, Result};
use crate::machine::{Controller, Dialect, Machine};
use crate::plan::{Circular, Path, Plane, Step, Test};

/// A program before it is put into the words of a dialect, line by line; `N` numbers include their blank.
enum Line {
    Comment(String),
    /// A point of an arc, without a number.
    Chord(String),
    /// A number, and words that every dialect has.
    Block(String, String),
    /// Cutting mode: no stop at the end of a block.
    Cutting(String),
    Dwell(String, Seconds),
    Call(String, u32),
    End(String),
    /// A subprogram begins.
    Subprogram(u32, String),
    Return(String),
}

/// How long a dwell lasts, s.
struct Seconds(f64);

impl Seconds {
    /// In whole milliseconds, as a Fanuc counts.
    fn milliseconds(&self) -> String {
        format!("{:.0}", self.0 * 1000.0)
    }

    /// In seconds, as LinuxCNC counts.
    fn decimal(&self) -> String {
        format!("{:.3}", self.0)
    }
}

#[derive(Template)]
#[template(path = "fanuc.nc", escape = "none")]
struct Fanuc<'a> {
    number: &'a str,
    title: &'a str,
    header: &'a [String],
    lines: &'a [Line],
}

/// With G64 alone, LinuxCNC would round the corners as far as its acceleration asks for; without Q0 it would put chords
/// together as far as P lets it, and what was planned within 0.4 um would be driven within 10.
#[derive(Template)]
#[template(path = "linuxcnc.nc", escape = "none")]
struct LinuxCnc<'a> {
    number: &'a str,
    title: &'a str,
    header: &'a [String],
    lines: &'a [Line],
}

/// The program of a path: header with machine, test and what to mount where; first what a path depends on and an operator or
/// another program may have left otherwise, the spindle standing and the coolant off; then G64, the
/// arcs in G01 chords or as G02 and G03, M30.
///
/// Chord blocks carry no N number: there are more of them than numbers. Every axis word has a decimal
/// point, because without one it counts in least increments. Coordinates are those of the mounting's
/// work offset, whose zero is the workpiece ball.
///
/// A program larger than the control's memory is divided: every arc and every transit becomes a
/// subprogram behind the main program, in the same file.
///
/// # Errors
/// When a single arc is larger than the memory, or there are no program numbers left for the arcs.
pub fn write(test: &Test, machine: &Machine, path: &Path) -> Result<String> {
    let whole = render(test, machine, path, None)?;
    let Some(memory_bytes) = machine.controller().memory_bytes.filter(|size| *size < whole.len())
    else {
        return Ok(whole);
    };
    let plan = test.plan()?;
    // Behind the main programs of all mountings, so that all fit into one control.
    let legs = path.legs.len() as u32;
    let first = plan.program_number + test.mountings().len() as u32 + path.mounting as u32 * legs;
    if first + legs > LARGEST_NUMBER + 1 {
        return Err(Error::input(format!(
            "the {legs} arcs of the program would need the numbers O{first} to O{}",
            first + legs - 1
        ))
        .hint(format!("numbers go to {LARGEST_NUMBER}: choose a smaller `program_number`")));
    }
    let divided = render(test, machine, path, Some(first))?;
    let largest = divided.split("\nO").map(|part| part.len() + 1).max().unwrap_or(0);
    if largest > memory_bytes {
        return Err(Error::input(format!(
            "an arc alone takes {} KB, and the control's memory is {} KB",
            largest.div_ceil(1024),
            memory_bytes / 1024
        ))
        .hint(
            "allow more `chord_sag_um`, or run the program from a card and leave `memory_kb` out",
        ));
    }
    Ok(divided)
}

/// With fewer the ends of an arc are rounded so far that their radii differ by more than a control lets pass.
const DECIMALS_OF_ARCS: usize = 3;

/// Largest program number that is free for users.
const LARGEST_NUMBER: u32 = 7999;

fn render(test: &Test, machine: &Machine, path: &Path, subprograms: Option<u32>) -> Result<String> {
    let plan = test.plan()?;
    let circular = |step: &Step| matches!(step, Step::Circular(..));
    if machine.controller().decimals < DECIMALS_OF_ARCS && path.steps.iter().any(circular) {
        return Err(Error::input(
            "with 2 decimals the two ends of an arc of G02 and G03 have radii up to 14 um apart, which controls refuse",
        )
        .at(Place::file(test.file()))
        .hint("write `interpolation = \"chords\"` in `[plan]`, or give the control the `decimals` that it has"));
    }
    let mounting = &test.mountings()[path.mounting];
    let mut writer = Writer {
        controller: machine.controller(),
        lines: Vec::new(),
        subprograms: Vec::new(),
        next: subprograms,
        sequence: 0,
        at: None,
        zero_mm: mounting.mounting.coincidence_mm,
        work_offset: mounting.work_offset,
        feeding: false,
        feed_in_force: String::new(),
    };
    writer.block("G21 G17 G90 G94 G40 G49 G80");
    for words in &machine.controller().cancel_blocks {
        writer.block(words);
    }
    writer.block("M05");
    writer.block("M09");
    writer.block(&format!("G{}", mounting.work_offset));
    let n = writer.n();
    writer.lines.push(Line::Cutting(n));
    writer.steps(&path.steps);
    let n = writer.n();
    writer.lines.push(Line::End(n));
    writer.lines.append(&mut writer.subprograms);
    let comment = |text: String| writer.comment(&text);
    let number_of = format!("{:04}", plan.program_number + path.mounting as u32);
    let title = comment(header::title(plan, mounting));
    let header: Vec<String> = header::lines(test, machine, path).into_iter().map(comment).collect();
    let (number, title, header, lines) = (&*number_of, &*title, &header[..], &writer.lines[..]);
    let rendered = match machine.controller().dialect {
        Dialect::Fanuc => Fanuc { number, title, header, lines }.render(),
        Dialect::LinuxCnc => LinuxCnc { number, title, header, lines }.render(),
    };
    let mut text = rendered.map_err(|error| {
        Error::new(Kind::Output, format!("the program template cannot be filled: {error}"))
    })?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(text)
}

/// The G word of a plane.
fn plane_word(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    }
}

/// How many of these steps are one arc with its overshoot and its look-ahead; 0 where they begin with something else.
fn of_arc(steps: &[Step]) -> usize {
    let off = |step: &Step| *step == Step::LookAhead(false);
    match steps {
        [Step::LookAhead(true), ..] => 1 + steps.iter().position(off).unwrap_or(steps.len() - 1),
        _ => 0,
    }
}

/// A number with a decimal point and no more digits than it needs: `500.`, `333.3`.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').to_owned()
}

struct Writer<'a> {
    controller: &'a Controller,
    lines: Vec<Line>,
    subprograms: Vec<Line>,
    /// The number of the next subprogram, if arcs are subprograms.
    next: Option<u32>,
    sequence: u32,
    /// The last position, in units of the last decimal.
    at: Option<[i64; 3]>,
    /// Machine coordinates of the zero of the work offset, mm.
    zero_mm: Vector3<f64>,
    work_offset: u8,
    feeding: bool,
    /// The last F.
    feed_in_force: String,
}

impl Writer<'_> {
    /// The number of the next block with its blank, or nothing.
    fn n(&mut self) -> String {
        let step = self.controller.sequence_step;
        if step == 0 {
            return String::new();
        }
        self.sequence += step;
        // N goes to 99999 and begins anew then; the control does not mind.
        if self.sequence > 99_999 {
            self.sequence = step;
        }
        format!("N{} ", self.sequence)
    }

    fn block(&mut self, words: &str) {
        let n = self.n();
        self.lines.push(Line::Block(n, words.to_owned()));
    }

    /// All steps; an arc from its comment to the end of its look-ahead may go into a subprogram.
    fn steps(&mut self, steps: &[Step]) {
        let mut rest = steps;
        while let Some((step, after)) = rest.split_first() {
            let arc = match (self.next, rest) {
                (Some(number), [Step::Comment(name), arc @ ..]) => {
                    let length = of_arc(arc);
                    (length > 0).then(|| (number, name, &arc[..length]))
                }
                _ => None,
            };
            let Some((number, name, arc)) = arc else {
                self.step(step);
                rest = after;
                continue;
            };
            let n = self.n();
            self.lines.push(Line::Call(n, number));
            let main = std::mem::take(&mut self.lines);
            self.lines.push(Line::Subprogram(number, self.comment(name)));
            self.feeding = false;
            for step in arc {
                self.step(step);
            }
            let n = self.n();
            self.lines.push(Line::Return(n));
            let mut subprogram = std::mem::replace(&mut self.lines, main);
            self.subprograms.append(&mut subprogram);
            self.feeding = false;
            self.next = Some(number + 1);
            rest = &rest[1 + arc.len()..];
        }
    }

    fn comment(&self, text: &str) -> String {
        comment::of(self.controller, text)
    }

    /// A point in units of the last decimal.
    fn rounded(&self, point: &Vector3<f64>) -> [i64; 3] {
        let unit = 10_f64.powi(self.controller.decimals as i32);
        [point.x, point.y, point.z].map(|value| (value * unit).round() as i64)
    }

    /// The three axis words of a rounded point behind what is there; zero has no sign.
    fn words(&self, mut text: String, rounded: &[i64; 3]) -> String {
        text.reserve(40);
        for (letter, value) in ["X", " Y", " Z"].into_iter().zip(*rounded) {
            text.push_str(letter);
            self.decimal(&mut text, value);
        }
        text
    }

    /// A number in units of the last decimal behind what is there; zero has no sign.
    fn decimal(&self, text: &mut String, value: i64) {
        if value < 0 {
            text.push('-');
        }
        // Digits from the last; formatting by the library makes the whole seven times slower.
        let mut digits = [b'0'; 24];
        let (mut left, mut at) = (value.unsigned_abs(), digits.len());
        while at > digits.len() - self.controller.decimals - 2 || left > 0 {
            at -= 1;
            if digits.len() - at == self.controller.decimals + 1 {
                digits[at] = b'.';
            } else {
                digits[at] = b'0' + (left % 10) as u8;
                left /= 10;
            }
        }
        text.extend(digits[at..].iter().map(|digit| char::from(*digit)));
    }

    /// A straight move, with F where another is in force.
    fn feed(&mut self, point: &Vector3<f64>, feed_mm_s: f64) {
        let rounded = self.rounded(point);
        let words = self.words("G01 ".to_owned(), &rounded);
        let feed = self.f(feed_mm_s);
        self.block(&(words + &feed));
        (self.at, self.feeding) = (Some(rounded), true);
    }

    /// The F word with its blank where another one is in force.
    fn f(&mut self, feed_mm_s: f64) -> String {
        let feed = number(feed_mm_s * 60.0);
        if self.feed_in_force == feed {
            return String::new();
        }
        self.feed_in_force.clone_from(&feed);
        format!(" F{feed}")
    }

    /// A circular arc about the zero of the work offset: plane, sense, end, and the way from its start to its centre.
    ///
    /// The axis that it does not move is not named. Ends that rounding makes one would be a whole turn, so they are written
    /// where a whole turn is meant and nowhere else.
    fn circular(&mut self, arc: &Circular, feed_mm_s: f64) {
        let (Some(from), Some(end)) = (self.at, arc.points.last()) else { return };
        let to = self.rounded(end);
        let axes = arc.plane.axes();
        let stays = axes.iter().all(|&axis| from[axis] == to[axis]);
        if stays && arc.sweep_rad.abs() < std::f64::consts::PI {
            return;
        }
        let mut words = plane_word(arc.plane).to_owned();
        words += if arc.sweep_rad > 0.0 { " G03" } else { " G02" };
        // X before Y before Z, as everywhere.
        let mut letters = axes;
        letters.sort_unstable();
        for (names, values) in [(["X", "Y", "Z"], to), (["I", "J", "K"], from.map(|at| -at))] {
            for axis in letters {
                words += " ";
                words += names[axis];
                self.decimal(&mut words, values[axis]);
            }
        }
        words += &self.f(feed_mm_s);
        self.block(&words);
        (self.at, self.feeding) = (Some(to), false);
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Comment(text) => {
                let comment = self.comment(text);
                self.lines.push(Line::Comment(comment));
            }
            Step::Rapid(point) => {
                let rounded = self.rounded(point);
                self.block(&self.words("G00 ".to_owned(), &rounded));
                self.at = Some(rounded);
                self.feeding = false;
            }
            Step::Retract(z_mm) => {
                let rounded = self.rounded(&Vector3::repeat(*z_mm));
                let words = self.words(String::new(), &rounded);
                let z = words.rsplit(' ').next().unwrap_or_default();
                self.block(&format!("G00 G53 {z}"));
                self.at = None;
            }
            Step::Across(point) => {
                let rounded = self.rounded(&(self.zero_mm + point));
                let words = self.words(String::new(), &rounded);
                let xy = words.rsplit_once(' ').map_or("", |(xy, _)| xy);
                self.block(&format!("G00 G53 {xy}"));
                self.at = None;
            }
            Step::Feed(point, feed_mm_s) => self.feed(point, *feed_mm_s),
            Step::Circular(arc, feed_mm_s) => self.circular(arc, *feed_mm_s),
            Step::Chords(points, feed_mm_s) => {
                for point in points {
                    let rounded = self.rounded(point);
                    // Points that rounding makes one are one.
                    if self.at == Some(rounded) {
                        continue;
                    }
                    let mode = if self.feeding { "" } else { "G01 " };
                    let words = self.words(mode.to_owned(), &rounded);
                    let feed = self.f(*feed_mm_s);
                    self.lines.push(Line::Chord(words + &feed));
                    self.feeding = true;
                    self.at = Some(rounded);
                }
            }
            Step::Dwell(seconds) => {
                let n = self.n();
                self.lines.push(Line::Dwell(n, Seconds(*seconds)));
            }
            Step::Stop(text) => {
                let comment = self.comment(text);
                self.block(&format!("M00 ({comment})"));
            }
            Step::Compare(point) => {
                let place = self.words(String::new(), &self.rounded(point));
                let comment = format!("IN G{} THIS MUST BE {place}", self.work_offset);
                let comment = self.comment(&comment);
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
        if !matches!(step, Step::Chords(..) | Step::Feed(..)) {
            self.feeding = false;
        }
    }
}
