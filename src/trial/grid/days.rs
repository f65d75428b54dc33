//! The machine and the days of a campaign of the grid.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::factors::{Driving, Factors};
use crate::simulate::{Control, Scenario};
use crate::trial::chance::Chance;
use crate::trial::course::{Course, CourseRun};
use crate::trial::days::{CLOCK_PPM, START_S};

/// Share by which all that turns with the sense varies from repeat to repeat.
const REVERSALS: f64 = 0.03;
/// Standard deviation of the place of the tool ball between repeats, mm.
const SET_UP_MM: f64 = 0.02;

/// The scenario of every run, without anything hidden.
pub(super) fn days(course: &Course, factors: &Factors, chance: &mut Chance) -> Vec<Scenario> {
    let mut machine = Scenario::perfect().with_seed(chance.seed());
    machine.noise = factors.noise;
    machine.control = control(&factors.driving);
    machine.feed_override = factors.feed_override;
    let mountings: Vec<_> = course.test.mountings().iter().map(|m| m.mounting).collect();
    machine.draw_machine(&course.machine, &mountings, factors.bar_mm);
    let (mut repeats, mut set_ups) = (BTreeMap::new(), BTreeMap::new());
    let mut day = |(index, run): (usize, &CourseRun)| {
        let mut scenario = machine.clone().with_seed(chance.seed());
        scenario.run_number = index as u32 + 1;
        scenario.mounting_number = run.mounting as u32 + 1;
        let place = repeats.entry(run.repeat).or_insert_with(|| {
            let mut place = machine.place.clone();
            if let Some(place) = &mut place {
                place.vary_reversals(REVERSALS, || chance.normal());
            }
            place
        });
        scenario.place.clone_from(place);
        scenario.tool_ball_mm += *set_ups
            .entry((run.repeat, run.mounting))
            .or_insert_with(|| SET_UP_MM * Vector3::from_fn(|_, _| chance.normal()));
        scenario.clock_ppm = chance.between(CLOCK_PPM);
        scenario.start_s = chance.between(START_S);
        scenario.sample_rate_hz = run.sample_rate_hz;
        scenario
    };
    course.runs.iter().enumerate().map(&mut day).collect()
}

fn control(driving: &Driving) -> Control {
    let mut control = Control::AS_PLANNED;
    match *driving {
        Driving::Planned => {}
        Driving::Bell(change_s) => control.acceleration_change_s = Some(change_s),
        Driving::Acceleration(factor) => control.acceleration = factor,
        Driving::Standing(most_s) => control.standing_s = [0.0, most_s],
        Driving::FollowingAlike(s) => control.following_s = Vector3::repeat(s),
        Driving::FollowingUnlike(common_s, axis, other_s) => {
            control.following_s = Vector3::repeat(common_s);
            control.following_s[axis] = other_s;
        }
    }
    control
}
