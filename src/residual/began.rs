//! When the program of each run began, as far as an operator's pause hides it.
//!
//! A drift of a run whose program began by `d` earlier than its log tells is there
//!
//! ```text
//! A (1 - exp(-(t + d) / T))
//! ```
//!
//! Runs that have their set-up errors in common tell `d`: a drift of 1 um in a second that began five seconds earlier has moved the
//! ball by 5 um more when the plane is driven, which otherwise is a ball that was knocked, and bends `T`. So each run has its
//! `d` beside the amplitude and the time constant that all have in common, held to what its pause leaves open of it
//! (`began_sigma_s`).

use super::beside::Beside;
use super::column::Column;
use super::element::{Earlier, Element};
use super::noise::Noise;
use super::residuals::{Repeat, Residuals, Run};
use super::system::System;

/// Where all beginnings together explain less than this share of what chance gives an amplitude they stay as they are.
const OF_CHANCE: f64 = 0.1;
/// A beginning that is known is so to this, s.
const KNOWN_S: f64 = 1e-3;
/// Of a run in whose plane the ball does not move no beginning is told: its part of what all see is less than this.
const NEXT_TO_NOTHING: f64 = 1e-9;
/// The derivative is taken over this part of the time constant.
const STEP: f64 = 1e-4;
/// No step is longer than this part of the time constant.
const LONGEST: f64 = 0.3;

/// The beginning of one run, for one element.
pub(super) struct Beginning {
    element: usize,
    repeat: usize,
    run: usize,
    /// `d` as it is, s.
    at_s: f64,
    longest_s: f64,
    /// What is plausible of `d`: its square weighs so much, mm²/s².
    pub(super) weight: f64,
    /// What a second of `d` adds to the samples, mm/s.
    pub(super) column: Column,
}

impl Beginning {
    /// What is plausible adds this to the right-hand side for the step of `d`, mm²/s.
    pub(super) fn pull(&self) -> f64 {
        -self.weight * self.at_s
    }
}

/// The beginnings of all runs.
pub(super) struct Began<'a> {
    residuals: &'a Residuals,
    beside: &'a Beside<'a>,
    /// Which repeats take part.
    repeats: &'a [bool],
    /// Whether there are runs to be compared, and pauses that hide when they began.
    hidden: bool,
    /// What chance gives an amplitude by what the first fit leaves, mm²: what is plausible of a beginning is weighed by it.
    chance_mm2: Option<f64>,
}

impl<'a> Began<'a> {
    pub(super) fn new(beside: &'a Beside<'a>, repeats: &'a [bool]) -> Self {
        let residuals = beside.residuals;
        let mut began = Self { residuals, beside, repeats, hidden: false, chance_mm2: None };
        let hides = |(repeat, run)| began.run(repeat, run).began_sigma_s > KNOWN_S;
        began.hidden = began.runs().count() > 1 && began.runs().any(hides);
        began
    }

