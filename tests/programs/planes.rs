//! Programs of circles in planes: G02 and G03 and chords, with overshoot, feeds and feed-in, held against the plan.

use std::f64::consts::TAU;

use ballbar::machine::Machine;
use ballbar::motion::Trajectory;
use ballbar::nc::{self, Severity};
use ballbar::plan::{BAR_STOPS, Path, Step, Test};

use crate::outside::installed;
use crate::rs274;
use crate::written::{dialect, machine, test, written_and_read};

const PLACES: [(&str, &str); 2] =
    [("hu40t.toml", "[20.0, -35.0, 40.0]"), ("vertical.toml", "[20.0, -35.0, -250.0]")];

/// The test of a plane that may have a feed of its own.
pub(crate) fn planar(coincidence: &str, plan: &str) -> Test {
    let source = format!(
        "name = \"t\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\nname = \"A\"\n\
         coincidence_mm = {coincidence}\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\n{plan}\n"
    );
    Test::parse(&source, "t.toml".as_ref()).unwrap_or_else(|error| panic!("{error}\n{source}"))
}

pub(crate) fn errors(machine: &Machine, test: &Test, text: &str) -> Vec<String> {
    let mut reading = nc::Reading::of(machine);
    reading.work_offsets_mm.insert(54, test.mountings()[0].mounting.coincidence_mm);
    let sphere = nc::Sphere::of(test, 0).unwrap();
    let checked = nc::check(text, "O.nc".as_ref(), machine, &reading, Some(&sphere)).unwrap();
    let harmful = checked.findings.into_iter().filter(|f| f.severity == Severity::Error);
    harmful.map(|finding| finding.error.to_string()).collect()
}

/// An interpreter that none of us wrote ends every block where it was planned, and turns about the workpiece ball in the
/// planned sense.
#[test]
fn rs274_drives_the_planes_that_were_planned() {
    if !installed("rs274") {
        return;
    }
    let mut worst_mm = 0.0_f64;
    let (mut programs, mut ends, mut arcs) = (0, 0, 0);
    for (name, coincidence) in PLACES {
        for strategy in ["xy", "yz", "zx", "iso230-4"] {
            for angles in ["sweep_deg = 360.0", "sweep_deg = 220.0", "sweep_deg = 180.0", ""] {
                for more in ["", "interpolation = \"chords\"", "release_between_arcs = false"] {
                    for spoken in ["fanuc", "linuxcnc"] {
                        let machine = dialect(name, 3, spoken, None);
                        let plan = format!(
                            "strategy = \"{strategy}\"\nfeed_mm_min = [1000.0, 2000.0]\n{angles}\n{more}"
                        );
                        let test = planar(coincidence, &plan);
                        let path = Path::plan(&test, &machine, 0).unwrap();
                        let (program, _, text) = written_and_read(&machine, &test);
                        let told = errors(&machine, &test, &text);
                        // A whole circle in a vertical plane leads tool and spindle nose to the post.
                        let bodies = |told: &&String| !told.contains("and support touch");
                        assert_eq!(told.iter().find(bodies), None, "{plan}\n{text}");
                        let least_mm = path.least_clearance(&machine).unwrap().clearance_mm;
                        assert_eq!(told.is_empty(), least_mm > 0.0, "{plan}\n{text}");
                        let text = if spoken == "fanuc" { rs274::translated(&text) } else { text };
                        let canon = rs274::interpret(&text).unwrap_or_else(|told| panic!("{told}"));
                        assert!(canon.ended, "the end of the program");
                        let time = Trajectory::new(&program, &machine, 1.0).duration();
                        assert!((canon.dwell_s - time.dwell_s).abs() < 1e-6, "dwells");
                        assert_eq!(canon.stops, time.stops, "stops");
                        let planned: Vec<_> = path.ends().collect();
                        assert_eq!(canon.ends_mm.len(), planned.len() + 1);
                        for (end_mm, point) in canon.ends_mm[2..].iter().zip(&planned[1..]) {
                            for axis in 0..3 {
                                worst_mm = worst_mm.max((end_mm[axis] - point[axis]).abs());
                            }
                        }
                        let circular: Vec<_> = path
                            .steps
                            .iter()
                            .filter_map(|step| match step {
                                Step::Circular(arc, _) => Some(arc),
                                _ => None,
                            })
                            .collect();
                        assert_eq!(canon.arcs.len(), circular.len(), "{plan}");
                        for ((end, centre_mm, turns), arc) in canon.arcs.iter().zip(&circular) {
                            assert!((turns - arc.sweep_rad.signum()).abs() < 1e-9, "sense");
                            for axis in arc.plane.axes() {
                                assert!(centre_mm[axis].abs() < 1e-4, "{centre_mm:?}");
                            }
                            // What it turns by: from the end before to its own end.
                            let angle = |at: &[f64; 3]| arc.plane.angle_rad(&(*at).into());
                            let by = (angle(&canon.ends_mm[*end]) - angle(&canon.ends_mm[end - 1]))
                                * turns;
                            let by = by.rem_euclid(TAU);
                            let off = (by - arc.sweep_rad.abs()).rem_euclid(TAU);
                            assert!(off.min(TAU - off) < 2e-5, "{by} and {}", arc.sweep_rad);
                        }
                        programs += 1;
                        ends += planned.len();
                        arcs += circular.len();
                    }
                }
            }
        }
    }
    println!(
        "rs274: {programs} programs of planes, {ends} ends, {arcs} arcs, worst {worst_mm:.7} mm"
    );
    assert!(worst_mm <= 0.000_5 + 1e-9, "{worst_mm}");
}

