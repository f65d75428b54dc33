//! Readings at one limit: cut off, or of a machine that stands.

use nalgebra::Vector3;

use super::*;
use crate::log::Reading;
use crate::model::{Effect, ErrorFunctions};
use crate::simulate::Noise;

/// A machine without errors, read in steps of 1 um with next to no noise, whose workpiece ball stands off in X by so much, mm.
fn off_in_x(off_mm: f64, rate_hz: f64, seed: u64) -> Scenario {
    Scenario {
        workpiece_ball_mm: Vector3::new(off_mm, 0.0, 0.0),
        errors: ErrorFunctions::default(),
        tool_ball_mm: Vector3::zeros(),
        noise: Noise { white_mm: 2e-5, ..Noise::OFF },
        sample_rate_hz: Some(rate_hz),
        resolution_mm: Some(1e-3),
        ..Scenario::default().with_seed(seed)
    }
}

/// The ball stands off towards where the machine dwells between the two ways of the equator: it reads least there, one value
/// in steps of 1 um, for 3 s. Those readings are right, and without them the bar would seem to have been released.
#[test]
fn a_machine_may_stand_at_the_lowest_reading() {
    let bench = Bench::new(ARCS);
    for (seed, rate_hz) in [(1, 50.0), (2, 250.0), (3, 1000.0)] {
        let run = bench.simulated(&off_in_x(0.2997, rate_hz, seed));
        let log = log_of(&run.csv());
        let (_, cut) = clipped(&log).unwrap();
        let standing = |readings: &[Reading]| {
            readings.iter().filter(|reading| reading.deviation_mm == Some(-0.3)).count()
        };
        assert!(standing(&cut) as f64 > 2.9 * rate_hz, "seed {seed}");
        let alignment = bench.aligned(&log).unwrap();
        assert_eq!(standing(&alignment.clipped), 0, "seed {seed}");
        let off = worst_sigmas(&alignment, &run);
        assert!(off < 3.0, "seed {seed}: {off}");
    }
}

/// Friction holds X back where the machine waits for the path to begin, and nowhere else is the reading as low. Without it the
/// bar would seem to be engaged by the path, and a feed of another percent made up for what is missing.
#[test]
fn a_bar_that_is_engaged_at_its_lowest_reading_was_engaged() {
    let bench = Bench::fed(900, "strategy = \"3d6\"\n");
    for (seed, feed_override) in [(1, 1.0), (2, 1.02), (3, 0.97)] {
        let scenario = Scenario {
            hidden: vec![
                Effect::parse("stick-slip:on=X,amplitude_um=-258,speed_mm_min=13").unwrap(),
            ],
            feed_override,
            ..off_in_x(0.045, 50.0, seed)
        };
        let run = bench.simulated(&scenario);
        let alignment = bench.aligned(&log_of(&run.csv())).unwrap();
        let engaged = alignment.marks.iter().find(|mark| mark.kind == MarkKind::Engagement);
        assert!(engaged.unwrap().samples > 0, "seed {seed}");
        // What friction does to the ramp moves it by some hundredths of a second.
        let share = 1.0 + alignment.time_map.override_excess;
        assert!((share / feed_override - 1.0).abs() < 1e-3, "seed {seed}: {share}");
    }
}

/// The bar reads no less than 0.15 mm short, and the arcs begin and end where it is shorter: without those readings it would seem to
/// be engaged by the path. It was engaged all the same, and they tell when.
#[test]
fn a_bar_that_is_cut_off_where_an_arc_begins_was_engaged() {
    let bench = Bench::fed(900, "strategy = \"3d6\"\n");
    for (seed, rate_hz) in [(1, 10.0), (2, 50.0), (3, 250.0)] {
        let run = bench.simulated(&off_in_x(0.2997, rate_hz, seed));
        let within = |line: &str| match line.split_once(',') {
            Some((time, um)) if um.parse::<f64>().is_ok_and(|um| um < -150.0) => {
                format!("{time},-150.0\n")
            }
            _ => format!("{line}\n"),
        };
        let csv: String = run.csv().lines().map(within).collect();
        let alignment = bench.aligned(&log_of(&csv)).unwrap();
        let lowest = |readings: &[Reading]| {
            readings.iter().filter(|reading| reading.deviation_mm == Some(-0.15)).count()
        };
        assert_eq!(lowest(&alignment.clipped), lowest(log_of(&csv).readings()), "seed {seed}");
        let off = worst_sigmas(&alignment, &run);
        assert!(off < 3.0, "seed {seed}: {off}");
    }
}
