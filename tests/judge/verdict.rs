//! The second judge: what a program would do to the bar and the machine, from wherever it is started.
//!
//! # What is dangerous
//!
//! | harm | when |
//! | --- | --- |
//! | too near, bar off | a feed move nearer to the workpiece ball than the shortest bar of the mounting; a positioning nearer than the longest. Neither file states the radii of the balls and sockets: all of them are shorter than the bar that they hold |
//! | crushed | the bar is in, and the balls come nearer than it is short; or the tool ball comes back to a bar that it has released |
//! | stretched | the bar is between the balls, and they part farther than it is long, not along the radius |
//! | dragged | positioning with the bar in |
//! | travel | a point of a move beyond the travel of an axis |
//! | spindle | M03, M04 |
//!
//! Too fast with the bar in is told too, and judged apart: a bar may bear it.
//!
//! On a Fanuc every positioning is taken twice: on a straight line, and with each axis at its own rapid traverse.
//!
//! # From where
//!
//! From many places with the bar off, and once more from where the program itself ended, with the bar as it left it.
//! The first motion may lead along +Z from anywhere: the tool came that way. What a program leaves unstated is tried as
//! somebody may have left it, one group after the other.
//!
//! # What is harmless
//!
//! No control refuses it; nothing comes to harm from any start; nothing depends on what was left in force; and it still
//! is a test: the bar engages, is driven, and is released. Whatever the fault changed beside that (a point that is off by
//! less than the bar reads, a dwell, a feed that is lower) is a matter for warnings.

use std::collections::BTreeSet;

use crate::control::{Driven, Event, Move, drive};
use crate::path::Point;
use crate::power::{PowerOn, Unstated};
use crate::setting::Setting;
use crate::walk::{Bar, Harm, Harmful, Walk};
use crate::words::Refused;

/// Why something comes to harm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum From {
    /// Wherever it is started.
    Anywhere,
    /// From some of the places.
    SomePlace,
    /// Started again from where it ended.
    Again,
    /// Where this was left otherwise.
    Left(Unstated),
}

/// What the judge says.
#[derive(Debug)]
pub(crate) struct Verdict {
    pub(crate) refused: Option<Refused>,
    pub(crate) harms: Vec<(From, Harmful)>,
    /// What the path depends on beside the program.
    pub(crate) depends: BTreeSet<Unstated>,
    /// Whether it still is a test of a ball-bar.
    pub(crate) is_test: bool,
    pub(crate) doubtful: bool,
    /// Where it ends, with what became of the bar.
    pub(crate) end: Option<(Point, Bar)>,
}

impl Verdict {
    /// The first harm that breaks a bar or a machine.
    pub(crate) fn danger(&self) -> Option<(From, Harmful)> {
        self.harms.iter().find(|(_, harmful)| harmful.harm != Harm::TooFast).copied()
    }

    pub(crate) fn too_fast(&self) -> bool {
        self.harms.iter().any(|(_, harmful)| harmful.harm == Harm::TooFast)
    }

    pub(crate) fn is_harmless(&self) -> bool {
        self.refused.is_none()
            && self.harms.is_empty()
            && self.depends.is_empty()
            && self.is_test
            && !self.doubtful
    }
}

