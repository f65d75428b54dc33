//! Error functions, and slides that do not stand where they are commanded to.

use nalgebra::Vector3;

use super::*;
use crate::machine::{Axis, ChainErrors, Pivot, Pose, SlideError};
use crate::model::Seat;
use crate::motion::Trajectory;

/// A displacement of the tool relative to the workpiece, mm, as the bar sees it to first order.
fn projected(bench: &Bench, at: &TruePoint, effect: &Effect, displaced_mm: f64) -> f64 {
    let Seat::Function(_, component) = effect.seat else { panic!("{effect}") };
    bench.sign(effect) * displaced_mm * bench.bar_direction(at)[component.direction()]
}

/// An error (mm) of position (mm) and sense.
type Equation = Box<dyn Fn(f64, f64) -> f64>;

#[test]
fn an_error_function_displaces_its_slide() {
    let tau = std::f64::consts::TAU;
    let cases: Vec<(&str, Equation)> = vec![
        (
            "cyclic:on=EXX,period_mm=10,amplitude_um=1.2,phase_rad=0.5",
            Box::new(move |h, _| 1.2e-3 * (tau * h / 10.0 + 0.5).sin()),
        ),
        (
            "cyclic:on=EYZ,period_mm=2.5,amplitude_um=0.7",
            Box::new(move |h, _| 0.7e-3 * (tau * h / 2.5).sin()),
        ),
        (
            "degree:on=EZY,degree=5,amplitude_um=0.5",
            Box::new(|h, _| 0.5e-3 * (h / 100.0) * (h / 100.0).powi(4)),
        ),
        (
            "bump:on=EYX,at_mm=42,width_mm=9,amplitude_um=3",
            Box::new(|h, _| 3e-3 / ((h - 42.0).powi(2) / 162.0).exp()),
        ),
        (
            "joint:on=EZZ,at_mm=10,width_mm=5,amplitude_um=3",
            Box::new(|h, _| 3e-3 * (1.0 - 2.0 / ((0.4 * (h - 10.0)).exp() + 1.0))),
        ),
        ("growing-backlash:on=EYY,slope_um_m=10", Box::new(|h, b| 1e-5 * b * h)),
        (
            "growing-backlash:on=EXX,slope_um_m=-20,from_mm=7",
            Box::new(|h, b| -2e-5 * b * (h - 7.0)),
        ),
    ];
    for machine in ["hu40t.toml", "vertical.toml"] {
        let bench = bench(machine);
        for (text, equation) in &cases {
            let effect = Effect::parse(text).unwrap();
            let k = slide_of(&effect).index();
            for (at, added) in bench.added(&[text], 10.0) {
                let value = equation(at.state.position_mm[k], at.state.sense[k]);
                let expected = projected(&bench, &at, &effect, value);
                // Of second order: (11 um)^2 / 300 mm.
                assert!((added - expected).abs() < 5e-7, "{machine} {text}: {added} {expected}");
            }
        }
    }
}

#[test]
fn an_angle_turns_what_its_slide_carries() {
    let bench = bench("hu40t.toml");
    let place = |axis: Axis| bench.machine.slide(axis).location_mm;
    let tau = std::f64::consts::TAU;
    let tilt = |v: f64| 1e-5 * v.signum() * (v.abs() * 60.0 / 1000.0).sqrt();
    for (at, added) in bench.added(&["cyclic:on=EAZ,period_mm=20,amplitude_urad=5"], 10.0) {
        let angle = 5e-6 * (tau * at.state.position_mm.z / 20.0).sin();
        // Z carries Y and the spindle: the tool ball as the Z carriage sees it.
        let y = Vector3::new(0.0, at.state.position_mm.y, 0.0);
        let lever = place(Axis::Y) + y + bench.mounting.tool_ball_mm;
        let moved = Vector3::new(angle, 0.0, 0.0).cross(&lever);
        assert!((added - moved.dot(&bench.bar_direction(&at))).abs() < 1e-7);
    }
    let workpiece_ball = bench.machine.workpiece_ball_mm(&bench.mounting);
    let mut largest = 0.0_f64;
    for (at, added) in bench.added(&["friction-tilt:on=ECX,amplitude_urad=10"], 10.0) {
        let moving = at.moment.program_s > 0.0 && !at.moment.in_pause;
        let angle = if moving { tilt(at.state.velocity_mm_s.x) } else { 0.0 };
        // X carries the workpiece ball, always at the same place of its carriage.
        let moved = -Vector3::new(0.0, 0.0, angle).cross(&workpiece_ball);
        let expected = moved.dot(&bench.bar_direction(&at));
        assert!((added - expected).abs() < 1e-7, "{added} {expected}");
        largest = largest.max(expected.abs());
    }
    assert!(largest > 1e-4, "{largest}");
}

