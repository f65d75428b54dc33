//! Follows the bar through what a program does: who has it, how long it would have to be, and what comes to harm.

use crate::bodies::Near;
use crate::control::{Event, Move};
use crate::path::{Point, distance_mm, dog_leg, dot, minus, points_of, reach_mm};
use crate::setting::Setting;

/// Where the bar is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bar {
    Off,
    /// The operator has put it in, and it does not reach both balls yet.
    Fitted,
    /// It holds both balls.
    Engaged,
    /// It was pulled off one ball along the radius and hangs on the other.
    Loose,
}

/// What comes to harm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Harm {
    /// The bar is off, and the tool ball comes too near to the workpiece ball.
    TooNear,
    /// The bar is pressed shorter than it can be, or the tool ball runs into one that hangs loose.
    Crushed,
    /// The bar is pulled longer than it can be, and not along the radius.
    Stretched,
    /// A positioning takes the bar along that it was engaged with.
    Dragged,
    Travel,
    /// Tool or spindle nose against the support of the workpiece ball.
    Touching,
    Spindle,
    /// Faster than the test with the bar between the balls: the bar may bear it. Judged apart.
    TooFast,
}

/// A harm, where it happens, and the distance of the balls or the coordinate that makes it one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Harmful {
    pub(crate) harm: Harm,
    pub(crate) line: usize,
    pub(crate) mm: f64,
}

/// Rounding of coordinates, mm.
const ROUNDING_MM: f64 = 1e-6;
/// A bar can be put in where the balls are no farther apart than it is long and this, mm.
const FIT_MM: f64 = 50.0;
/// The bar comes off along the radius up to the first angle, rad, and surely not from the second on: 4 and 8 degrees.
const RADIAL_RAD: f64 = 0.07;
const ASIDE_RAD: f64 = 0.14;
/// Feeds are rounded to so much, as a share.
const SAME_FEED: f64 = 1e-3;