/// What a pass is made of, and that the two directions and the feeds are there.
#[test]
fn every_plane_is_driven_both_ways_at_every_feed() {
    for (name, coincidence) in PLACES {
        let machine = machine(name, 3);
        let test = planar(coincidence, "strategy = \"iso230-4\"\nfeed_mm_min = [500.0, 1000.0]");
        let path = Path::plan(&test, &machine, 0).unwrap();
        let passes: Vec<_> = path.legs.iter().filter(|leg| !leg.transit).collect();
        let told: Vec<&str> = passes.iter().map(|leg| leg.arc.name.as_str()).collect();
        let of = |plane: &str| {
            ["F500 CCW", "F500 CW", "F1000 CCW", "F1000 CW"].map(|way| format!("{plane} {way}"))
        };
        assert_eq!(told, ["XY", "YZ", "ZX"].map(of).concat());
        for leg in &passes {
            let deg = |rad: f64| (rad.abs().to_degrees() * 1e6).round() / 1e6;
            let whole = leg.arc.name.starts_with("XY");
            let expected = if whole { (360.0, 180.0, 720.0) } else { (220.0, 2.0, 224.0) };
            let driven = deg(leg.driven().sweep_rad);
            let found = (deg(leg.arc.sweep_rad), deg(leg.overshoot_rad), driven);
            assert_eq!(found, expected, "{}", leg.arc.name);
            let feed = if leg.arc.name.contains("F500 ") { 500.0 } else { 1000.0 };
            assert!((leg.feed_mm_s * 60.0 - feed).abs() < 1e-9);
        }
        let (program, back, text) = written_and_read(&machine, &test);
        assert!(back.worst_mm <= 0.0005 + 1e-9, "{}", back.worst_mm);
        assert_eq!(errors(&machine, &test, &text), [""; 0]);
        // Between any two of the twelve the bar is released, looked at, and engaged again.
        let duration = Trajectory::new(&program, &machine, 1.0).duration();
        assert_eq!(duration.stops, BAR_STOPS + 11);
        assert_eq!(text.matches("(ENGAGE)").count(), 12);
        assert_eq!(text.matches("G03").count(), 18);
        assert_eq!(text.matches("G02").count(), 18);
    }
}

/// Chords and arcs are the same circle.
#[test]
fn chords_and_arcs_lead_along_the_same_circle() {
    let machine = machine("hu40t.toml", 3);
    let length_mm = |interpolation: &str| {
        let plan =
            format!("strategy = \"zx\"\nfeed_mm_min = 1000.0\ninterpolation = \"{interpolation}\"");
        let test = planar("[20.0, -35.0, 40.0]", &plan);
        let (program, _, text) = written_and_read(&machine, &test);
        assert_eq!(errors(&machine, &test, &text), [""; 0]);
        assert_eq!(text.contains("G02"), interpolation == "arcs");
        let moves = program.steps.iter().filter_map(|step| match step.action {
            nc::Action::Move(motion) => Some(motion.length_mm()),
            _ => None,
        });
        moves.sum::<f64>()
    };
    let (arcs_mm, chords_mm) = (length_mm("arcs"), length_mm("chords"));
    assert!((arcs_mm - chords_mm).abs() < 0.02, "{arcs_mm} and {chords_mm}");
}