/// For every sample the sense of a slide and its last turning point, found in where it goes: how far (mm)
/// and how long (s of program time) ago.
fn turns(points: &[(TruePoint, f64)], k: usize) -> Vec<(f64, Option<(f64, f64)>)> {
    let (mut sense, mut far, mut turn) = (0.0, (0.0, 0.0), None);
    let mut before: Option<f64> = None;
    let each = points.iter().map(|(at, _)| {
        let (h, t) = (at.state.position_mm[k], at.moment.program_s);
        let step = h - before.unwrap_or(h);
        if step * sense < 0.0 {
            turn = Some(far);
        }
        if step != 0.0 {
            (sense, far) = (step.signum(), (h, t));
        }
        before = Some(h);
        (sense, turn.map(|(at_mm, at_s): (f64, f64)| ((h - at_mm).abs(), t - at_s)))
    });
    each.collect()
}

#[test]
fn backlash_builds_up_over_a_distance_and_a_spike_dies_with_time() {
    let bench = bench("hu40t.toml");
    let rate_hz = 500.0;
    let pre_sliding = "pre-sliding:on=EYY,amplitude_um=2,distance_mm=3";
    let spike = "reversal-spike:on=X,amplitude_um=3,decay_ms=500";
    for (text, k) in [(pre_sliding, 1), (spike, 0)] {
        let points = bench.added(&[text], rate_hz);
        let turns = turns(&points, k);
        let (mut reversed, mut unsure, mut largest) = (0, 0, 0.0_f64);
        for ((at, added), (b, turn)) in points.iter().zip(&turns) {
            if (b - at.state.sense[k]).abs() > 0.0 {
                // Between two samples it is not seen which way the slide goes.
                unsure += 1;
                continue;
            }
            reversed += usize::from(turn.is_some());
            let relative = match (text == spike, turn) {
                (true, None) => 0.0,
                (true, Some((_, ago_s))) => 3e-3 * b * (-ago_s / 0.5).exp(),
                (false, None) => 2e-3 * b,
                (false, Some((ago_mm, _))) => 2e-3 * b * (1.0 - 2.0 * (-ago_mm / 3.0).exp()),
            };
            // The tool goes +X relative to the table where the spike is positive, though X is the table.
            let expected = relative * bench.bar_direction(at)[k];
            largest = largest.max(expected.abs());
            // The turning points are found to a sample.
            let tolerance = if text == spike { 4e-5 } else { 1e-5 };
            let moment = at.moment;
            assert!((added - expected).abs() < tolerance, "{text} {moment:?} {added} {expected}");
        }
        assert!(reversed > points.len() / 4 && largest > 1.5e-3, "{reversed} {largest}");
        assert!(unsure < 20, "{unsure}");
    }
}

#[test]
fn a_late_slide_stands_where_it_was_commanded_to_be() {
    let mut bench = bench("hu40t.toml");
    bench.machine = bench.machine.with_pivot(Axis::Y, Pivot::Base);
    let mut scenario = Scenario { pauses: Pauses::Fixed(vec![7.0]), ..Scenario::default() };
    scenario.errors.set(Coefficient::parse("ECY1").unwrap(), 1e-6);
    let trajectory = Trajectory::new(&bench.program, &bench.machine, 1.0);
    for (text, k, delay_s) in
        [("servo:on=Y,delay_ms=0.4", 1, 4e-4), ("servo:on=X,delay_ms=-30", 0, -0.03)]
    {
        let run = bench.run(&hiding(scenario.clone(), &[text]));
        let mut moved = 0;
        for point in &run.truth {
            let commanded = point.state.position_mm;
            let pose = Pose { position_mm: commanded, sense: point.state.sense };
            let errors = ChainErrors {
                slides: Axis::ALL.map(|slide| scenario.errors.slide_error(slide, &pose)),
                workpiece_ball_mm: scenario.workpiece_ball_mm,
                tool_ball_mm: scenario.tool_ball_mm,
            };
            let mut actual = commanded;
            if !point.moment.in_pause && point.moment.program_s > 0.0 {
                // Both ways within the leg: at an M00 all slides come to the same place.
                let stop = run.clock.stops_s()[0];
                let (low, high) =
                    if point.moment.leg == 0 { (0.0, stop) } else { (stop, f64::INFINITY) };
                let then = (point.moment.program_s - delay_s).clamp(low, high);
                actual[k] = trajectory.at(then).position_mm[k];
            }
            moved += usize::from((actual - commanded).norm() > 1e-4);
            let ball = bench.machine.ball_vector_mm(&bench.mounting, &actual, &errors);
            let expected = ball.norm() - bench.bar.length_mm;
            assert!((point.exact_mm - expected).abs() < 1e-9, "{text} {:?}", point.moment);
        }
        assert!(moved > 1000, "{moved}");
    }
}

