//! Where the points of a table are.

use super::asked::{Limits, SMALLEST_MM};
use crate::compensate::wanted::Wanted;
use crate::error::{Error, Result};
use crate::machine::Axis;

/// Steps that people use, of each decade.
const STEPS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];

/// The smallest such step that is not smaller, mm.
fn usual_mm(step_mm: f64) -> f64 {
    let decade = 10_f64.powf(step_mm.log10().floor());
    let of_decade = STEPS.iter().map(|step| step * decade);
    of_decade.chain([10.0 * decade]).find(|step| *step >= step_mm * (1.0 - 1e-9)).unwrap_or(step_mm)
}

/// The largest such step that is smaller, mm.
fn finer_mm(step_mm: f64) -> f64 {
    let decade = 10_f64.powf((step_mm.log10() - 1e-9).floor());
    let smaller = STEPS.iter().map(|step| step * decade);
    smaller.filter(|step| *step < step_mm * (1.0 - 1e-9)).fold(decade, f64::max)
}

/// So many steps over what was measured follow an error that is smooth.
const ENOUGH: f64 = 20.0;
/// Without a step that was asked for none is smaller, mm.
pub(super) const FINEST_MM: f64 = 1.0;
/// An error is looked at so many times between two points.
const BETWEEN: u32 = 16;

/// Points of a table, each so far from the next.
pub(super) struct Points {
    pub(super) at_mm: Vec<f64>,
    pub(super) step_mm: f64,
    /// The error changes faster than lines from point to point.
    bent: bool,
}

impl Points {
    /// The value at a point: the error there, or, where it changes faster than the points follow, its mean with the weight that a
    /// value has in a line between two points. So a wave that is shorter than the step is left alone: at the points alone it
    /// would be taken for one that is longer.
    pub(super) fn value(&self, of: impl Fn(f64) -> f64, at_mm: f64) -> f64 {
        if !self.bent {
            return of(at_mm);
        }
        let parts = f64::from(BETWEEN);
        let (mut sum, mut weights) = (of(at_mm), 1.0);
        for k in 1..BETWEEN {
            let share = f64::from(k) / parts;
            let aside_mm = share * self.step_mm;
            sum += (1.0 - share) * (of(at_mm - aside_mm) + of(at_mm + aside_mm));
            weights += 2.0 * (1.0 - share);
        }
        sum / weights
    }
}

/// Which errors of a slide points are wanted for.
pub(super) struct Asked<'a> {
    pub(super) wanted: &'a Wanted<'a>,
    pub(super) over: Axis,
    pub(super) along: &'a [Axis],
}

impl Asked<'_> {
    /// Points at multiples of one step over ends of a slide, as many as the errors want and the control has.
    ///
    /// # Errors
    /// When a step that was asked for needs more points than the control has.
    pub(super) fn even(
        &self,
        [low_mm, high_mm]: [f64; 2],
        limits: &Limits,
        lost: &mut Vec<String>,
    ) -> Result<Points> {
        let most = limits.most_points.max(2) as f64;
        let needed = |step_mm: f64| {
            let (first, last) = (first(low_mm, step_mm), last(high_mm, step_mm));
            (last - first + 1.0).max(0.0)
        };
        let mut step_mm = match limits.step_mm {
            Some(step_mm) if needed(step_mm) > most => {
                return Err(Error::input(format!(
                    "points {step_mm} mm apart over {low_mm} to {high_mm} mm of {} are {}, and the control has {most}",
                    self.over,
                    needed(step_mm)
                ))
                .hint("a larger `--step`, or `--points` if your control has more"));
            }
            Some(step_mm) => step_mm,
            None => self.step_mm(|step_mm| needed(step_mm) <= most),
        };
        while needed(step_mm) < 2.0 {
            step_mm *= 0.5;
        }
        let (first, count) = (first(low_mm, step_mm), needed(step_mm) as usize);
        let at_mm = (0..count).map(|k| (first + k as f64) * step_mm).collect();
        Ok(self.points(at_mm, step_mm, lost))
    }

    /// Points that divide what is told of a slide, its ends among them.
    pub(super) fn parts(&self, limits: &Limits, lost: &mut Vec<String>) -> Points {
        let [low, high] = self.wanted.told_mm(self.over);
        let most = limits.most_points.max(2) as f64 - 1.0;
        let parts = |step_mm: f64| ((high - low) / step_mm - 1e-9).ceil().max(1.0);
        let step_mm =
            limits.step_mm.unwrap_or_else(|| self.step_mm(|step_mm| parts(step_mm) <= most));
        let count = parts(step_mm).min(most);
        let at_mm = (0..=count as usize).map(|k| low + (high - low) * k as f64 / count);
        let at_mm: Vec<f64> = at_mm.map(|at| (at * 1e4).round() / 1e4).collect();
        if limits.step_mm.is_some() && parts(step_mm) > count {
            lost.push(format!(
                "the points of {} are {:.3} mm apart, not {step_mm} mm: a table has {} at the most",
                self.over,
                (high - low) / count,
                most + 1.0
            ));
        }
        self.points(at_mm, (high - low) / count, lost)
    }

    /// Points that are so far from each other; what is between them and off a line is told.
    pub(super) fn points(&self, at_mm: Vec<f64>, step_mm: f64, lost: &mut Vec<String>) -> Points {
        let (along, bent_mm) = self.bent_mm(step_mm);
        let bent = bent_mm >= SMALLEST_MM;
        if bent {
            lost.push(format!(
                "too few points for {}: they are {} mm apart, and between them its error along {along} is up to {:.2} um off a straight line; `--points` if your control has more",
                self.over,
                (step_mm * 1e3).round() * 1e-3,
                1e3 * bent_mm
            ));
        }
        Points { at_mm, step_mm, bent }
    }

    /// The step that follows the errors and is possible.
    fn step_mm(&self, possible: impl Fn(f64) -> bool) -> f64 {
        let [low, high] = self.wanted.told_mm(self.over);
        let mut step_mm = usual_mm(((high - low) / ENOUGH).max(FINEST_MM));
        while !possible(step_mm) {
            step_mm = usual_mm(step_mm * 1.01);
        }
        loop {
            let finer_mm = finer_mm(step_mm);
            if finer_mm < FINEST_MM || !possible(finer_mm) || self.bent_mm(step_mm).1 < SMALLEST_MM
            {
                return step_mm;
            }
            step_mm = finer_mm;
        }
    }

    /// Which error is farthest off lines between points so far from each other, and how far, mm.
    fn bent_mm(&self, step_mm: f64) -> (Axis, f64) {
        let [low, high] = self.wanted.told_mm(self.over);
        let mut worst = (self.over, 0.0);
        for along in self.along {
            let of = |at_mm: f64| self.wanted.error_mm(self.over, *along, at_mm, 0.0);
            for k in 0..((high - low) / step_mm).ceil() as u32 {
                let from_mm = low + f64::from(k) * step_mm;
                let (start, end) = (of(from_mm), of(from_mm + step_mm));
                for between in 1..BETWEEN {
                    let share = f64::from(between) / f64::from(BETWEEN);
                    let line = start + share * (end - start);
                    let off_mm = (of(from_mm + share * step_mm) - line).abs();
                    if off_mm > worst.1 {
                        worst = (*along, off_mm);
                    }
                }
            }
        }
        worst
    }
}

/// Which multiple of a step is the first, or the last, within an end.
fn first(low_mm: f64, step_mm: f64) -> f64 {
    (low_mm / step_mm - 1e-9).ceil()
}

fn last(high_mm: f64, step_mm: f64) -> f64 {
    (high_mm / step_mm + 1e-9).floor()
}