/// A program of chords that is too large for the memory keeps overshoot and data arc together.
#[test]
fn a_pass_of_chords_is_one_subprogram() {
    let machine = dialect("hu40t.toml", 3, "fanuc", Some(90.0));
    let plan = "strategy = \"iso230-4\"\nfeed_mm_min = 1000.0\ninterpolation = \"chords\"";
    let test = planar("[20.0, -35.0, 40.0]", plan);
    let (_, _, text) = written_and_read(&machine, &test);
    assert_eq!(errors(&machine, &test, &text), [""; 0]);
    let subprograms: Vec<&str> = text.split("\nO").skip(1).collect();
    let passes = subprograms.iter().filter(|of| of.contains("OVERSHOOT")).count();
    assert_eq!(passes, 1 + 6 - 1, "{}", subprograms.len());
    assert!(subprograms.iter().all(|of| of.matches("OVERSHOOT").count() != 1));
}

/// A Fanuc without scaling calls G50 an alarm.
#[test]
fn a_program_cancels_what_the_control_has() {
    let source = std::fs::read_to_string(machine("hu40t.toml", 3).file()).unwrap();
    let with = |key: &str| {
        let source = source.replacen("decimals = 3", &format!("decimals = 3\n{key}"), 1);
        Machine::parse(&source, "m.toml".as_ref())
    };
    let test = planar("[20.0, -35.0, 40.0]", "strategy = \"xy\"\nfeed_mm_min = 1000.0");
    let (_, _, text) =
        written_and_read(&with("cancel_blocks = [\"G69\", \"G15\"]").unwrap(), &test);
    assert!(text.contains("G69\n") && text.contains("G15\n") && !text.contains("G50"), "{text}");
    for wrong in ["[\"G28\"]", "[\"G69\", \"G69\"]", "[\"G69\\nM03\"]"] {
        let error = with(&format!("cancel_blocks = {wrong}")).unwrap_err();
        assert!(error.what.contains("is nothing to cancel once"), "{error}");
        assert_eq!(error.place.as_ref().unwrap().line, 30, "{error}");
    }
}

/// What the operator compares stands in the header and at the stop alike.
#[test]
fn the_header_says_what_the_control_must_show() {
    for (name, coincidence) in PLACES {
        let test = planar(coincidence, "strategy = \"iso230-4\"\nfeed_mm_min = 1000.0");
        let (_, _, text) = written_and_read(&machine(name, 3), &test);
        let place = |before: &str| {
            let line = text.lines().find(|line| line.contains(before)).unwrap();
            line[line.find('X').unwrap()..].trim_end_matches(')').to_owned()
        };
        assert_eq!(place("COMPARE AT THE SECOND STOP - G54"), place("IN G54 THIS MUST BE"));
        assert!(text.contains("(BALL-BAR OF 150.000 MM - OFF UNTIL THE THIRD STOP)"), "{text}");
    }
}

#[test]
fn a_control_with_two_decimals_is_told_to_take_chords() {
    let machine = machine("hu40t.toml", 2);
    let write = |more: &str| {
        let test = test("[20.0, -35.0, 40.0]", &format!("strategy = \"yz\"\n{more}"));
        let path = Path::plan(&test, &machine, 0).unwrap();
        nc::write(&test, &machine, &path)
    };
    let error = write("").unwrap_err();
    assert!(error.what.contains("2 decimals"), "{error}");
    assert!(error.hint.unwrap().contains("interpolation = \"chords\""));
    assert!(write("interpolation = \"chords\"").is_ok());
}

#[test]
fn a_plane_that_does_not_fit_names_axis_and_figures() {
    let test = planar(
        "[20.0, -35.0, -360.0]",
        "strategy = \"zx\"\nfeed_mm_min = 1000.0\nsweep_deg = 360.0",
    );
    let error = Path::plan(&test, &machine("vertical.toml", 3), 0).unwrap_err();
    assert!(error.what.contains("the path needs 630.5 mm of axis Z"), "{error}");
}

#[test]
fn the_program_of_a_plane_is_what_a_user_of_a_ball_bar_expects() {
    let machine = machine("vertical.toml", 3);
    let test = planar("[20.0, -35.0, -250.0]", "strategy = \"zx\"\nfeed_mm_min = 1000.0");
    let (_, _, text) = written_and_read(&machine, &test);
    insta::with_settings!({filters => vec![(r"SHA256 [0-9A-F]+", "SHA256 [HASH]")]}, {
        insta::assert_snapshot!(text);
    });
}
