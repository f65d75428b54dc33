//! Files that do not say what is true, and the scenario file that says what is hidden.

use super::*;
use crate::machine::{Axis, Pivot};
use crate::simulate::Coincidence;

fn real() -> Scenario {
    let mut scenario = Scenario { pauses: Pauses::Fixed(vec![7.0]), ..Scenario::default() };
    for (name, value) in [("EBX1", 2e-7), ("ECX2", 1e-9), ("EAY1", 3e-7)] {
        scenario.errors.set(Coefficient::parse(name).unwrap(), value);
    }
    scenario
}

#[track_caller]
fn same_lengths(one: &SimulatedRun, other: &SimulatedRun) {
    assert_eq!(one.truth.len(), other.truth.len());
    for (one, other) in one.truth.iter().zip(&other.truth) {
        assert!((one.exact_mm - other.exact_mm).abs() < 1e-10, "{one:?} {other:?}");
    }
}

#[test]
fn the_knob_and_the_clock_are_as_hidden() {
    let bench = bench("hu40t.toml");
    let hidden = bench.run(&hiding(real(), &["feed-override:percent=80", "clock:ppm=80"]));
    let stated = bench.run(&Scenario { feed_override: 0.8, clock_ppm: 80.0, ..real() });
    assert_eq!(hidden.readings, stated.readings);
    assert_eq!(hidden.clock, stated.clock);
}

#[test]
fn the_pivot_is_the_other_one() {
    let bench = bench("hu40t.toml");
    for slide in [Axis::X, Axis::Z] {
        let hidden = bench.run(&hiding(real(), &[&format!("pivot:on={slide}")]));
        let machine = bench.machine.clone().with_pivot(slide, Pivot::Base);
        let stated = run(&machine, &bench.mounting, &bench.program, &bench.bar, &real()).unwrap();
        assert_eq!(hidden.readings, stated.readings);
        let back = machine.with_pivot(slide, Pivot::Carriage);
        assert_eq!(back, bench.machine, "a carriage was assumed");
        assert_ne!(hidden.readings, bench.run(&real()).readings);
    }
}

#[test]
fn balls_at_other_places_are_those_of_another_mounting() {
    let bench = bench("hu40t.toml");
    let tool = ["ball-place:on=EXt,offset_mm=3", "ball-place:on=EZt,offset_mm=-40"];
    let mut mounting = bench.mounting;
    mounting.tool_ball_mm += Vector3::new(3.0, 0.0, -40.0);
    let stated = run(&bench.machine, &mounting, &bench.program, &bench.bar, &real()).unwrap();
    same_lengths(&bench.run(&hiding(real(), &tool)), &stated);

    // The work offset is where the workpiece ball is: the program runs elsewhere in the travel.
    let workpiece = ["ball-place:on=EXw,offset_mm=30", "ball-place:on=EYw,offset_mm=-15"];
    let mut elsewhere = bench.mounting;
    elsewhere.coincidence_mm += Vector3::new(30.0, -15.0, 0.0);
    let moved = program(&bench.machine, &elsewhere);
    let effects = [workpiece[0], workpiece[1], EXAMPLES[0]];
    let hidden = bench.run(&hiding(real(), &effects));
    let stated =
        run(&bench.machine, &elsewhere, &moved, &bench.bar, &hiding(real(), &[EXAMPLES[0]]));
    same_lengths(&hidden, &stated.unwrap());
    // The test file, and who reads the truth with it, believe the old place.
    assert_eq!(hidden.truth[900].state, bench.run(&real()).truth[900].state);
    // A perfect machine does not tell where in its travel it is.
    for (_, added) in bench.added(&workpiece, 10.0) {
        assert!(added.abs() < 1e-10);
    }
}

#[test]
fn a_ball_may_be_elsewhere_in_one_mounting_only() {
    let bench = bench("hu40t.toml");
    let of_second = hiding(real(), &["ball-place:on=EZt,offset_mm=-40,mounting=2"]);
    assert_eq!(bench.run(&of_second).readings, bench.run(&real()).readings);
    let there = bench.run(&of_second.with_mounting_number(2));
    let of_all = bench.run(&hiding(real(), &["ball-place:on=EZt,offset_mm=-40"]));
    assert_eq!(there.readings, of_all.readings);
}

