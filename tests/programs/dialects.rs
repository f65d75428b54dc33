//! One test in the languages of four controls: the same moves, feeds, dwells and stops, and words that mislead none of them.

use ballbar::machine::Dialect;
use ballbar::nc::{Action, Path as Way, Program};
use nalgebra::Vector3;

use crate::planes::{errors, planar};
use crate::written::{dialect, written_and_read};

const MACHINES: [(&str, &str); 2] =
    [("hu40t.toml", "[20.0, -35.0, 40.0]"), ("vertical.toml", "[20.0, -35.0, -250.0]")];

/// What a step does, with places to 0.1 um.
fn told(action: &Action) -> String {
    let place = |at: &Vector3<f64>| {
        let [x, y, z] = [at.x, at.y, at.z].map(|mm| (mm * 1e4).round() * 1e-4 + 0.0);
        format!("{x:.4} {y:.4} {z:.4}")
    };
    match action {
        Action::Move(motion) => {
            let way = match motion.path {
                Way::Line => "line".to_owned(),
                Way::Arc { center_mm, axis, sweep_rad } => {
                    format!("arc about {} of {axis} by {sweep_rad:.6}", place(&center_mm))
                }
            };
            let feed = format!("F{:.3}", motion.feed_mm_s * 60.0);
            let speed = if motion.rapid { "rapid" } else { &feed };
            format!("{speed} {way} from {} to {}", place(&motion.start_mm), place(&motion.end_mm))
        }
        Action::Dwell { seconds } => format!("dwell {seconds:.3}"),
        Action::Stop => "stop".to_owned(),
        Action::End => "end".to_owned(),
    }
}

/// What a program does under each of its comments.
fn does(program: &Program) -> Vec<(String, Vec<String>)> {
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    let mut last = None;
    for step in &program.steps {
        if last != Some(step.label) {
            groups.push((program.labels[step.label].clone(), Vec::new()));
        }
        last = Some(step.label);
        groups.last_mut().unwrap().1.push(told(&step.action));
    }
    groups
}

/// The stops of a program and the steps between them, without its comments.
fn steps(groups: &[(String, Vec<String>)]) -> Vec<&str> {
    groups.iter().flat_map(|(_, steps)| steps).map(String::as_str).collect()
}

/// A whole circle in a vertical plane leads tool and spindle nose to the post: told, and no matter here.
fn but_bodies(mut errors: Vec<String>) -> Vec<String> {
    errors.retain(|told| !told.contains(" and support touch"));
    errors
}

#[test]
fn the_same_test_is_the_same_path_on_every_control() {
    let mut worst_mm = 0.0_f64;
    let mut compared = 0;
    for (name, balls) in MACHINES {
        let sweeps = |strategy: &'static str| ["360.0", "220.0"].map(|sweep| (strategy, sweep));
        let planes = ["xy", "yz", "zx", "iso230-4"].into_iter().flat_map(sweeps);
        let plans = planes.map(|(strategy, sweep)| {
            format!(
                "strategy = \"{strategy}\"\nfeed_mm_min = [500.0, 1234.5]\nsweep_deg = {sweep}\n\
                 overshoot_deg = 30.0"
            )
        });
        let spheres = ["2d", "3d5", "3d6", "3d10"].map(|strategy| {
            format!("strategy = \"{strategy}\"\nfeed_mm_min = 800.0\nstop_between_arcs = true")
        });
        for plan in plans.chain(spheres) {
            let in_chords = planar(balls, &format!("{plan}\ninterpolation = \"chords\""));
            let fanuc = dialect(name, 3, "fanuc", None);
            let chords = does(&written_and_read(&fanuc, &in_chords).0);
            let test = planar(balls, &plan);
            let arcs = does(&written_and_read(&fanuc, &test).0);
            for spoken in Dialect::ALL {
                let machine = dialect(name, 3, spoken.name(), None);
                let (program, back, text) = written_and_read(&machine, &test);
                assert_eq!(but_bodies(errors(&machine, &test, &text)), [""; 0], "{text}");
                let reference: Vec<(String, Vec<String>)> = match spoken {
                    // A TNC drives arcs of its working plane; the others are chords on every control.
                    Dialect::Heidenhain => arcs
                        .iter()
                        .zip(&chords)
                        .map(|(arc, chords)| if arc.0.starts_with("XY") { arc } else { chords })
                        .cloned()
                        .collect(),
                    _ => arcs.clone(),
                };
                let done = does(&program);
                assert_eq!(steps(&done), steps(&reference), "{} {plan}", spoken.name());
                worst_mm = worst_mm.max(back.worst_mm);
                compared += steps(&done).len();
                let own = planar(balls, &format!("{plan}\ninterpolation = \"chords\""));
                let (program, back, text) = written_and_read(&machine, &own);
                assert_eq!(but_bodies(errors(&machine, &own, &text)), [""; 0]);
                assert_eq!(steps(&does(&program)), steps(&chords), "{} {plan}", spoken.name());
                worst_mm = worst_mm.max(back.worst_mm);
                compared += steps(&chords).len();
            }
        }
    }
    println!("{compared} steps in four languages, worst {worst_mm:.7} mm");
    assert!(worst_mm <= 0.0005 + 1e-9, "{worst_mm}");
    assert!(compared > 300_000, "{compared}");
}

/// A program as an operator sees it.
#[test]
fn the_program_of_a_plane_in_the_words_of_a_control() {
    for spoken in ["siemens", "heidenhain"] {
        let machine = dialect("vertical.toml", 3, spoken, None);
        let test = planar(
            "[20.0, -35.0, -250.0]",
            "strategy = \"xy\"\nfeed_mm_min = 1000.0\nsweep_deg = 220.0\novershoot_deg = 30.0",
        );
        let (_, _, text) = written_and_read(&machine, &test);
        insta::with_settings!({filters => vec![(r"SHA256 [0-9A-F]+", "SHA256 [HASH]")]}, {
            insta::assert_snapshot!(spoken, text);
        });
    }
}