/// What has happened so far.
#[derive(Debug, Clone)]
pub(crate) struct Walk<'a> {
    setting: &'a Setting,
    pub(crate) bar: Bar,
    pub(crate) harms: Vec<Harmful>,
    /// It came off at an angle of which two would say different things; the operator was asked to fit it where he cannot;
    /// a positioning went away from it when it stood in one socket; a feed move went where it reads before it was fitted,
    /// or after it was taken off; or a feed move came from nobody knows where.
    pub(crate) doubtful: bool,
    /// The bar was engaged along a move.
    pub(crate) measured: bool,
    pub(crate) released: bool,
    /// Where the tool ball is, mm.
    at_mm: Point,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(setting: &'a Setting, bar: Bar) -> Self {
        Self {
            setting,
            bar,
            harms: Vec::new(),
            doubtful: false,
            measured: false,
            released: false,
            at_mm: setting.centre_mm,
        }
    }

    /// One event of a program that was started at a place.
    pub(crate) fn event(&mut self, event: &Event, start: Point) {
        match event {
            Event::Move(motion) => self.moves(motion, start),
            Event::Spindle(line) => self.harm(Harm::Spindle, *line, 0.0),
            Event::Stop(told) if told.contains("FIT") => self.fit(),
            Event::Stop(told) if told.contains("OFF") => self.bar = Bar::Off,
            Event::Stop(_) => {}
        }
    }

    fn harm(&mut self, harm: Harm, line: usize, mm: f64) {
        if self.harms.iter().all(|harmful| harmful.harm != harm) {
            self.harms.push(Harmful { harm, line, mm });
        }
    }

    fn fit(&mut self) {
        let distance_mm = distance_mm(self.at_mm, self.setting.centre_mm);
        // One that hangs loose is put back.
        if !matches!(self.bar, Bar::Off | Bar::Loose) {
            return;
        }
        if distance_mm > self.setting.longest_mm() + FIT_MM
            || distance_mm < self.setting.shortest_mm()
        {
            self.doubtful = true;
        } else if distance_mm <= self.setting.longest_mm() {
            self.bar = Bar::Engaged;
        } else {
            self.bar = Bar::Fitted;
        }
    }

    fn moves(&mut self, motion: &Move, start: Point) {
        let place = |coordinates: [crate::control::Coordinate; 3]| -> Point {
            std::array::from_fn(|k| {
                coordinates[k].mm + if coordinates[k].of_start { start[k] } else { 0.0 }
            })
        };
        let (from, to) = (place(motion.from), place(motion.to));
        self.at_mm = to;
        let corners = match (&motion.turn, motion.rapid) {
            (Some(turn), _) => points_of(turn, from, to),
            (None, true) => dog_leg(from, to, self.setting.rapid_mm_s),
            (None, false) => vec![from, to],
        };
        self.travel(motion, &corners[1..]);
        let centre_mm = self.setting.centre_mm;
        // Where the tool could come to, it can go back from: it came along +Z.
        let back = motion.rapid
            && motion.from[2].of_start
            && to[2] > from[2]
            && motion.from[..2] == motion.to[..2]
            && self.bar == Bar::Off;
        if !back {
            self.bodies(motion, &corners, [from, to]);
        }
        let (mut least_mm, most_mm) = reach_mm(&corners, centre_mm);
        if motion.rapid {
            let straight_mm = reach_mm(&[from, to], centre_mm).0;
            least_mm = if self.setting.bends() { least_mm.min(straight_mm) } else { straight_mm };
            if !back {
                self.positions(motion.line, least_mm);
            }
            return;
        }
        self.doubtful |= motion.from.iter().any(|coordinate| coordinate.of_start);
        self.feeds(motion, from, to, (least_mm, most_mm));
    }

    fn travel(&mut self, motion: &Move, corners: &[Point]) {
        for corner in corners {
            for (axis, [low, high]) in self.setting.travel_mm.into_iter().enumerate() {
                if corner[axis] < low - ROUNDING_MM || corner[axis] > high + ROUNDING_MM {
                    self.harm(Harm::Travel, motion.line, corner[axis]);
                }
            }
        }
    }

    /// What stands behind the balls; a positioning also on a straight line.
    fn bodies(&mut self, motion: &Move, corners: &[Point], straight: [Point; 2]) {
        let Some(bodies) = &self.setting.bodies else { return };
        let centre_mm = self.setting.centre_mm;
        let mut near = bodies.along(corners, centre_mm);
        if motion.rapid && !self.setting.bends() {
            near = bodies.along(&straight, centre_mm);
        } else if motion.rapid {
            near = near.max(bodies.along(&straight, centre_mm));
        }
        self.doubtful |= near == Near::Doubtful;
        if near == Near::Overlap {
            self.harm(Harm::Touching, motion.line, distance_mm(straight[1], centre_mm));
        }
    }

    fn positions(&mut self, line: usize, least_mm: f64) {
        // A bar that stands in one socket stays there, or hangs on the tool: nobody knows.
        self.doubtful |= self.bar == Bar::Fitted;
        if matches!(self.bar, Bar::Engaged | Bar::Loose) {
            self.harm(Harm::Dragged, line, least_mm);
        } else if least_mm <= self.setting.longest_mm() {
            self.harm(Harm::TooNear, line, least_mm);
        }
    }

    fn feeds(&mut self, motion: &Move, from: Point, to: Point, (least_mm, most_mm): (f64, f64)) {
        let (shortest_mm, longest_mm) = (self.setting.shortest_mm(), self.setting.longest_mm());
        let end_mm = distance_mm(to, self.setting.centre_mm);
        let presses = least_mm < shortest_mm - ROUNDING_MM;
        let leaves = end_mm > longest_mm + ROUNDING_MM;
        let before = self.bar;
        match before {
            Bar::Off if presses => self.harm(Harm::TooNear, motion.line, least_mm),
            // That the bar is off here stands in a comment only.
            Bar::Off => self.doubtful |= least_mm <= longest_mm,
            _ if presses => self.harm(Harm::Crushed, motion.line, least_mm),
            Bar::Fitted if !leaves => self.bar = Bar::Engaged,
            Bar::Fitted if least_mm < longest_mm => self.harm(Harm::Stretched, motion.line, end_mm),
            Bar::Engaged if leaves => self.leaves(motion, from, to, end_mm),
            Bar::Engaged if most_mm > longest_mm + ROUNDING_MM => {
                self.harm(Harm::Stretched, motion.line, most_mm);
            }
            Bar::Engaged => self.measured = true,
            Bar::Loose if least_mm < longest_mm => self.harm(Harm::Crushed, motion.line, least_mm),
            Bar::Fitted | Bar::Loose => {}
        }
        let between = before == Bar::Engaged || self.bar == Bar::Engaged;
        if between && motion.feed_mm_s > self.setting.feed_mm_s * (1.0 + SAME_FEED) {
            self.harm(Harm::TooFast, motion.line, motion.feed_mm_s);
        }
    }

    /// Out of the range, to the outside.
    fn leaves(&mut self, motion: &Move, from: Point, to: Point, end_mm: f64) {
        let (radius, along) = (minus(from, self.setting.centre_mm), minus(to, from));
        let cosine = dot(radius, along) / (dot(radius, radius) * dot(along, along)).sqrt();
        let aside_rad = if motion.turn.is_some() { 1.0 } else { cosine.clamp(-1.0, 1.0).acos() };
        if aside_rad > ASIDE_RAD {
            self.harm(Harm::Stretched, motion.line, end_mm);
        }
        self.doubtful |= aside_rad > RADIAL_RAD;
        self.bar = Bar::Loose;
        self.released = true;
    }
}
