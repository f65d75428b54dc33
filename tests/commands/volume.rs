//! `volume`: what it says of a machine that is known, against the exact chain; its files; what it refuses.

use std::fmt::Write as _;

use ballbar::compensate::{Analysed, Field, Measured, Row, Volume, VolumeMap};
use ballbar::machine::{Axis, Builtin, ChainErrors, Machine, Mounting, Pose};
use ballbar::model::{Coefficient, ErrorFunctions};
use nalgebra::{Matrix6, Vector3, Vector6};
use serde_json::Value;

use crate::work::{Work, project};

/// Numbers that look drawn, the same on every machine.
struct Drawn(u64);

impl Drawn {
    fn uniform(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of deviation 1, never beyond 3.4.
    fn bell(&mut self) -> f64 {
        (0..4).map(|_| self.uniform() - 0.5).sum::<f64>() * 3.0_f64.sqrt()
    }
}

/// Errors of every slide as large as those of a good machine; each loses motion at reversals.
pub(crate) fn drawn_errors(machine: &str, seed: u64) -> ErrorFunctions {
    let machine = Builtin::named(machine).unwrap().machine().unwrap();
    let mut drawn = Drawn(seed);
    let mut errors = ErrorFunctions::default();
    for slide in Axis::ALL {
        for component in ["X", "Y", "Z", "A", "B", "C"] {
            let turns = ["A", "B", "C"].contains(&component);
            for (power, size) in [('1', 6e-5), ('2', 1.5e-7), ('3', 7e-10), ('b', 3e-3)] {
                let size = match (turns, power) {
                    (false, _) => size,
                    (true, '1') => 2e-7,
                    (true, 'b') => 3e-6,
                    (true, _) => continue,
                };
                let name = format!("E{component}{slide}{power}");
                let value = size * drawn.bell();
                // On the workpiece side a slide that lags leaves the tool ahead.
                let lost = power == 'b' && name.starts_with(&format!("E{slide}{slide}"));
                let lost_mm = -machine.topology().side(slide).sign() * value.abs();
                errors.set(Coefficient::parse(&name).unwrap(), if lost { lost_mm } else { value });
            }
        }
    }
    errors
}

/// From the workpiece ball to the tool ball through the exact chain, mm.
pub(crate) fn ball_vector_mm(
    machine: &Machine,
    errors: &ErrorFunctions,
    mounting: &Mounting,
    pose: &Pose,
) -> Vector3<f64> {
    let slides = Axis::ALL.map(|axis| errors.slide_error(axis, pose));
    let chain = ChainErrors { slides, ..ChainErrors::zero() };
    machine.ball_vector_mm(mounting, &pose.position_mm, &chain)
}

/// Displacement of the tool against the workpiece where it touches it, mm.
pub(crate) fn true_mm(
    machine: &Machine,
    errors: &ErrorFunctions,
    tool_mm: Vector3<f64>,
    pose: &Pose,
) -> Vector3<f64> {
    let touching = Mounting { coincidence_mm: pose.position_mm, tool_ball_mm: tool_mm };
    ball_vector_mm(machine, errors, &touching, pose)
}

/// A test of a built-in machine, run on one with these errors and analysed.
pub(crate) fn analysed(machine: &str, errors: &ErrorFunctions, rest: &str) -> Work {
    repeated(machine, errors, rest, "1")
}

/// The same, identified only.
pub(crate) fn identified(machine: &str, errors: &ErrorFunctions, rest: &str) -> Work {
    let work = simulated(machine, errors, rest, "1");
    work.plain(&["identify", "base/test.toml", "-o", "base", "--overwrite"]).done();
    work
}

/// The same, driven so often.
pub(crate) fn repeated(machine: &str, errors: &ErrorFunctions, rest: &str, repeats: &str) -> Work {
    let work = simulated(machine, errors, rest, repeats);
    work.plain(&["analyse", "base/test.toml", "-o", "base", "--overwrite"]).done();
    work
}

/// The logs of it.
fn simulated(machine: &str, errors: &ErrorFunctions, rest: &str, repeats: &str) -> Work {
    let work = Work::new();
    let file = project().join(format!("machines/{machine}.toml"));
    let mut scenario =
        "seed = 5\n[set_up]\nEXt = 0.01\nEYt = -0.02\n[noise]\nwhite_um = 0.1\ncorrelated_um = 0.0\n[coefficients]\n"
            .to_owned();
    for of in Coefficient::all().filter(|of| errors.get(*of) != 0.0) {
        let _ = writeln!(scenario, "{of} = {:e}", errors.get(of));
    }
    let machine = std::fs::read_to_string(file).unwrap();
    assert!(machine.contains("decimals = 3"));
    // Rounding of its program is to be none of what is left.
    let machine = machine.replace("decimals = 3", "decimals = 5");
    work.write("machine.toml", machine).write("scenario.toml", scenario);
    work.write(
        "test.toml",
        format!("name = \"Known\"\nmachine = \"machine.toml\"\n\n[ball_bar]\nlength_mm = 100.0\n\n{rest}"),
    );
    let simulate = [
        "simulate",
        "test.toml",
        "--scenario",
        "scenario.toml",
        "-o",
        "base",
        "--repeats",
        repeats,
    ];
    work.plain(&simulate).done();
    work
}

pub(crate) const HU40T: &str = "[[mounting]]\nname = \"A\"\ncoincidence_mm = [20.0, -35.0, 40.0]\n\
    tool_ball_mm = [0.0, 0.0, -200.0]\n\n[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 1000.0\n";
pub(crate) const VERTICAL: &str = "[[mounting]]\nname = \"A\"\ncoincidence_mm = [120.0, 60.0, -260.0]\n\
    tool_ball_mm = [0.0, 0.0, -150.0]\n\n[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 1000.0\n";

/// Without the best rigid motion.
pub(crate) fn rested(at: &[Vector3<f64>], errors: &mut [Vector3<f64>]) {
    let middle = at.iter().sum::<Vector3<f64>>() / at.len() as f64;
    let row = |p: &Vector3<f64>, k: usize| {
        let (along, turned) =
            (Vector3::ith(k, 1.0), ((p - middle) / 100.0).cross(&Vector3::ith(k, 1.0)));
        Vector6::new(along.x, along.y, along.z, turned.x, turned.y, turned.z)
    };
    let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
    for (p, e) in at.iter().zip(&*errors) {
        for k in 0..3 {
            normal += row(p, k) * row(p, k).transpose();
            right += row(p, k) * e[k];
        }
    }
    let motion = normal.lu().solve(&right).unwrap();
    for (p, e) in at.iter().zip(errors) {
        *e -= Vector3::from_fn(|k, _| row(p, k).dot(&motion));
    }
}

#[test]
fn the_map_is_within_what_it_says_of_itself_of_the_exact_chain() {
    for (name, rest, seed) in [("hu40t", HU40T, 1), ("vertical", VERTICAL, 2)] {
        let errors = drawn_errors(name, seed);
        let work = analysed(name, &errors, rest);
        let read = Analysed::read(&work.path("base/analysis.json"), None).unwrap();
        let machine = Builtin::named(name).unwrap().machine().unwrap();
        let tool_mm = Vector3::new(0.0, 0.0, read.errors.mountings[0].1.tool_ball_mm.z - 40.0);
        let field = Field::new(&read.errors, tool_mm).unwrap();
        let measured = Measured::by(&read.errors);
        let [low, high] = measured.range_mm();
        let middle = Pose { position_mm: read.errors.frame.middle_mm, sense: Vector3::zeros() };
        let (from, true_from) =
            (field.displacement(&middle), true_mm(&machine, &errors, tool_mm, &middle));
        let mut drawn = Drawn(seed + 70);
        let (mut poses, mut within, mut worst) = (0, 0, 0.0_f64);
        while poses < 10_000 {
            let share = Vector3::from_fn(|_, _| drawn.uniform());
            let position_mm = low + share.component_mul(&(high - low));
            if !measured.is_near(&position_mm) {
                continue;
            }
            let sense = Vector3::from_fn(|_, _| if drawn.uniform() < 0.5 { -1.0 } else { 1.0 });
            let pose = Pose { position_mm, sense };
            let of = field.displacement(&pose);
            let (told, truth) = (
                of.error_mm - from.error_mm,
                true_mm(&machine, &errors, tool_mm, &pose) - true_from,
            );
            let inside = (0..3).all(|k| {
                let mut row = Row::zero(field.width());
                row.add(&of.rows[k], 1.0);
                row.add(&from.rows[k], -1.0);
                let apart = (told[k] - truth[k]).abs() / field.sigmas(&row).all;
                worst = worst.max(apart);
                apart < 2.0
            });
            poses += 1;
            within += usize::from(inside);
        }
        println!("{name}: {within} of {poses} poses within twice all, worst {worst:.2}");
        assert!(within * 100 >= poses * 95, "{name}: {within} of {poses}, worst {worst}");

        // The same without the rigid motion, which no length shows and which is most of what is open.
        let volume = Volume { ends_mm: [low, high], points: 9, keep_rigid: false };
        let map = VolumeMap::of(&field, &volume);
        let places: Vec<Vector3<f64>> = map.nodes.iter().map(|node| node.position_mm).collect();
        let mut truth: Vec<Vector3<f64>> = places
            .iter()
            .map(|p| {
                true_mm(
                    &machine,
                    &errors,
                    tool_mm,
                    &Pose { position_mm: *p, sense: Vector3::zeros() },
                )
            })
            .collect();
        rested(&places, &mut truth);
        let near: Vec<_> = map.nodes.iter().zip(&truth).filter(|(node, _)| node.near).collect();
        let square = |of: fn(&f64) -> f64, values: Vec<f64>| {
            (values.iter().map(of).sum::<f64>() / values.len() as f64).sqrt()
        };
        let of_truth = square(|v| v * v, near.iter().map(|(_, t)| t.norm()).collect());
        let left = near
            .iter()
            .map(|(node, t)| (Vector3::from(node.error.map(|e| e.value_mm)) - *t).norm());
        let left = square(|v| v * v, left.collect());
        let said = square(|v| v * v, near.iter().map(|(node, _)| node.unknown.all).collect());
        let inside = near.iter().flat_map(|(node, t)| {
            (0..3).map(|k| (node.error[k].value_mm - t[k]).abs() < 2.0 * node.error[k].sigmas.all)
        });
        let inside: Vec<bool> = inside.collect();
        let share = inside.iter().filter(|of| **of).count() as f64 / inside.len() as f64;
        println!(
            "{name}: truth {:.2} um rms, apart {:.2}, said {:.2}, within twice all {share:.3}",
            1e3 * of_truth,
            1e3 * left,
            1e3 * said
        );
        assert!(share >= 0.95 && left < 1.5 * said, "{name}: {share} {left} {said}");
    }
}

#[test]
fn a_map_of_an_analysis_is_that_of_its_test_and_its_files_are_documented() {
    let work = analysed("vertical", &drawn_errors("vertical", 3), VERTICAL);
    let of_analysis = work.plain(&["volume", "base", "-o", "map", "--json"]).done().stdout();
    let map: Value = serde_json::from_str(&of_analysis).unwrap();
    assert_eq!(map["format"], "ballbar.volume/1");
    let of_test =
        work.plain(&["volume", "base/test.toml", "-o", "again", "--json"]).done().stdout();
    let again: Value = serde_json::from_str(&of_test).unwrap();
    let largest = |of: &Value| of["near"]["largest"]["value_um"].as_f64().unwrap();
    assert!((largest(&map) - largest(&again)).abs() < 1e-6 * largest(&map), "{map} {again}");
    let csv = std::fs::read_to_string(work.path("map/volume.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 9 * 9 * 9);
    let page = std::fs::read_to_string(work.path("map/volume.html")).unwrap();
    assert!(
        page.contains("What a laser would read")
            && !page.contains("NaN")
            && !page.contains("<script")
    );
    assert_eq!(map["lines"].as_array().unwrap().len(), 3 + 6 + 4);
    // No longer tool: where it was measured the errors are smaller than over the travel.
    let travel =
        work.plain(&["volume", "base", "--travel", "-o", "travel", "--json"]).done().stdout();
    let travel: Value = serde_json::from_str(&travel).unwrap();
    let unknown = |of: &Value| of["unknown_all_um"].as_f64().unwrap();
    assert!(unknown(&travel["whole"]) > 2.0 * unknown(&map["near"]), "{travel}");
    assert!(travel["verdict"].to_string().contains("nobody has looked there"));
    let schema = include_str!("../../docs/volume-schema.md");
    let documented: Vec<&str> =
        schema.split('`').skip(1).step_by(2).flat_map(|code| code.split(['.', '['])).collect();
    names(&map, &mut |name| assert!(documented.contains(&name), "`{name}` is not in the schema"));
    for column in csv.lines().next().unwrap().split(',') {
        assert!(documented.contains(&column), "`{column}` is not in the schema");
    }
}

pub(crate) fn names(value: &Value, told: &mut impl FnMut(&str)) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| {
            told(name);
            names(value, told);
        }),
        Value::Array(values) => values.iter().for_each(|value| names(value, told)),
        _ => {}
    }
}