/// A slide that follows its command late and is late besides stands where, without the delay, it would have stood that long ago: what
/// slides do with jumps of the commanded velocity, they do a delay later.
#[test]
fn slides_that_follow_and_are_late_do_all_they_do_a_delay_later() {
    let bench = bench("hu40t.toml");
    let mut followed = Scenario { sample_rate_hz: Some(500.0), ..perfect() };
    followed.control.following_s = Vector3::new(0.010, 0.015, 0.020);
    let late = ["X", "Y", "Z"].map(|slide| format!("servo:on={slide},delay_ms=4"));
    let late = bench.run(&hiding(followed.clone(), &late.each_ref().map(String::as_str)));
    let in_time = bench.run(&followed);
    let readings_late = 2;
    for (late, in_time) in late.truth[readings_late..].iter().zip(&in_time.truth) {
        let off_mm = late.exact_mm - in_time.exact_mm;
        assert!(off_mm.abs() < 1e-8, "{:?}: {off_mm} mm", late.moment);
    }
}

#[test]
fn the_tool_lags_by_delay_times_velocity_on_either_side() {
    for machine in ["hu40t.toml", "vertical.toml"] {
        let bench = bench(machine);
        for (text, k) in [("servo:on=X,delay_ms=0.4", 0), ("servo:on=Z,delay_ms=0.4", 2)] {
            for (at, added) in bench.added(&[text], 10.0) {
                let velocity = at.state.velocity_mm_s;
                if (velocity.norm() - 500.0 / 60.0).abs() < 1e-6 {
                    let expected = -4e-4 * velocity[k] * bench.bar_direction(&at)[k];
                    // A corner of the path turns the velocity by some 3 deg within the delay.
                    assert!((added - expected).abs() < 2e-4, "{machine} {text} {added} {expected}");
                }
            }
        }
    }
}

#[test]
fn friction_holds_a_slow_slide_back() {
    for machine in ["hu40t.toml", "vertical.toml"] {
        let bench = bench(machine);
        for (text, k) in [
            ("stick-slip:on=X,amplitude_um=1.5,speed_mm_min=60", 0),
            ("stick-slip:on=Z,amplitude_um=1.5,speed_mm_min=60", 2),
        ] {
            let mut standing = 0;
            for (at, added) in bench.added(&[text], 10.0) {
                let (v, b) = (at.state.velocity_mm_s[k], at.state.sense[k]);
                standing += usize::from(v == 0.0 && b != 0.0);
                let lean = if v == 0.0 { b } else { v.signum() };
                let relative = if b == 0.0 { 0.0 } else { -1.5e-3 * lean * (-v.abs()).exp() };
                let expected = relative * bench.bar_direction(&at)[k];
                assert!((added - expected).abs() < 1e-7, "{machine} {text} {added} {expected}");
            }
            assert!(standing > 50, "the pause, where it leans against its last motion: {standing}");
        }
    }
}

#[test]
fn a_scale_grows_as_it_warms() {
    let bench = bench("hu40t.toml");
    let points = bench.added(&["drift:on=EYY1,amplitude_um_m=50,time_constant_s=100"], 10.0);
    for (k, (at, added)) in points.iter().enumerate() {
        let scale = 50e-6 * (1.0 - (-elapsed_s(k, 10.0) / 100.0).exp());
        let h = at.state.position_mm.y;
        let mut slides = [SlideError::zero(); 3];
        slides[1].translation_mm.y = scale * h;
        let errors = ChainErrors { slides, ..ChainErrors::zero() };
        let ball = bench.machine.ball_vector_mm(&bench.mounting, &at.state.position_mm, &errors);
        let expected = ball.norm() - bench.bar.length_mm - at.exact_mm;
        assert!((added - expected).abs() < 1e-10, "{added} {expected}");
    }
}
