//! From the steps of a path to the lines of a program: numbers, words, what is in force.

use nalgebra::Vector3;

use super::comment;
use super::spelling::{Centre, Spelling};
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
    /// The program waits for the operator, with what he is asked to do.
    Stop(String, String),
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

    /// In seconds, as the others count.
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
    pub(super) spelling: &'static Spelling,
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
        self.axes(&mut text, &[0, 1, 2], rounded);
        text
    }

    /// Words of some axes behind what is there, blanks between them.
    fn axes(&self, text: &mut String, axes: &[usize], rounded: &[i64; 3]) {
        for (index, &axis) in axes.iter().enumerate() {
            text.push_str(if index > 0 { [" X", " Y", " Z"][axis] } else { ["X", "Y", "Z"][axis] });
            self.decimal(text, rounded[axis]);
        }
    }

    /// A number in units of the last decimal behind what is there; zero has no minus.
    fn decimal(&self, text: &mut String, value: i64) {
        if value < 0 {
            text.push('-');
        } else if self.spelling.plus {
            text.push('+');
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

    /// A positioning of some axes.
    fn around(&mut self, [before, behind]: [&str; 2], axes: &[usize], rounded: &[i64; 3]) {
        let mut words = before.to_owned();
        self.axes(&mut words, axes, rounded);
        self.block(&(words + behind));
    }

    /// A straight move, with F where another is in force.
    fn feed(&mut self, point: &Vector3<f64>, feed_mm_s: f64) {
        let rounded = self.rounded(point);
        let [before, behind] = self.spelling.line;
        let words = self.words(before.to_owned(), &rounded);
        let feed = self.f(feed_mm_s);
        self.block(&(words + behind + &feed));
        (self.at, self.feeding) = (Some(rounded), true);
    }

    /// The F word with its blank where another one is in force.
    fn f(&mut self, feed_mm_s: f64) -> String {
        let mut feed = number(feed_mm_s * 60.0);
        if !self.spelling.point && feed.ends_with('.') {
            feed.pop();
        }
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
        // X before Y before Z, as everywhere.
        let mut letters = axes;
        letters.sort_unstable();
        let sense = self.spelling.arc[usize::from(arc.sweep_rad > 0.0)];
        let mut words;
        if self.spelling.centre == Centre::Pole {
            let mut pole = "CC ".to_owned();
            self.axes(&mut pole, &letters, &[0; 3]);
            self.block(&pole);
            words = "C ".to_owned();
            self.axes(&mut words, &letters, &to);
            words = words + " " + sense + " R0";
        } else {
            words = format!("{} {sense} ", plane_word(arc.plane));
            self.axes(&mut words, &letters, &to);
            for axis in letters {
                words += [" I", " J", " K"][axis];
                self.decimal(&mut words, -from[axis]);
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
                self.around(self.spelling.rapid, &[0, 1, 2], &rounded);
                self.at = Some(rounded);
                self.feeding = false;
            }
            Step::Retract(z_mm) => {
                let rounded = self.rounded(&Vector3::repeat(*z_mm));
                self.around(self.spelling.machine_rapid, &[2], &rounded);
                self.at = None;
            }
            Step::Across(point) => {
                let rounded = self.rounded(&(self.zero_mm + point));
                self.around(self.spelling.machine_rapid, &[0, 1], &rounded);
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
                    let [before, behind] =
                        if self.feeding { [self.spelling.chord, ""] } else { self.spelling.line };
                    let words = self.words(before.to_owned(), &rounded);
                    let feed = self.f(*feed_mm_s);
                    self.lines.push(Line::Chord(words + behind + &feed));
                    self.feeding = true;
                    self.at = Some(rounded);
                }
            }
            Step::Dwell(seconds) => {
                let n = self.n();
                self.lines.push(Line::Dwell(n, Seconds(*seconds)));
            }
            Step::Stop(text) => {
                let line = Line::Stop(self.n(), self.comment(text));
                self.lines.push(line);
            }
            Step::Compare(point) => {
                let place = self.words(String::new(), &self.rounded(point));
                let zero = self.spelling.zero(self.work_offset);
                let comment = self.comment(&format!("IN {zero} THIS MUST BE {place}"));
                let line = Line::Stop(self.n(), comment);
                self.lines.push(line);
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
