//! The way to the sphere and the way from it: both are safe from wherever the machine stands once the bar is off.

use nalgebra::{UnitVector3, Vector3};

use super::parts::PathPlan;
use super::step::Step;
use super::test_file::Test;
use crate::machine::{Axis, Machine};

/// How far the approach stands off beyond the start of the feed-in, mm.
const STAND_OFF_MM: f64 = 20.0;
/// How far every slide moves, at least, on its way to the start of the feed-in, mm: enough to take up
/// any backlash, so that the sense of every slide is known before the bar engages.
const SENSE_MOVE_MM: f64 = 5.0;
/// Speed near the balls, mm/s: who reacts within a second stops the machine in half of the stand-off.
const APPROACH_MM_S: f64 = 0.5 * STAND_OFF_MM;
/// Z goes down slowly from so far above its place, mm: bars of a set differ by 50 mm, and the wrong one is the
/// usual mistake.
const SLOW_MM: f64 = 50.0;

/// How often a program stops for the bar itself: to be without it, to compare, to fit it, to take it off. Every other stop
/// is one between arcs.
pub const BAR_STOPS: usize = 4;

/// The speed of an approach in a test of a feed, mm/s.
fn approach_mm_s(feed_mm_s: f64) -> f64 {
    feed_mm_s.min(APPROACH_MM_S)
}

/// Where a bar is, around its workpiece ball, and how far Z leads away from it.
pub(super) struct Ways {
    length_mm: f64,
    /// The bar reads up to here, mm from the workpiece ball.
    reach_mm: f64,
    /// Here it is fitted and taken off, mm from the workpiece ball.
    outside_mm: f64,
    /// Z retracts to this machine coordinate, mm.
    retract_mm: f64,
    /// The same above the workpiece ball, mm.
    top_mm: f64,
    settle_s: f64,
    /// Speed near the balls, mm/s.
    approach_mm_s: f64,
}

impl Ways {
    pub(super) fn of(test: &Test, machine: &Machine, plan: &PathPlan, mounting: usize) -> Self {
        let bar = test.bar_of(mounting);
        let retract_mm = machine.slide(Axis::Z).retract_mm;
        Self {
            length_mm: bar.length_mm,
            reach_mm: bar.length_mm + bar.range_mm,
            outside_mm: bar.length_mm + plan.feed_in_mm,
            retract_mm,
            top_mm: retract_mm - test.mountings()[mounting].mounting.coincidence_mm.z,
            settle_s: plan.settle_s,
            approach_mm_s: approach_mm_s(plan.slowest_mm_s()),
        }
    }

    /// The place at the same height from which Z leads up without coming nearer to the workpiece ball than where the
    /// bar is fitted: below the ball, aside.
    fn beside(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let aside = Vector3::new(point.x, point.y, 0.0);
        if point.z >= 0.0 || aside.norm() >= self.reach_mm {
            return *point;
        }
        let direction = aside.try_normalize(1e-6).unwrap_or_else(Vector3::x);
        direction * self.outside_mm + Vector3::z() * point.z
    }

    fn above(&self, point: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(point.x, point.y, self.top_mm)
    }

    /// Retracts, crosses, lets the operator compare, comes down outside of the bar's range with every slide moving,
    /// then feeds in along the radius.
    pub(super) fn engage(&self, start: &UnitVector3<f64>, feed_mm_s: f64) -> Vec<Step> {
        let outside = start.into_inner() * self.outside_mm;
        // Beyond along the radius, and aside wherever the radius alone would not move a slide enough.
        let aside = start.map(|s| {
            let along = STAND_OFF_MM * s;
            if along.abs() >= SENSE_MOVE_MM {
                along
            } else if along > 1e-6 {
                SENSE_MOVE_MM
            } else {
                -SENSE_MOVE_MM
            }
        });
        let beyond = outside + aside;
        let beside = self.beside(&beyond);
        let mut steps = vec![
            Step::Comment("APPROACH".into()),
            Step::Stop("BALL-BAR MUST BE OFF - Z RETRACTS"),
            Step::Retract(self.retract_mm),
            Step::Across(self.above(&beside)),
            Step::Compare(self.above(&beside)),
        ];
        let slow = beside + Vector3::z() * SLOW_MM;
        if slow.z < self.top_mm {
            steps.push(Step::Rapid(slow));
        }
        steps.push(Step::Feed(beside, self.approach_mm_s));
        if beside != beyond {
            steps.push(Step::Feed(beyond, self.approach_mm_s));
        }
        steps.extend([Step::Feed(outside, self.approach_mm_s), Step::Stop("FIT BALL-BAR")]);
        steps.extend(self.feed_in(start, feed_mm_s));
        steps
    }

    fn feed_in(&self, start: &UnitVector3<f64>, feed_mm_s: f64) -> [Step; 3] {
        [
            Step::Dwell(self.settle_s),
            Step::Comment("ENGAGE".into()),
            Step::Feed(start.into_inner() * self.length_mm, feed_mm_s),
        ]
    }

    fn feed_out(&self, end: &UnitVector3<f64>, feed_mm_s: f64) -> [Step; 3] {
        [
            Step::Comment("RELEASE".into()),
            Step::Feed(end.into_inner() * self.outside_mm, feed_mm_s),
            Step::Dwell(self.settle_s),
        ]
    }

    /// Feeds out along the radius, lets the operator see that the bar still is on both balls, and feeds in again.
    pub(super) fn again(&self, at: &UnitVector3<f64>, [out_mm_s, in_mm_s]: [f64; 2]) -> Vec<Step> {
        let mut steps = self.feed_out(at, out_mm_s).to_vec();
        steps.push(Step::Stop("SEE THAT BALL-BAR IS FITTED"));
        steps.extend(self.feed_in(at, in_mm_s));
        steps
    }

    /// Feeds out along the radius, lets the operator take the bar off, and retracts.
    pub(super) fn release(&self, end: &UnitVector3<f64>, feed_mm_s: f64) -> Vec<Step> {
        let outside = end.into_inner() * self.outside_mm;
        let mut steps = self.feed_out(end, feed_mm_s).to_vec();
        steps.push(Step::Stop("TAKE BALL-BAR OFF"));
        let beside = self.beside(&outside);
        if beside != outside {
            steps.push(Step::Feed(beside, self.approach_mm_s));
        }
        if self.top_mm > beside.z {
            steps.push(Step::Rapid(self.above(&beside)));
        }
        steps
    }
}