#[test]
fn where_the_balls_are_touched_the_effects_are_part_of_the_set_up() {
    let bench = bench("hu40t.toml");
    let touched = |effects: &[&str]| {
        let scenario = Scenario { coincidence: Coincidence::Touched, ..perfect() };
        bench.run(&hiding(scenario, effects)).scenario.tool_ball_mm
    };
    // At x = 20 the table is displaced by 3 um, at y = -35 the column by a quarter of a period: the tool
    // ball is fitted so that they meet.
    let x = touched(&["bump:on=EXX,at_mm=20,width_mm=9,amplitude_um=3"]);
    assert!((x - Vector3::new(3e-3, 0.0, 0.0)).norm() < 1e-12, "{x}");
    let y = touched(&["cyclic:on=EYY,period_mm=140,amplitude_um=1"]);
    assert!((y - Vector3::new(0.0, 1e-3, 0.0)).norm() < 1e-12, "{y}");
    // Elsewhere in the travel, where the ball really is.
    let off = touched(&[
        "bump:on=EXX,at_mm=30,width_mm=1,amplitude_um=3",
        "ball-place:on=EXw,offset_mm=10",
    ]);
    assert!((off - Vector3::new(3e-3, 0.0, 0.0)).norm() < 1e-12, "{off}");
    // Cold and at rest there is neither drift nor lag, and nobody touches a swinging ball.
    for index in [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 14, 15, 24] {
        assert!(touched(&[EXAMPLES[index]]).norm() < 1e-12, "{}", EXAMPLES[index]);
    }
}

#[test]
fn a_scenario_file_hides_what_the_text_form_hides() {
    let file = "seed = 4\n[[hide]]\ncause = \"cyclic\"\non = \"EXX\"\nperiod_mm = 10\namplitude_um = 1.2\n\
                [[hide]]\ncause = \"clock\"\nppm = 80.0\n";
    let scenario = Scenario::parse(file, Path::new("s.toml")).unwrap();
    let hidden: Vec<String> = scenario.hidden.iter().map(ToString::to_string).collect();
    assert_eq!(hidden, [EXAMPLES[0], "clock:ppm=80"]);
    assert!(Scenario::parse("", Path::new("s.toml")).unwrap().hidden.is_empty());
}

#[test]
fn a_scenario_file_is_told_where_it_is_wrong() {
    let cyclic = "[[hide]]\ncause = \"cyclic\"\n";
    for (text, line, under, what) in [
        ("[[hide]]\non = \"X\"\n".to_owned(), 1, "[[hide]]", "has no `cause`"),
        ("[[hide]]\ncause = 3\n".to_owned(), 2, "3", "must be text in quotes"),
        ("[[hide]]\ncause = \"cycle\"\n".to_owned(), 2, "\"cycle\"", "unknown cause `cycle`"),
        (cyclic.to_owned(), 2, "\"cyclic\"", "does not say what it acts on"),
        (format!("{cyclic}on = \"X\"\n"), 3, "\"X\"", "cannot act on `X`"),
        (format!("{cyclic}on = \"EXX\"\npitch_mm = 9\n"), 4, "pitch_mm", "has no `pitch_mm`"),
        (format!("{cyclic}on = \"EXX\"\nperiod_mm = 9\n"), 2, "\"cyclic\"", "its `amplitude_um`"),
        (format!("{cyclic}on = \"EXX\"\nperiod_mm = nan\n"), 4, "nan", "from 0.5 to 500, not NaN"),
        (format!("{cyclic}on = \"EXX\"\nperiod_mm = \"9\"\n"), 4, "\"9\"", "must be a number"),
        (
            "[[hide]]\ncause = \"degree\"\non = \"EXX\"\namplitude_um = 1\ndegree = 7\n".to_owned(),
            5,
            "7",
            "`degree` of `degree` must be from 4 to 6, not 7",
        ),
        (
            "[[hide]]\ncause = \"roundness\"\namplitude_um = 1\ndegree = 2\norder = -3\n"
                .to_owned(),
            5,
            "-3",
            "must be from -2 to 2, its degree, not -3",
        ),
        (
            "[[hide]]\ncause = \"clock\"\nppm = 1\n[[hide]]\ncause = \"clock\"\nppm = 2\n"
                .to_owned(),
            5,
            "\"clock\"",
            "`clock` is hidden twice",
        ),
    ] {
        let error = Scenario::parse(&text, Path::new("s.toml")).unwrap_err();
        assert!(error.what.contains(what) && error.hint.is_some(), "{error}");
        let place = error.place.as_ref().unwrap();
        assert_eq!(place.line, line, "{error}");
        let told: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
        assert_eq!(told, under, "{error}");
    }
}