#[test]
fn an_analysis_of_another_machine_or_of_named_terms_is_refused() {
    let work = analysed("vertical", &drawn_errors("vertical", 4), VERTICAL);
    let other = project().join("machines/hu40t.toml").display().to_string();
    let told = work.plain(&["volume", "base", "--machine", &other]).refused(1);
    assert!(told.contains("this analysis is of `Vertical machining centre`"), "{told}");
    let told = work.plain(&["volume", "base", "--box", "0,100,0,100,0,900"]).refused(1);
    assert!(told.contains("the travel from -500 to 100 mm"), "{told}");
    let mut analysis: Value =
        serde_json::from_slice(&std::fs::read(work.path("base/analysis.json")).unwrap()).unwrap();
    analysis["error_model"]["reach_mm"][0] = (-4.0).into();
    work.write("base/bad.json", analysis.to_string());
    let told = work.plain(&["volume", "base/bad.json"]).refused(1);
    assert!(told.contains("`middle_mm` and `reach_mm`"), "{told}");
    analysis["error_model"] = Value::Null;
    work.write("base/bad.json", analysis.to_string());
    let told = work.plain(&["volume", "base/bad.json"]).refused(1);
    assert!(told.contains("terms = [\"local\"]"), "{told}");
    std::fs::remove_file(work.path("machine.toml")).unwrap();
    let told = work.plain(&["volume", "base"]).refused(1);
    assert!(told.contains("--machine FILE"), "{told}");
}