    /// The runs that take part: repeat and run.
    fn runs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.residuals.runs().filter(|(repeat, _)| self.repeats[*repeat])
    }

    /// What the beginnings of elements cost that are fitted with these amplitudes, whose columns come first in a system, mm².
    pub(super) fn cost_mm2(
        &mut self,
        elements: &[Element],
        amplitudes: &[Vec<f64>],
        system: &System,
    ) -> f64 {
        if !elements.iter().any(|element| element.earlier.tells()) {
            return 0.0;
        }
        let chance_mm2 = self.chance_mm2(amplitudes, system);
        let of_element = |element: &Element| -> f64 {
            let of_run = |(repeat, run): (usize, usize)| {
                let earlier_s = element.earlier.in_s(repeat, run);
                weight(chance_mm2, self.run(repeat, run)) * earlier_s * earlier_s
            };
            self.runs().map(of_run).sum()
        };
        elements.iter().filter(|element| element.earlier.tells()).map(of_element).sum()
    }

    /// Those that matter to elements with these amplitudes, whose columns come first in a system.
    pub(super) fn beginnings(
        &mut self,
        elements: &[Element],
        amplitudes: &[Vec<f64>],
        system: &System,
    ) -> Vec<Beginning> {
        let mut found = Vec::new();
        let mut first = 0;
        for (index, (element, own)) in elements.iter().zip(amplitudes).enumerate() {
            if let Some(constant_s) = element.time_constant_s().filter(|_| self.hidden) {
                let chance_mm2 = self.chance_mm2(amplitudes, system);
                let step_s = STEP * constant_s;
                let mut rate = self.all_earlier(element, step_s).columns(self.residuals).remove(0);
                rate.add(-1.0, &system.columns[first]);
                let out = rate.iter_mut().zip(self.repeats).filter(|(_, takes_part)| !**takes_part);
                out.for_each(|(of_repeat, _)| of_repeat.clear());
                let rate = rate.times(own[0] / step_s);
                let seen = NEXT_TO_NOTHING * rate.square();
                let of_run =
                    |place| self.of_run(index, element, place, constant_s, &rate, chance_mm2);
                let of_runs = self.runs().map(of_run).filter(|of| of.column.square() > seen);
                let of_runs: Vec<Beginning> = of_runs.collect();
                let explain: f64 = of_runs.iter().map(|of| of.column.square() / of.weight).sum();
                if element.earlier.tells() || explain > OF_CHANCE {
                    found.extend(of_runs);
                }
            }
            first += own.len();
        }
        found
    }

    /// The beginning of one run for an element of which a second earlier adds so much to all samples.
    fn of_run(
        &self,
        index: usize,
        element: &Element,
        (repeat, run): (usize, usize),
        constant_s: f64,
        rate: &Column,
        chance_mm2: f64,
    ) -> Beginning {
        let of = self.run(repeat, run);
        let mut own = vec![0.0; rate[repeat].len()];
        own[of.samples.clone()].copy_from_slice(&rate[repeat][of.samples.clone()]);
        let mut column = Column::empty(rate.len());
        column[repeat] = own;
        let at_s = element.earlier.in_s(repeat, run);
        let (longest_s, weight) = (LONGEST * constant_s, weight(chance_mm2, of));
        Beginning { element: index, repeat, run, at_s, longest_s, weight, column }
    }

    /// Elements whose runs began one step on.
    pub(super) fn stepped(
        &self,
        mut elements: Vec<Element>,
        beginnings: &[Beginning],
        steps: &[f64],
        shorter: f64,
    ) -> Vec<Element> {
        for (index, element) in elements.iter_mut().enumerate() {
            let own = beginnings.iter().zip(steps).filter(|(of, _)| of.element == index);
            let now_s = own.map(|(of, step_s)| {
                let step_s = (shorter * step_s).clamp(-of.longest_s, of.longest_s);
                (of, of.at_s + step_s)
            });
            let now_s: Vec<(&Beginning, f64)> = now_s.collect();
            if now_s.is_empty() {
                continue;
            }
            // That all began earlier is another amplitude and another set-up: of that what is plausible decides, and at once, as
            // steps along it bend. What takes no part keeps its place among the others.
            let weights: f64 = now_s.iter().map(|(of, _)| of.weight).sum();
            let mean_s = now_s.iter().map(|(of, now_s)| of.weight * now_s).sum::<f64>() / weights;
            let was_s = now_s.iter().map(|(of, _)| of.weight * of.at_s).sum::<f64>() / weights;
            element.earlier = self.each(|repeat, run| {
                let told = now_s.iter().find(|(of, _)| (of.repeat, of.run) == (repeat, run));
                match told {
                    Some((_, now_s)) => now_s - mean_s,
                    None if self.repeats[repeat] => 0.0,
                    None => element.earlier.in_s(repeat, run) - was_s,
                }
            });
        }
        elements
    }

    /// Half the way from one to another.
    pub(super) fn half_way(&self, one: &Earlier, other: &Earlier) -> Earlier {
        if !one.tells() && !other.tells() {
            return Earlier::default();
        }
        self.each(|repeat, run| 0.5 * (one.in_s(repeat, run) + other.in_s(repeat, run)))
    }

    /// An element all of whose runs began earlier by so much.
    fn all_earlier(&self, element: &Element, by_s: f64) -> Element {
        let earlier = self.each(|repeat, run| element.earlier.in_s(repeat, run) + by_s);
        Element { earlier, ..element.clone() }
    }

    fn each(&self, of_run: impl Fn(usize, usize) -> f64) -> Earlier {
        let repeats = self.residuals.repeats.iter().enumerate();
        let runs = |(repeat, of): (usize, &Repeat)| {
            (0..of.runs.len()).map(|run| of_run(repeat, run)).collect()
        };
        Earlier::of(repeats.map(runs).collect())
    }

    /// What chance gives an amplitude in the repeats that take part, by what the first fit leaves that somebody asks of.
    fn chance_mm2(&mut self, amplitudes: &[Vec<f64>], system: &System) -> f64 {
        if let Some(chance_mm2) = self.chance_mm2 {
            return chance_mm2;
        }
        let mut sum = self.residuals.zeros();
        for (amplitude, column) in amplitudes.iter().flatten().zip(&system.columns) {
            sum.add(*amplitude, column);
        }
        let mut left_mm = self.beside.left_mm.clone();
        left_mm.add(-1.0, &self.beside.outside(&sum));
        let (mut all, mut taking) = (0, 0);
        for (of_repeat, takes_part) in left_mm.iter_mut().zip(self.repeats) {
            all += of_repeat.len();
            if *takes_part {
                taking += of_repeat.len();
            } else {
                of_repeat.fill(0.0);
            }
        }
        let of_all_mm2 = Noise::of(self.residuals, &left_mm).long_run_mm2;
        let chance_mm2 = of_all_mm2 * all as f64 / taking.max(1) as f64;
        self.chance_mm2 = Some(chance_mm2);
        chance_mm2
    }

    fn run(&self, repeat: usize, run: usize) -> &Run {
        &self.residuals.repeats[repeat].runs[run]
    }
}

/// What is plausible of when a run began weighs so much beside the sum of squares, mm²/s².
fn weight(chance_mm2: f64, run: &Run) -> f64 {
    chance_mm2 / run.began_sigma_s.max(KNOWN_S).powi(2)
}
