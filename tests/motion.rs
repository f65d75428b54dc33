//! Times and speeds of short programs against what can be worked out by hand.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fmt::Write as _;

use ballbar::log::Recording;
use ballbar::machine::Machine;
use ballbar::motion::{BlockKind, Reversals, Times, Trajectory};
use ballbar::nc::{self, Reading};
use nalgebra::Vector3;

/// A machine with 500 mm/s² along the path and further keys of its X axis and its control.
fn machine(axis_x: &str, controller: &str) -> Machine {
    let axis = |name: &str, keys: &str| {
        format!(
            "[axes.{name}]\ntravel_mm = [-500.0, 500.0]\nrapid_mm_min = 12000.0\n\
             acceleration_mm_s2 = 500.0\n{keys}\n"
        )
    };
    let text = format!(
        "name = \"M\"\ntopology = \"wFXYZt\"\n{}{}{}[controller]\n{controller}\n",
        axis("X", axis_x),
        axis("Y", ""),
        axis("Z", "")
    );
    Machine::parse(&text, "m.toml".as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn driven(machine: &Machine, blocks: &str) -> Trajectory {
    let mut reading = Reading::of(machine);
    reading.work_offsets_mm.insert(54, Vector3::zeros());
    let source = format!("G90 G00 X0. Y0. Z0.\n{blocks}\nM30\n");
    Trajectory::new(&nc::read(&source, "p.nc".as_ref(), &reading).unwrap(), machine, 1.0)
}

fn fastest_mm_s(trajectory: &Trajectory) -> f64 {
    let steps = 20_000;
    let at = |k| trajectory.at(trajectory.end_s() * f64::from(k) / f64::from(steps));
    (0..=steps).map(|k| at(k).velocity_mm_s.norm()).fold(0.0, f64::max)
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6 * expected, "{found} is not {expected}");
}

/// From rest to rest over a length.
fn trapezoid_s(length_mm: f64, speed_mm_s: f64, acceleration_mm_s2: f64) -> f64 {
    length_mm / speed_mm_s + speed_mm_s / acceleration_mm_s2
}

const DIAGONAL: &str = "G01 X30. Y40. F1200.";

#[test]
fn the_slowest_axis_limits_the_feed_along_the_path() {
    assert_near(driven(&machine("", ""), DIAGONAL).end_s(), trapezoid_s(50.0, 20.0, 500.0));
    // X makes 0.6 of the way: 6 mm/s of X are 10 mm/s of the path.
    let slow = machine("max_feed_mm_min = 360.0", "");
    assert_near(driven(&slow, DIAGONAL).end_s(), trapezoid_s(50.0, 10.0, 500.0));
    assert_near(driven(&slow, "G01 Y50. F1200.").end_s(), trapezoid_s(50.0, 20.0, 500.0));
}

#[test]
fn the_weakest_axis_limits_the_acceleration_along_the_path() {
    let weak = machine("feed_acceleration_mm_s2 = 60.0", "");
    assert_near(driven(&weak, DIAGONAL).end_s(), trapezoid_s(50.0, 20.0, 100.0));
    // Along Y only the acceleration of the path counts.
    assert_near(driven(&weak, "G01 Y50. F1200.").end_s(), trapezoid_s(50.0, 20.0, 500.0));
    // On an arc of 10 mm, v² / r is the acceleration across.
    let arc = driven(&weak, "G01 X0. Y-10. F6000.\nG03 X10. Y0. I0. J10.");
    let inside = arc.blocks().last().unwrap();
    let speeds = (1..100).map(|k| {
        let time_s = inside.start_s + inside.duration_s * f64::from(k) / 100.0;
        arc.at(time_s).velocity_mm_s.norm()
    });
    let fastest = speeds.fold(0.0, f64::max);
    assert!(fastest <= 600_f64.sqrt() + 1e-9, "{fastest}");
}

#[test]
fn a_corner_is_taken_so_fast_that_no_axis_jumps_by_more_than_its_step() {
    for (corner_deg, jump) in [(90.0_f64, 1.0), (20.0, 20_f64.to_radians().sin())] {
        let keys = "corner_speed_step_mm_min = 120.0\ncorner_stop_deg = 180.0";
        let (sine, cosine) = corner_deg.to_radians().sin_cos();
        let (x, y) = (50.0 + 50.0 * cosine, 50.0 * sine);
        let blocks = format!("G01 X50. F1200.\nX{x:.6} Y{y:.6}");
        let trajectory = driven(&machine("", keys), &blocks);
        let corner = &trajectory.blocks()[1];
        let speed = trajectory.at(corner.start_s + 1e-9).velocity_mm_s.norm();
        assert!((speed - 2.0 / jump).abs() < 1e-4, "{speed} at {corner_deg} degrees");
    }
    // Without the key, 20 degrees cost nothing and 90 are a stop.
    let straight = driven(&machine("", ""), "G01 X50. F1200.\nX96.984631 Y17.101007");
    assert!((straight.end_s() - trapezoid_s(100.0, 20.0, 500.0)).abs() < 1e-6);
    let stop = driven(&machine("", ""), "G01 X50. F1200.\nY50.");
    assert_near(stop.end_s(), 2.0 * trapezoid_s(50.0, 20.0, 500.0));
}

#[test]
fn a_rounded_corner_is_driven_with_the_acceleration_of_the_path_across_it() {
    let machine = machine("", "corner_tolerance_um = 10.0\ncorner_stop_deg = 180.0");
    let trajectory = driven(&machine, "G01 X50. F1200.\nY50.");
    let corner = &trajectory.blocks()[1];
    let speed = trajectory.at(corner.start_s + 1e-9).velocity_mm_s.norm();
    // An arc of 90 degrees that stays within 0.01 mm of its corner has a radius of 0.024142 mm.
    assert!((speed - (500.0_f64 * 0.024_142_136).sqrt()).abs() < 1e-4, "{speed}");
}

#[test]
fn short_blocks_last_the_block_time() {
    let blocks: Vec<String> =
        (1..=100).map(|k| format!("G01 X{:.1} F1200.", f64::from(k) * 0.1)).collect();
    let blocks = blocks.join("\n");
    let quick = driven(&machine("", ""), &blocks);
    assert_near(fastest_mm_s(&quick), 20.0);
    let slow = driven(&machine("", "block_time_ms = 20.0"), &blocks);
    assert_near(fastest_mm_s(&slow), 5.0);
    assert_near(slow.end_s(), trapezoid_s(10.0, 5.0, 500.0));
}

#[test]
fn bell_shaped_acceleration_adds_its_time_to_every_stretch_and_nothing_else() {
    let blocks = "G01 X20. F1200.\nX40.\nG04 P1000\nY20.\nG61 Y10.\nY0.";
    let plain = driven(&machine("", ""), blocks);
    let bell = driven(&machine("", "acceleration_change_ms = 40.0"), blocks);
    // Four stretches from rest to rest: two blocks as one, and three that end with a stop.
    assert!((bell.end_s() - plain.end_s() - 4.0 * 0.04).abs() < 1e-9);
    let (mut fastest_change, mut before) = (0.0_f64, None::<f64>);
    let step_s = 1e-4;
    for k in 1..(bell.end_s() / step_s) as usize - 1 {
        let speed = |k: usize| bell.at(k as f64 * step_s).velocity_mm_s.norm();
        let acceleration = (speed(k + 1) - speed(k)) / step_s;
        if let Some(before) = before {
            fastest_change = fastest_change.max((acceleration - before).abs() / step_s);
        }
        before = Some(acceleration);
    }
    // The speed over 40 ms: 500 mm/s² build up at 12500 mm/s³.
    assert!(fastest_change < 12_500.0 * 1.01, "{fastest_change}");
    let place = |trajectory: &Trajectory| trajectory.at(trajectory.end_s()).position_mm;
    assert!((place(&bell) - place(&plain)).norm() < 1e-9);
}

#[test]
fn exact_stop_stops_at_every_block() {
    let chords = "X1.\nX2.\nX3.\nX4.";
    let through = driven(&machine("", ""), &format!("G01 F600.\n{chords}"));
    assert_near(through.end_s(), trapezoid_s(4.0, 10.0, 500.0));
    let stopping = driven(&machine("", ""), &format!("G61 G01 F600.\n{chords}"));
    assert_near(stopping.end_s(), 4.0 * trapezoid_s(1.0, 10.0, 500.0));
}

#[test]
fn a_slide_reverses_where_it_begins_to_move_back() {
    let plain = machine("", "");
    // Half a circle in XY: X turns at its ends only, Y in the middle of the arc.
    let trajectory = driven(
        &plain,
        "G01 X10. Y-1. F600.\nG01 Y0.\nG03 X-10. I-10. J0.\nG01 X-12.\nG04 P2000\nG01 X-10.",
    );
    let reversals = Reversals::of(&trajectory);
    let state = trajectory.at(trajectory.end_s());
    let [x, y, z] = reversals.last(trajectory.end_s(), &state.position_mm, 0.0);
    let x = x.unwrap();
    assert_near(x.ago_mm, 2.0);
    assert_near(x.ago_s, trapezoid_s(2.0, 10.0, 500.0));
    // Y ran up to the top of the arc and down again.
    let y = y.unwrap();
    assert_near(y.ago_mm, 10.0);
    assert!(z.is_none(), "Z never moved");
    let before_s = trajectory.end_s() - trapezoid_s(2.0, 10.0, 500.0) - 2.0;
    let state = trajectory.at(before_s);
    // X came with its first motion, began the arc against it, and has gone on in that sense since.
    assert_near(reversals.last(before_s, &state.position_mm, 0.0)[0].unwrap().ago_mm, 22.0);
}

#[test]
fn an_arc_that_ends_where_a_slide_turns_round_leaves_it_in_the_sense_in_which_it_came() {
    // A circle in halves from -X, as a test of a plane begins, with overshoots: X turns at every seam.
    let trajectory = driven(
        &machine("", ""),
        "G01 X-10. Y0. F600.\nG04 P1000\nG03 X10. I10. J0.\nG03 X-10. I-10. J0.\nG03 X10. I10. J0.\nG03 X-10. I-10. J0.\nG04 P1000\nG01 X-12.",
    );
    let blocks = trajectory.blocks();
    let senses = |block: usize| {
        let block = &blocks[block];
        trajectory.at(block.start_s + 0.5 * block.duration_s).sense
    };
    let x: Vec<f64> = (0..blocks.len()).map(|block| senses(block).x).collect();
    assert_eq!(x, [-1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0]);
    // Off the ends of the arcs Y stands, and has the sense of the half before.
    let y: Vec<f64> = (0..blocks.len()).map(|block| senses(block).y).collect();
    assert_eq!(y[6..], [-1.0, -1.0]);
    let at_seams = |s: &f64| blocks[3..6].iter().any(|block| (block.start_s - s).abs() < 1e-6);
    let seams = trajectory.reversals_s().into_iter().filter(|s| at_seams(s)).count();
    assert_eq!(seams, 3);
    let last = Reversals::of(&trajectory).last(trajectory.end_s(), &[-12.0, 0.0, 0.0].into(), 0.0);
    assert_near(last[0].unwrap().ago_mm, 22.0);
}

/// What a control writes down that drives a trajectory on its own clock, from 2 s before it begins until 2 s after it has ended;
/// an operator's pause lasts 4 s, and every slide wavers by so much either way, mm.
fn written_down(of: &Trajectory, begins_s: f64, waver_mm: f64) -> String {
    let stops: Vec<f64> =
        of.blocks().iter().filter(|b| b.kind == BlockKind::Stop).map(|b| b.start_s).collect();
    let mut text = "time_ms,x_mm,y_mm,z_mm\n".to_owned();
    let end_s = of.end_s() + 4.0 * stops.len() as f64 + 4.0;
    for k in 0..(end_s * 1e3) as usize {
        let mut program_s = k as f64 * 1e-3 - 2.0;
        for stop_s in &stops {
            program_s -= (program_s - stop_s).clamp(0.0, 4.0);
        }
        let waver = |slide: usize| waver_mm * ((k + 17 * slide) as f64 * 2.3).sin();
        let at = of.at(program_s.max(0.0)).position_mm;
        let [x, y, z] = [0, 1, 2].map(|slide| at[slide] + waver(slide));
        writeln!(text, "{:.3},{x:.5},{y:.5},{z:.5}", 1e3 * begins_s + k as f64).unwrap();
    }
    text
}

/// A ball-bar test in small: feed-in, a circle there and back, with dwells, an operator's pause, and half of it in chords.
const SMALL_TEST: &str = "G00 X54. Y0. Z5.\nZ0.\nM00\nG01 X50. F1200.\nG04 P2000\n(CCW)\nG03 X50. Y0. I-50. J0.\n\
    G04 P1000\n(CW)\nG02 X50. Y0. I-50. J0.\nG04 P1000\nG01 X54.\nM00\nG01 X50.\nG04 P500\n(CHORDS)\nX49.9 Y3.15\nX49.6 Y6.29\n\
    X49.1 Y9.4\nX48.4 Y12.45\nG04 P500\nX54.\n";

fn recorded(text: &str, blocks: &str) -> ballbar::Result<Trajectory> {
    let machine = machine("", "");
    let mut reading = Reading::of(&machine);
    reading.work_offsets_mm.insert(54, Vector3::zeros());
    let source = format!("G90 G00 X0. Y0. Z0.\n{blocks}\nM30\n");
    let program = nc::read(&source, "p.nc".as_ref(), &reading)?;
    let recording = Recording::read_bytes(text.as_bytes(), "motion.csv".as_ref())?;
    Trajectory::recorded(&program, &machine, &recording)
}

#[test]
fn a_recorded_motion_is_that_of_its_program_on_its_own_clock() {
    let planned = driven(&machine("", ""), SMALL_TEST);
    for waver_mm in [0.0, 0.5e-3] {
        let seen = recorded(&written_down(&planned, 1234.5, waver_mm), SMALL_TEST).unwrap();
        // Dwells of 2 s that the slides stand in end to within what they waver by; the beginning is planned back from the first pause.
        let known_s = 2e-3 + (2.0 * 8.0 * waver_mm / 500.0).sqrt();
        assert_eq!(seen.blocks().len(), planned.blocks().len());
        for (seen, planned) in seen.blocks().iter().zip(planned.blocks()) {
            assert_eq!((seen.kind, seen.line), (planned.kind, planned.line));
            let off_s = (seen.start_s - planned.start_s).abs();
            // Each standstill before it begins and ends so late or early.
            assert!(off_s < 3.0 * known_s, "line {}: {off_s} s", planned.line);
        }
        let pauses_s = seen.recorded_pauses_s().unwrap();
        assert_eq!(pauses_s.len(), 2);
        assert!(pauses_s.iter().all(|s| (s - 4.0).abs() < 3.0 * known_s), "{pauses_s:?}");
        let begins_s = planned.blocks()[2].start_s + 0.05;
        let steps = ((planned.end_s() - begins_s) * 100.0) as usize;
        for k in 0..steps {
            let at_s = begins_s + 0.01 * k as f64;
            let (seen, planned) = (seen.at(at_s), planned.at(at_s));
            // Both clocks begin within a millisecond or two of each other, at 20 mm/s.
            let apart_mm = (seen.position_mm - planned.position_mm).norm();
            assert!(apart_mm < 20.0 * 3.0 * known_s + 2.0 * waver_mm, "{apart_mm} at {at_s}");
        }
        let (seen_s, planned_s) = (seen.reversals_s(), planned.reversals_s());
        let after = |of: &[f64]| of.iter().copied().filter(|s| *s > begins_s).collect::<Vec<_>>();
        let (seen_s, planned_s) = (after(&seen_s), after(&planned_s));
        // Out of rest into the extreme of a circle a slide leaves with the fourth power of time: by 0.5 a² t⁴ / 4 R.
        let unknown_s = known_s + ((4.0 * waver_mm + 1.5e-5) / 625.0).powf(0.25);
        let near = |of: &[f64], s: &f64| of.iter().any(|other| (other - s).abs() < unknown_s);
        assert!(seen_s.iter().all(|s| near(&planned_s, s)), "{seen_s:?} {planned_s:?}");
        assert!(planned_s.iter().all(|s| near(&seen_s, s)), "{seen_s:?} {planned_s:?}");
    }
}

#[test]
fn a_recorded_motion_of_another_program_is_refused_with_the_block() {
    let planned = driven(&machine("", ""), SMALL_TEST);
    let text = written_down(&planned, 0.0, 0.0);
    let other = SMALL_TEST.replace("G02 X50. Y0. I-50.", "G02 X50. Y0. I-40.");
    let error = recorded(&text, &other).unwrap_err().to_string();
    assert!(error.contains("not that of the program") && error.contains("(line 11)"), "{error}");
    let shifted = SMALL_TEST.replace("X54. Y0. Z5.", "X54. Y0. Z40.").replace("Z0.", "Z30.");
    let error = recorded(&text, &shifted).unwrap_err().to_string();
    assert!(error.contains("never comes to where the program begins"), "{error}");
    // And so is half of it.
    let half = text.lines().count() / 2;
    let cut: String = text.lines().take(half).flat_map(|line| [line, "\n"]).collect();
    assert!(recorded(&cut, SMALL_TEST).is_err());
}

/// Of the readings that a sample is the mean of, along a chord, round an arc and from one to the other.
#[test]
fn the_mean_of_places_is_that_of_each() {
    let blocks = "G01 X50. Y0. F3000.\nG03 X0. Y50. I-50. J0.\nG01 X-30. Y50.";
    let trajectory = driven(&machine("", ""), blocks);
    let moves = trajectory.blocks().iter().filter(|block| block.motion().is_some());
    let onto_chord_s = moves.map(|block| block.start_s).fold(0.0, f64::max);
    for count in [1, 2, 5, 20] {
        for middle_s in [0.6, 1.5, 2.0, onto_chord_s + 0.003] {
            let times = Times::about(middle_s, 1e-3 * 20.0 / f64::from(count), count as usize);
            let each = (0..count).map(|k| trajectory.at(times.at_s(f64::from(k))).position_mm);
            let mean_mm = each.sum::<Vector3<f64>>() / f64::from(count);
            let told_mm = trajectory.mean_position_mm(&times, trajectory.block_at(middle_s));
            assert!((told_mm - mean_mm).norm() < 1e-6, "{count} {middle_s}: {told_mm} {mean_mm}");
        }
    }
}
