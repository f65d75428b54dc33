//! From the steps of a path to the lines of a program: numbers, words, what is in force.

use nalgebra::Vector3;

use super::comment;
use crate::machine::Controller;
use crate::plan::{Circular, Plane, Step};

/// A program before it is put into the words of a dialect, line by line; `N` numbers include their blank.
pub(super) enum Line {
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
pub(super) struct Seconds(f64);

impl Seconds {
    /// In whole milliseconds, as a Fanuc counts.
    pub(super) fn milliseconds(&self) -> String {
        format!("{:.0}", self.0 * 1000.0)
    }

    /// In seconds, as LinuxCNC counts.
    pub(super) fn decimal(&self) -> String {
        format!("{:.3}", self.0)
    }
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

/// The lines of a program while they come about.
pub(super) struct Writer<'a> {
    pub(super) controller: &'a Controller,
    pub(super) lines: Vec<Line>,
    pub(super) subprograms: Vec<Line>,
    /// The number of the next subprogram, if arcs are subprograms.
    pub(super) next: Option<u32>,
    pub(super) sequence: u32,
    /// The last position, in units of the last decimal.
    pub(super) at: Option<[i64; 3]>,
    /// Machine coordinates of the zero of the work offset, mm.
    pub(super) zero_mm: Vector3<f64>,
    pub(super) work_offset: u8,
    pub(super) feeding: bool,
    /// The last F.
    pub(super) feed_in_force: String,
}

impl Writer<'_> {
    /// The number of the next block with its blank, or nothing.
    pub(super) fn n(&mut self) -> String {
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

    pub(super) fn block(&mut self, words: &str) {
        let n = self.n();
        self.lines.push(Line::Block(n, words.to_owned()));
    }

    /// All steps; an arc from its comment to the end of its look-ahead may go into a subprogram.
    pub(super) fn steps(&mut self, steps: &[Step]) {
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

    pub(super) fn comment(&self, text: &str) -> String {
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