/// Judges a program, started at these places and again at its own end.
pub(crate) fn judge(text: &str, setting: &Setting, places: &[Point]) -> Verdict {
    let driven = match drive(text, setting, &PowerOn::default()) {
        Ok(driven) => driven,
        Err(refused) => {
            return Verdict {
                refused: Some(refused),
                harms: Vec::new(),
                depends: BTreeSet::new(),
                is_test: false,
                doubtful: false,
                end: None,
            };
        }
    };
    let mut runs = Runs::new(&driven, setting);
    let mut harms = runs.everywhere(places);
    let first = places.first().copied().unwrap_or(setting.centre_mm);
    let end_mm = std::array::from_fn(|k| {
        driven.end[k].mm + if driven.end[k].of_start { first[k] } else { 0.0 }
    });
    let whole = runs.from(first, Bar::Off);
    let again = runs.from(end_mm, whole.bar);
    let told = |harm: Harm| harms.iter().any(|(_, harmful)| harmful.harm == harm);
    let again: Vec<_> = again.harms.into_iter().filter(|harmful| !told(harmful.harm)).collect();
    harms.extend(again.into_iter().map(|harmful| (From::Again, harmful)));
    for group in &driven.depends {
        let Ok(otherwise) = drive(text, setting, &PowerOn::with(*group)) else { continue };
        let found = Runs::new(&otherwise, setting).everywhere(places);
        harms.extend(found.into_iter().map(|(_, harmful)| (From::Left(*group), harmful)));
    }
    Verdict {
        refused: None,
        harms,
        depends: driven.depends.clone(),
        is_test: whole.measured && whole.released && whole.bar == Bar::Off,
        doubtful: whole.doubtful,
        end: Some((end_mm, whole.bar)),
    }
}

/// Runs of one program from different places: what does not depend on the place is walked once.
struct Runs<'a> {
    setting: &'a Setting,
    /// The events up to the last that depends on the start, and the others.
    opening: &'a [Event],
    rest: &'a [Event],
    walked: Vec<(Bar, Walk<'a>)>,
}

impl<'a> Runs<'a> {
    fn new(driven: &'a Driven, setting: &'a Setting) -> Self {
        let depends = |event: &Event| match event {
            Event::Move(Move { from, to, .. }) => from.iter().chain(to).any(|c| c.of_start),
            _ => false,
        };
        let count = driven.events.iter().rposition(depends).map_or(0, |last| last + 1);
        let (opening, rest) = driven.events.split_at(count);
        Self { setting, opening, rest, walked: Vec::new() }
    }

    /// A whole run.
    fn from(&mut self, start: Point, bar: Bar) -> Walk<'a> {
        let mut walk = Walk::new(self.setting, bar);
        for event in self.opening {
            walk.event(event, start);
        }
        let known = self.walked.iter().position(|(before, _)| *before == walk.bar);
        let index = known.unwrap_or_else(|| {
            let mut rest = Walk::new(self.setting, walk.bar);
            for event in self.rest {
                rest.event(event, start);
            }
            self.walked.push((walk.bar, rest));
            self.walked.len() - 1
        });
        let rest = &self.walked[index].1;
        walk.harms.extend(&rest.harms);
        walk.bar = rest.bar;
        walk.measured |= rest.measured;
        walk.released |= rest.released;
        walk.doubtful |= rest.doubtful;
        walk
    }

    /// What comes to harm from these places with the bar off: from all of them, or from some.
    fn everywhere(&mut self, places: &[Point]) -> Vec<(From, Harmful)> {
        let mut counted: Vec<(usize, Harmful)> = Vec::new();
        for place in places {
            let mut seen = BTreeSet::new();
            for harmful in self.from(*place, Bar::Off).harms {
                if !seen.insert(harmful.harm) {
                    continue;
                }
                match counted.iter_mut().find(|(_, before)| before.harm == harmful.harm) {
                    Some((count, _)) => *count += 1,
                    None => counted.push((1, harmful)),
                }
            }
        }
        let of = |count| if count == places.len() { From::Anywhere } else { From::SomePlace };
        let mut harms: Vec<_> =
            counted.into_iter().map(|(count, harmful)| (of(count), harmful)).collect();
        harms.sort_by_key(|(from, _)| *from);
        harms
    }
}

/// Places of a program at which a reset could stop it: ends of moves, spread over the whole.
pub(crate) fn stations(text: &str, setting: &Setting, power: &PowerOn, count: usize) -> Vec<Point> {
    let Ok(driven) = drive(text, setting, power) else { return Vec::new() };
    let ends: Vec<Point> = driven
        .events
        .iter()
        .filter_map(|event| match event {
            Event::Move(motion) if motion.to.iter().all(|c| !c.of_start) => {
                Some(motion.to.map(|c| c.mm))
            }
            _ => None,
        })
        .collect();
    let step = ends.len().div_ceil(count).max(1);
    ends.into_iter().step_by(step).collect()
}
