//! Programs that come back: every strategy, on both machines, written and read again.

use std::path::Path as FilePath;

use ballbar::machine::Machine;
use ballbar::motion::Trajectory;
use ballbar::nc;
use ballbar::plan::log_format::ReadingKind;
use ballbar::plan::{BAR_STOPS, Part, Path, Test};

use crate::outside::{found_or_skipped, installed};
use crate::rs274;

pub(crate) fn machine(name: &str, decimals: usize) -> Machine {
    let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("machines").join(name);
    let source = std::fs::read_to_string(&file).unwrap();
    let source = source.replace("decimals = 3", &format!("decimals = {decimals}"));
    assert!(source.contains(&format!("decimals = {decimals}")));
    Machine::parse(&source, &file).unwrap()
}

pub(crate) fn test(coincidence: &str, plan: &str) -> Test {
    let source = format!(
        "name = \"t\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\nname = \"A\"\n\
         coincidence_mm = {coincidence}\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\nfeed_mm_min = 500.0\n{plan}\n"
    );
    Test::parse(&source, "t.toml".as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn dialect(
    name: &str,
    decimals: usize,
    dialect: &str,
    memory_kb: Option<f64>,
) -> Machine {
    let machine = machine(name, decimals);
    let source = std::fs::read_to_string(machine.file()).unwrap();
    let keys = memory_kb.map_or(String::new(), |memory| format!("memory_kb = {memory:.1}\n"));
    let source = source
        .replace("dialect = \"fanuc\"\n", "")
        .replace("dialect = \"fanuc\"  ", "")
        .replace("decimals = 3", &format!("decimals = {decimals}"))
        .replace("[controller]\n", &format!("[controller]\ndialect = \"{dialect}\"\n{keys}"));
    Machine::parse(&source, machine.file()).unwrap()
}

pub(crate) fn written_and_read(
    machine: &Machine,
    test: &Test,
) -> (nc::Program, nc::ReadBack, String) {
    let path = Path::plan(test, machine, 0).unwrap_or_else(|error| panic!("{error}"));
    let text = nc::write(test, machine, &path).unwrap();
    let mut reading = nc::Reading::of(machine);
    reading.work_offsets_mm.insert(54, test.mountings()[0].mounting.coincidence_mm);
    let program =
        nc::read(&text, "O.nc".as_ref(), &reading).unwrap_or_else(|error| panic!("{error}"));
    let back = nc::read_back(&program, test, &path).unwrap();
    (program, back, text)
}

#[test]
fn every_strategy_reads_back_within_its_last_decimal() {
    for (name, coincidence) in
        [("hu40t.toml", "[20.0, -35.0, 40.0]"), ("vertical.toml", "[20.0, -35.0, -300.0]")]
    {
        for strategy in ["2d", "3d5", "3d6", "3d10"] {
            for decimals in [3, 4] {
                for sag_um in [0.4, 0.1, 5.7] {
                    let plan = format!("strategy = \"{strategy}\"\nchord_sag_um = {sag_um}");
                    let machine = machine(name, decimals);
                    let (program, back, text) =
                        written_and_read(&machine, &test(coincidence, &plan));
                    let last_decimal_mm = 10_f64.powi(-(decimals as i32));
                    println!(
                        "{name:14} {strategy:5} {decimals} decimals: {} moves, worst {:.7} mm, sag {:.3} um",
                        back.points,
                        back.worst_mm,
                        back.sag_mm * 1e3
                    );
                    assert!(back.worst_mm < 0.75 * last_decimal_mm, "{}", back.worst_mm);
                    // The rounding of both ends lengthens a chord a little.
                    assert!(back.sag_mm * 1e3 < sag_um * 1.01 + 0.002, "sag {}", back.sag_mm);
                    assert!(
                        back.sag_mm * 1e3 > sag_um * 0.9,
                        "no finer than asked: {}",
                        back.sag_mm
                    );
                    assert!(!text.contains("-0.000 ") && !text.contains("-0.0000 "));
                    assert_eq!(program.number, Some(1001));
                }
            }
        }
    }
}

/// An interpreter that none of us wrote drives the planned points, from whole programs and from divided
/// ones, in both dialects.
#[test]
fn rs274_drives_what_was_planned() {
    if !installed("rs274") {
        return;
    }
    let mut worst_mm = 0.0_f64;
    let (mut programs, mut points) = (0, 0);
    for (name, coincidence) in
        [("hu40t.toml", "[20.0, -35.0, 40.0]"), ("vertical.toml", "[20.0, -35.0, -300.0]")]
    {
        for strategy in ["2d", "3d5", "3d6", "3d10"] {
            for spoken in ["fanuc", "linuxcnc"] {
                for memory_kb in [None, Some(60.0)] {
                    let machine = dialect(name, 3, spoken, memory_kb);
                    let test = test(coincidence, &format!("strategy = \"{strategy}\""));
                    let path = Path::plan(&test, &machine, 0).unwrap();
                    let (program, _, text) = written_and_read(&machine, &test);
                    assert_eq!(text.contains("M98 P1002"), memory_kb.is_some());
                    let text = if spoken == "fanuc" { rs274::translated(&text) } else { text };
                    let canon = rs274::interpret(&text).unwrap_or_else(|told| panic!("{told}"));
                    assert!(canon.ended, "the end of the program");
                    let time = Trajectory::new(&program, &machine, 1.0).duration();
                    assert!((canon.dwell_s - time.dwell_s).abs() < 1e-6, "dwells");
                    assert_eq!(canon.stops, time.stops, "stops");
                    // The retract comes from nowhere, and the way across is in machine coordinates.
                    let planned: Vec<_> = path.points().collect();
                    assert_eq!(canon.ends_mm.len(), planned.len() + 1);
                    let across_mm = test.mountings()[0].mounting.coincidence_mm + planned[0];
                    for axis in 0..2 {
                        worst_mm = worst_mm.max((canon.ends_mm[1][axis] - across_mm[axis]).abs());
                    }
                    for (end_mm, point) in canon.ends_mm[2..].iter().zip(&planned[1..]) {
                        for axis in 0..3 {
                            worst_mm = worst_mm.max((end_mm[axis] - point[axis]).abs());
                        }
                    }
                    programs += 1;
                    points += planned.len();
                }
            }
        }
    }
    println!("rs274: {programs} programs, {points} end points, worst {worst_mm:.7} mm");
    assert!(worst_mm <= 0.000_5 + 1e-9, "{worst_mm}");
}

/// A second opinion by other authors: `gcode-toolpath` of npm gives the same length and the same box.
#[test]
fn gcode_toolpath_sees_the_same_length_and_box() {
    let root = FilePath::new(env!("CARGO_MANIFEST_DIR"));
    let modules = root.join("target/outside/node_modules");
    if !installed("node")
        || !found_or_skipped(modules.join("gcode-toolpath").is_dir(), "gcode-toolpath")
    {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    for strategy in ["2d", "3d5", "3d6", "3d10"] {
        for spoken in ["fanuc", "linuxcnc"] {
            let machine = dialect("hu40t.toml", 3, spoken, None);
            let test = test("[0.0, 0.0, 0.0]", &format!("strategy = \"{strategy}\""));
            let (program, _, text) = written_and_read(&machine, &test);
            let file = directory.path().join("program.nc");
            // Its zero is the machine's here, and it knows no G53.
            std::fs::write(&file, text.replace("G53 ", "")).unwrap();
            let output = std::process::Command::new("node")
                .arg(root.join("tests/programs/toolpath.js"))
                .arg(&file)
                .env("NODE_PATH", &modules)
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let seen: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            let moves: Vec<_> = program
                .steps
                .iter()
                .filter_map(|step| match step.action {
                    nc::Action::Move(motion) => Some(motion),
                    nc::Action::Dwell { .. } | nc::Action::Stop | nc::Action::End => None,
                })
                .collect();
            let length_mm: f64 = moves.iter().map(nc::Move::length_mm).sum();
            let seen_mm = seen["length"].as_f64().unwrap();
            println!("{strategy} {spoken}: {length_mm:.6} mm, gcode-toolpath {seen_mm:.6} mm");
            // The retract comes from nowhere; the way across, in machine coordinates, from zero.
            assert_eq!(seen["moves"].as_u64().unwrap() as usize, moves.len() + 2);
            let start_mm = moves[0].start_mm;
            let length_mm = length_mm + start_mm.x.hypot(start_mm.y);
            assert!((seen_mm - length_mm).abs() < 1e-6, "{seen_mm} and {length_mm}");
            for axis in 0..3 {
                let at = moves.iter().map(|motion| motion.end_mm[axis]);
                let (low, high) = at.fold((start_mm[axis], start_mm[axis]), |(low, high), at| {
                    (low.min(at), high.max(at))
                });
                assert!((seen["low"][axis].as_f64().unwrap() - low).abs() < 1e-9);
                assert!((seen["high"][axis].as_f64().unwrap() - high).abs() < 1e-9);
            }
        }
    }
}

/// A control that takes subprograms one by one must have room for each.
#[test]
fn a_program_larger_than_the_memory_is_divided_by_arcs() {
    let whole = machine("hu40t.toml", 3);
    let small = dialect("hu40t.toml", 3, "fanuc", Some(60.0));
    let test = test("[20.0, -35.0, 40.0]", "strategy = \"3d6\"");
    let (one, _, text) = written_and_read(&whole, &test);
    let (divided, _, parts) = written_and_read(&small, &test);
    let moves = |program: &nc::Program| {
        let mut moves = Vec::new();
        for step in &program.steps {
            match step.action {
                nc::Action::Move(motion) => moves.push((motion.start_mm, motion.end_mm)),
                nc::Action::Dwell { .. } | nc::Action::Stop | nc::Action::End => {}
            }
        }
        moves
    };
    assert!(text.len() > 200_000 && !text.contains("M98"));
    assert!(moves(&one) == moves(&divided), "the same path");
    let sizes: Vec<usize> = parts.split("\nO").map(str::len).collect();
    assert!(sizes.len() > 12 && sizes.iter().all(|size| *size < 60 * 1024), "{sizes:?}");
    let mut reading = nc::Reading::of(&small);
    reading.work_offsets_mm.insert(54, test.mountings()[0].mounting.coincidence_mm);
    let sphere = nc::Sphere::of(&test, 0).unwrap();
    let checked = nc::check(&parts, "O.nc".as_ref(), &small, &reading, Some(&sphere)).unwrap();
    assert_eq!(checked.findings, []);
    let checked = nc::check(&text, "O.nc".as_ref(), &small, &reading, Some(&sphere)).unwrap();
    assert_eq!(checked.findings.len(), 1);
    assert!(checked.findings[0].error.what.contains("the control's memory 60.0 KB"));
}

#[test]
fn every_slide_has_moved_before_the_bar_engages() {
    let machine = machine("hu40t.toml", 3);
    for azimuth in [0, 17, 45, 90, 137, 180, 270] {
        let plan = format!(
            "[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = {azimuth}.0\nsweep_deg = 90.0"
        );
        let test = test("[20.0, -35.0, 40.0]", &plan);
        let (program, _, _) = written_and_read(&machine, &test);
        let trajectory = Trajectory::new(&program, &machine, 1.0);
        let stop = trajectory
            .blocks()
            .iter()
            .find(|block| block.kind == ballbar::motion::BlockKind::Stop)
            .unwrap();
        let state = trajectory.at(stop.start_s);
        assert!(state.sense.iter().all(|sense| *sense != 0.0), "{azimuth}: {}", state.sense);
        let distance = (state.position_mm - test.mountings()[0].mounting.coincidence_mm).norm();
        assert!(distance > 151.2, "the bar is fitted outside its range, at {distance}");
    }
}

#[test]
fn free_arcs_stay_on_the_sphere() {
    let machine = machine("hu40t.toml", 3);
    let plan = "[[plan.arc]]\nkind = \"parallel\"\npolar_deg = 50.0\n\
        [[plan.arc]]\nkind = \"circle\"\nstart = [1.0, 0.0, 0.2]\nnormal = [0.1, 0.3, 1.0]\nsweep_deg = -120.0\n\
        [[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 30.0\nstart_deg = 20.0\nsweep_deg = 100.0\nname = \"part\"";
    let test = test("[20.0, -35.0, 40.0]", plan);
    let path = Path::plan(&test, &machine, 0).unwrap();
    let chords = path.steps.iter().filter_map(|step| match step {
        ballbar::plan::Step::Chords(points, _) => Some(points),
        _ => None,
    });
    let mut count = 0;
    for point in chords.flatten() {
        assert!((point.norm() - 150.0).abs() < 1e-9);
        count += 1;
    }
    assert!(count > 1000);
    let (_, back, text) = written_and_read(&machine, &test);
    assert!(back.worst_mm < 0.00075);
    for name in ["(ARC 1 CCW)", "(ARC 1 CW)", "(ARC 2 FORWARD)", "(PART BACKWARD)", "(TRANSIT)"] {
        assert!(text.contains(name), "{name}");
    }
}

#[test]
fn a_mounting_may_use_a_bar_of_its_own() {
    let machine = machine("hu40t.toml", 3);
    let test = test(
        "[20.0, -35.0, 40.0]\nbar_length_mm = 100.0",
        "[[plan.arc]]\nkind = \"equator\"\n[log]\nreading = \"length\"",
    );
    let (program, back, text) = written_and_read(&machine, &test);
    assert!(text.contains("(BALL-BAR FREE R100 F500)"), "{text}");
    assert!(back.worst_mm < 0.00075 && back.sag_mm > 0.00035, "{back:?}");
    let at = |program_s: f64| {
        let position_mm = Trajectory::new(&program, &machine, 1.0).at(program_s).position_mm;
        (position_mm - test.mountings()[0].mounting.coincidence_mm).norm()
    };
    assert!((at(60.0) - 100.0).abs() < 1e-3, "{}", at(60.0));
    let kind = test.log_format_of(0).reading.kind;
    assert_eq!(kind, ReadingKind::Length { nominal_mm: 100.0 }, "its logs are read by its length");
}

#[test]
fn an_arc_may_belong_to_one_mounting_and_be_driven_twice() {
    let machine = machine("hu40t.toml", 3);
    let twice = "[[plan.arc]]\nkind = \"equator\"\nname = \"ring\"\nsweep_deg = 90.0\n";
    let test = test(
        "[20.0, -35.0, 40.0]",
        &format!(
            "{twice}{twice}[[plan.arc]]\nkind = \"meridian\"\nname = \"M\"\nmountings = [\"B\"]\n\
             [[mounting]]\nname = \"B\"\ncoincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]"
        ),
    );
    let names = |mounting: usize| -> Vec<String> {
        let path = Path::plan(&test, &machine, mounting).unwrap();
        path.legs.into_iter().map(|leg| leg.arc.name).filter(|name| name != "TRANSIT").collect()
    };
    let ring = ["RING FORWARD", "RING BACKWARD", "RING 2 FORWARD", "RING 2 BACKWARD"];
    assert_eq!(names(0), ring);
    assert_eq!(names(1)[..4], ring);
    assert_eq!(names(1)[4..], ["M FORWARD", "M BACKWARD"]);
}

#[test]
fn a_mounting_without_an_arc_is_told_by_its_name() {
    let test = test(
        "[20.0, -35.0, 40.0]",
        "[[plan.arc]]\nkind = \"equator\"\nmountings = [\"B\"]\n\
         [[mounting]]\nname = \"B\"\ncoincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]",
    );
    let error = Path::plan(&test, &machine("hu40t.toml", 3), 0).unwrap_err();
    assert!(error.what.contains("no arc for the mounting `A`"), "{error}");
    assert!(error.hint.unwrap().contains("\"A\""));
    assert!(Path::plan(&test, &machine("hu40t.toml", 3), 1).is_ok());
}

#[test]
fn the_least_clearance_is_where_the_tool_comes_round_the_end_of_the_post() {
    let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("machines/hu40t.toml");
    let source = std::fs::read_to_string(&file).unwrap();
    let test = test("[20.0, -35.0, 40.0]", "strategy = \"2d\"");
    let least = |source: &str| {
        let machine = Machine::parse(source, &file).unwrap();
        Path::plan(&test, &machine, 0).unwrap().least_clearance(&machine)
    };
    // A post against the tool axis is nearest on the equator: 150 mm less both radii.
    let found = least(&source).unwrap();
    assert!((found.clearance_mm - 127.5).abs() < 0.05, "{found:?}");
    assert_eq!(found.part, Part::Tool);
    assert!(found.ball_mm.z.abs() < 1e-9, "{found:?}");

    // A post towards -Y, 80 mm long: on the equator the tool, 10 mm in radius, comes round its rim,
    // 12.5 mm beside its axis.
    let found = least(&source.replace("\"-Z\"", "\"-Y\"")).unwrap();
    let over = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        (150.0 * cos - 80.0).hypot((150.0 * sin - 12.5).max(0.0)) - 10.0
    };
    let expected_mm = (0..900).map(|k| over(f64::from(k) * 0.1)).fold(f64::INFINITY, f64::min);
    assert!((found.clearance_mm - expected_mm).abs() < 0.05, "{expected_mm}: {found:?}");
    assert_eq!((found.part, found.section.as_str()), (Part::Tool, "EQUATOR CCW"));
    assert!((found.ball_mm.norm() - 150.0).abs() < 0.01 && found.ball_mm.y < -140.0, "{found:?}");

    let all = self::test("[20.0, -35.0, 40.0]", "strategy = \"3d6\"");
    for direction in ["\"-Z\"", "\"-Y\""] {
        let machine = Machine::parse(&source.replace("\"-Z\"", direction), &file).unwrap();
        let path = Path::plan(&all, &machine, 0).unwrap();
        println!("3d6: {:?}", path.least_clearance(&machine).unwrap());
    }

    // A wide nose close behind the ball is nearer than the tool.
    let close = source.replace("length_mm = 120.0", "length_mm = 20.0");
    let found = least(&close.replace("\"-Z\"", "\"-Y\"")).unwrap();
    assert_eq!(found.part, Part::SpindleNose);
    assert!(least(&source[..source.find("[clearance.support]").unwrap()]).is_none());
}

#[test]
fn stops_between_arcs_replace_the_dwells() {
    let machine = machine("hu40t.toml", 3);
    let test = test("[20.0, -35.0, 40.0]", "strategy = \"2d\"\nstop_between_arcs = true");
    let (program, _, text) = written_and_read(&machine, &test);
    let duration = Trajectory::new(&program, &machine, 1.0).duration();
    // Those for the bar, and one after each of the six arcs.
    assert_eq!(duration.stops, BAR_STOPS + 6);
    assert!(text.contains("M00 (PRESS START TO GO ON)"));
}

#[test]
fn a_path_beyond_the_travel_names_axis_and_figures() {
    let machine = machine("hu40t.toml", 3);
    let test = test("[200.0, -35.0, 40.0]", "strategy = \"3d6\"");
    let error = Path::plan(&test, &machine, 0).unwrap_err();
    assert!(error.what.contains("axis X would have to go to 371.500 mm"), "{error}");
    assert!(error.what.contains("mounting `A`"), "{error}");
}

#[test]
fn the_program_is_what_an_operator_expects() {
    let machine = machine("hu40t.toml", 3);
    let test = test(
        "[20.0, -35.0, 40.0]",
        "[[plan.arc]]\nkind = \"equator\"\nsweep_deg = 3.0\n[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 90.0\nsweep_deg = 2.0",
    );
    let (_, _, text) = written_and_read(&machine, &test);
    insta::with_settings!({filters => vec![(r"SHA256 [0-9A-F]+", "SHA256 [HASH]")]}, {
        insta::assert_snapshot!(text);
    });
}
