//! `compensate`: what each control is given leaves what is stated, with the right sign on both sides of the machine; what is refused.

use ballbar::compensate::{
    Analysed, Compensating, Compensation, Control, ErrorModel, Field, Measured, Named, Tables,
};
use ballbar::machine::{Axis, Builtin, Machine, Pose};
use ballbar::model::{Coefficient, ErrorFunctions};
use nalgebra::Vector3;
use serde_json::Value;

use crate::volume::{HU40T, VERTICAL, analysed, drawn_errors, names, rested, true_mm};
use crate::work::{Work, data, unpacked};

const SENSES: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

/// Middles of the cells of a grid within what was measured.
fn points(errors: &ErrorModel) -> Vec<Vector3<f64>> {
    const CELLS: usize = 24;
    let measured = Measured::by(errors);
    let [low, high] = measured.range_mm();
    let at = |k: usize| {
        let of = [k % CELLS, k / CELLS % CELLS, k / CELLS / CELLS];
        let share = Vector3::from(of.map(|k| (k as f64 + 0.5) / CELLS as f64));
        low + (high - low).component_mul(&share)
    };
    (0..CELLS.pow(3)).map(at).filter(|p| measured.beyond_mm(p) <= 1e-6).collect()
}

/// Root mean square of errors, without the rigid motion that fits their mean over senses best, um.
fn rms_um(points: &[Vector3<f64>], of: impl Fn(&Pose) -> Vector3<f64>) -> f64 {
    let each = points
        .iter()
        .flat_map(|p| SENSES.map(|sense| Pose { position_mm: *p, sense: sense.into() }));
    let poses: Vec<Pose> = each.collect();
    let at: Vec<Vector3<f64>> = poses.iter().map(|pose| pose.position_mm).collect();
    let mut errors: Vec<Vector3<f64>> = poses.iter().map(of).collect();
    rested(&at, &mut errors);
    1e3 * (errors.iter().map(Vector3::norm_squared).sum::<f64>() / errors.len() as f64).sqrt()
}

/// What a command wrote for a control, as its reader has it.
fn read_back(work: &Work, folder: &str, control: Control, told: &Value) -> (Vec<Named>, Tables) {
    let names =
        told["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned());
    let files: Vec<Named> = names
        .map(|name| {
            let text = std::fs::read_to_string(work.path(&format!("{folder}/{name}"))).unwrap();
            (name, text)
        })
        .collect();
    let tables = control.read(&files, &control.limits()).unwrap();
    (files, tables)
}

/// Runs the command for a control.
fn compensated(work: &Work, control: Control, more: &[&str]) -> (Value, String) {
    let folder = format!("for-{}-{}", control.name(), more.len());
    let mut arguments =
        vec!["compensate", "base", "--for", control.name(), "-o", &folder, "--json"];
    arguments.extend(more);
    let told = work.plain(&arguments).done().stdout();
    (serde_json::from_str(&told).unwrap(), folder)
}

#[test]
fn what_each_control_leaves_is_what_it_says() {
    for (name, rest, seed) in [("hu40t", HU40T, 21), ("vertical", VERTICAL, 22)] {
        let errors = drawn_errors(name, seed);
        let work = analysed(name, &errors, rest);
        let read = Analysed::read(&work.path("base/analysis.json"), None).unwrap();
        let machine = read.errors.machine.clone();
        let truth = Builtin::named(name).unwrap().machine().unwrap();
        let tool = read.errors.mountings[0].1.tool_ball_mm;
        let (shrunk, _) = read.errors.shrunk();
        let field = Field::new(&shrunk, tool).unwrap();
        let points = points(&shrunk);
        let before = rms_um(&points, |pose| field.error_mm(pose));
        let truly = rms_um(&points, |pose| true_mm(&truth, &errors, tool, pose));
        let mut left = Vec::new();
        let most = ["--tables", "20"];
        for control in Control::ALL {
            let more: &[&str] = if control == Control::Siemens { &most } else { &[] };
            let (told, folder) = compensated(&work, control, more);
            let (_, tables) = read_back(&work, &folder, control, &told);
            let sent = |pose: &Pose| {
                let taken_mm = tables.error_mm(&machine, tool, pose);
                Pose { position_mm: pose.position_mm - taken_mm, ..*pose }
            };
            let after = rms_um(&points, |pose| {
                let sent = sent(pose);
                sent.position_mm + field.error_mm(&sent) - pose.position_mm
            });
            // The machine as it is, and not as the analysis has it.
            let in_truth = rms_um(&points, |pose| {
                let sent = sent(pose);
                sent.position_mm + true_mm(&truth, &errors, tool, &sent) - pose.position_mm
            });
            let stated = |key: &str| told[key]["rms_um"].as_f64().unwrap();
            println!(
                "{name} {}: {before:.2} um before, {after:.3} after, {:.3} stated; in truth {truly:.2} and {in_truth:.2}",
                control.name(),
                stated("after")
            );
            assert!((before - stated("before")).abs() < 0.01 * before, "{}", control.name());
            assert!((after - stated("after")).abs() < 0.01 * after + 1e-3, "{}", control.name());
            assert!(in_truth < truly, "{}: {in_truth} {truly}", control.name());
            left.push(after / before);
        }
        // What holds all but rounding; all but what turns with the sense; all but angles; and the rest in part.
        let [linuxcnc, siemens, fanuc, isg, csv, klipper, marlin, reprap, grbl] = left[..] else {
            unreachable!()
        };
        assert!(csv < 0.02 && siemens < 0.2 && isg < 0.75, "{left:?}");
        for part in [linuxcnc, fanuc, klipper, marlin, reprap, grbl] {
            assert!(part < 0.95, "{left:?}");
        }
    }
}

/// A machine with one number for everything that a small control has a word for.
fn plain_errors(machine: &Machine) -> ErrorFunctions {
    let mut errors = ErrorFunctions::default();
    for axis in Axis::ALL {
        // On the workpiece side a slide that goes too far takes the workpiece with it.
        let side = machine.topology().side(axis).sign();
        let mut set =
            |name: &str, value: f64| errors.set(Coefficient::parse(name).unwrap(), side * value);
        let k = axis.index() as f64;
        set(&format!("E{axis}{axis}1"), 40e-6 + 20e-6 * k);
        set(&format!("E{axis}{axis}b"), -2e-3 - 1e-3 * k);
    }
    for (name, slide, value) in
        [("EXY1", Axis::Y, 50e-6), ("EXZ1", Axis::Z, -80e-6), ("EYZ1", Axis::Z, 120e-6)]
    {
        errors
            .set(Coefficient::parse(name).unwrap(), machine.topology().side(slide).sign() * value);
    }
    errors
}

/// Numbers that stand behind a name at the start of a line.
fn numbers(text: &str, start: &str) -> Vec<f64> {
    let lines = text.lines().filter_map(|line| line.strip_prefix(start));
    lines.map(|rest| rest.trim().parse().unwrap()).collect()
}

#[test]
fn signs_are_those_of_the_formats_on_both_sides_of_the_machine() {
    for (name, rest) in [("hu40t", HU40T), ("vertical", VERTICAL)] {
        let machine = Builtin::named(name).unwrap().machine().unwrap();
        let work = analysed(name, &plain_errors(&machine), rest);
        let texts = |control: Control, more: &[&str]| {
            let (told, folder) = compensated(&work, control, more);
            (read_back(&work, &folder, control, &told).0, told)
        };
        let close = |value: f64, truth: f64, within: f64| {
            assert!((value - truth).abs() < within, "{name}: {value} {truth}");
        };
        let (files, told) = texts(Control::Linuxcnc, &[]);
        for (k, (file, text)) in files.iter().take(3).enumerate() {
            assert_eq!(*file, format!("joint{k}.comp"));
            let rows: Vec<Vec<f64>> = text
                .lines()
                .map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect())
                .collect();
            let (first, last) = (&rows[0], &rows[rows.len() - 1]);
            let way = last[0] - first[0];
            // Actual positions: too far by the scale, and behind by the lost motion.
            // Of its ends: an S of a way is not told from others.
            close((last[1] - first[1]) / way - 1.0, 40e-6 + 20e-6 * k as f64, 15e-6);
            close(last[2] - last[1], 2.0 * (2e-3 + 1e-3 * k as f64), 0.2e-3);
        }
        // The one point of the page, by the same files.
        for point in told["one_point"].as_array().unwrap() {
            let of = |key: &str| point[key].as_f64().unwrap();
            let k = ["X", "Y", "Z"].iter().position(|axis| point["slide"] == *axis).unwrap();
            let scale = 40.0 + 20.0 * k as f64;
            close(of("off_um"), scale * (of("to_mm") - of("from_mm")) * 1e-3, 3.0);
            close(of("left_um"), 0.0, 0.05);
            close(of("left_if_signs_are_wrong_um"), 2.0 * of("off_um"), 0.1);
        }
        let (files, _) = texts(Control::Siemens, &["--tables", "20"]);
        let (lec, cec) = (&files[0].1, &files[1].1);
        for (k, axis) in ["X1", "Y1", "Z1"].iter().enumerate() {
            let step = numbers(lec, &format!("$AA_ENC_COMP_STEP[0,{axis}]="))[0];
            let values: Vec<f64> = (0..200)
                .flat_map(|i| numbers(lec, &format!("$AA_ENC_COMP[0,{i},{axis}]=")))
                .collect();
            let steepest =
                values.windows(2).map(|pair| (pair[1] - pair[0]) / step).fold(0.0, f64::max);
            close(steepest, 40e-6 + 20e-6 * k as f64, 25e-6);
        }
        // The table of Y on X: the correction of +Y leaning to +X goes to -X.
        let table = (0..20).find(|t| {
            cec.contains(&format!("$AN_CEC_INPUT_AXIS[{t}]=(AX2)\n$AN_CEC_OUTPUT_AXIS[{t}]=(AX1)"))
        });
        let table = table.unwrap();
        let values: Vec<f64> =
            (0..200).flat_map(|i| numbers(cec, &format!("$AN_CEC[{table},{i}]="))).collect();
        let step = numbers(cec, &format!("$AN_CEC_STEP[{table}]="))[0];
        close(
            (values[values.len() - 1] - values[0]) / (step * (values.len() - 1) as f64),
            -50e-6,
            10e-6,
        );
        let (files, _) = texts(Control::Fanuc, &[]);
        let pitch = &files[0].1;
        for k in 0..3 {
            let of = |number: u32| numbers(pitch, &format!("N{number} P{} R", k + 1))[0];
            let changes: Vec<f64> = (of(3621) as u32..=of(3622) as u32)
                .flat_map(|point| numbers(pitch, &format!("N{} R", 10_000 + point)))
                .collect();
            // Within what was measured the correction falls; of 1 um each.
            let total: f64 = changes.iter().sum::<f64>() * of(3623);
            close(total, -200.0 * (40e-3 + 20e-3 * f64::from(k)), 4.0);
            close(of(1851), 4.0 + 2.0 * f64::from(k), 1.1);
        }
        let (files, _) = texts(Control::Klipper, &[]);
        close(numbers(&files[0].1, "xy_skew =")[0], 50e-6, 3e-6);
        close(numbers(&files[0].1, "xz_skew =")[0], -80e-6, 3e-6);
        close(numbers(&files[0].1, "yz_skew =")[0], 120e-6, 3e-6);
        close(
            numbers(&files[0].1, "# multiply rotation_distance of stepper_z by")[0],
            1.0 + 80e-6,
            15e-6,
        );
        let words = |text: &str, start: &str| -> Vec<f64> {
            let line = text.lines().find(|line| line.starts_with(start)).unwrap();
            line.split(' ').skip(1).map(|word| word[1..].parse().unwrap()).collect()
        };
        let (files, _) = texts(Control::Marlin, &[]);
        let skew = words(&files[0].1, "M852");
        close(skew[0], 50e-6, 3e-6);
        close(skew[2], 120e-6, 3e-6);
        close(words(&files[0].1, "M425")[1], 4e-3, 0.2e-3);
        close(numbers(&files[0].1, "; multiply M92 X by")[0], 1.0 - 40e-6, 15e-6);
        // S100 X Y Z: XY, YZ, XZ, and it adds.
        let (files, _) = texts(Control::Reprapfirmware, &[]);
        let skew = words(&files[0].1, "M556");
        close(skew[1], -50e-4, 3e-4);
        close(skew[2], -120e-4, 3e-4);
        close(skew[3], 80e-4, 3e-4);
        let (files, told) = texts(Control::Grblhal, &[]);
        close(numbers(&files[0].1, "$162=")[0], 8e-3, 0.2e-3);
        assert_eq!(told["lost"].as_array().unwrap().len(), 3);
    }
}

/// The third slide of a plane stands still: nothing is known of it, nothing is written for it, and what was active is kept.
#[test]
fn a_slide_that_stood_still_is_left_as_it_is() {
    let plane = VERTICAL.replace("strategy = \"3d6\"", "strategy = \"xy\"");
    let work = analysed("vertical", &drawn_errors("vertical", 22), &plane);
    for control in Control::ALL {
        let (told, folder) = compensated(&work, control, &[]);
        let (_, tables) = read_back(&work, &folder, control, &told);
        let rms_um = |key: &str| told[key]["rms_um"].as_f64().unwrap();
        assert!(rms_um("after") < rms_um("before"), "{}", control.name());
        let of_z = tables.columns.iter().filter(|column| column.over == Axis::Z);
        let largest_mm =
            of_z.flat_map(|column| &column.error_mm).fold(0.0, |most: f64, e| most.max(e.abs()));
        assert!(largest_mm < 1e-6, "{}: {largest_mm}", control.name());
    }
    work.write("joint2.comp", "-400.0 -400.002 -400.002\n-100.0 -99.995 -99.995\n");
    let (told, folder) = compensated(&work, Control::Linuxcnc, &["--on-top", "joint2.comp"]);
    let (_, tables) = read_back(&work, &folder, Control::Linuxcnc, &told);
    let column = tables.columns.iter().find(|column| column.over == Axis::Z).unwrap();
    let changes_mm = column.error_mm[0] - column.error_mm[column.error_mm.len() - 1];
    assert!((changes_mm.abs() - 7e-3).abs() < 1e-5, "{changes_mm}");
}

/// The cyclic error of that test has a pitch of 10 mm and an amplitude of 1 um.
#[test]
fn a_short_wave_is_followed_or_left_alone() {
    let work = Work::new();
    let test = data("planar250").join("test.toml");
    work.plain(&["analyse", test.to_str().unwrap(), "-o", "base"]).done();
    let left_um = |control: Control, more: &[&str], group: &str| {
        let (told, _) = compensated(&work, control, more);
        let groups = told["groups"].as_array().unwrap();
        let of = groups.iter().find(|of| of["name"] == group).unwrap();
        (of["after_rms_um"].as_f64().unwrap(), told["lost"].to_string())
    };
    for (control, more) in
        [(Control::Linuxcnc, &[][..]), (Control::Siemens, &["--points", "2000"][..])]
    {
        let (left, lost) = left_um(control, more, "positioning X");
        assert!(left < 0.05 && lost == "[]", "{}: {left} {lost}", control.name());
    }
    // Points 8 mm apart would make a wave of 40 mm of it.
    for control in [Control::Linuxcnc, Control::Siemens] {
        let (left, lost) = left_um(control, &["--step", "8"], "positioning X");
        assert!(left < 0.72 && lost.contains("too few points for X"), "{left} {lost}");
    }
    for axis in ["X", "Y"] {
        let play = format!("lateral play of {axis}, half of it");
        let (left, _) = left_um(Control::Siemens, &[], &play);
        assert!(left < 0.01, "{play}: {left}");
    }
}

/// Nobody cuts a circle exactly through the middle of the ball: of what is across it such a plane says no more, and noise is not
/// taken for it.
#[test]
fn a_plane_beside_the_ball_is_one_plane() {
    let work = Work::new();
    let set = data("planar250");
    for name in ["machine.toml", "run1.csv.gz", "run2.csv.gz"] {
        work.write(name, std::fs::read(set.join(name)).unwrap());
    }
    let test = std::fs::read_to_string(set.join("test.toml")).unwrap();
    let program = unpacked(&set.join("O4002.nc.gz"));
    work.write("test.toml", test.replace("O4002.nc.gz", "O4002.nc"))
        .write("O4002.nc", program.replace("Y0. Z0. F", "Y0. Z0.05 F"));
    let told = work.plain(&["analyse", "test.toml", "-o", "base"]).done();
    let told = told.stdout().split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, unseen) = told.split_once("Not seen in this test: ").unwrap();
    let (unseen, _) = unseen.split_once('.').unwrap();
    for slide in ["X", "Y"] {
        let about = if slide == "X" { "C" } else { "" };
        for turned in ["A", "B", "C"] {
            let angle = format!("angle E{turned}{slide}");
            assert_eq!(unseen.contains(&angle), turned != about, "{angle}: {unseen}");
        }
    }
    let (told, _) = compensated(&work, Control::Linuxcnc, &[]);
    let [before, noise] = [&told["before"]["rms_um"], &told["unknown_noise_um"]];
    let [before, noise] = [before, noise].map(|um| um.as_f64().unwrap());
    assert!((1.0..3.0).contains(&before) && noise < 0.5, "{before} {noise}");
}

#[test]
fn what_cannot_be_compensated_is_refused() {
    let work = analysed("vertical", &drawn_errors("vertical", 23), VERTICAL);
    let other = std::fs::read_to_string(work.path("machine.toml")).unwrap();
    work.write("other.toml", other.replacen("name = \"", "name = \"Not the ", 1));
    let refused = |more: &[&str], code: i32| {
        let mut arguments = vec!["compensate", "base", "-o", "tables"];
        arguments.extend(more);
        work.plain(&arguments).refused(code)
    };
    let told = refused(&["--for", "siemens", "--machine", "other.toml"], 1);
    assert!(told.contains("this analysis is of"), "{told}");
    let told = refused(&["--for", "fanuc", "--step", "1", "--points", "20"], 1);
    assert!(told.contains("and the control has 20"), "{told}");
    let told = refused(&["--for", "isg", "--at", "0,0,9999"], 1);
    assert!(told.contains("beyond the travel"), "{told}");
    assert!(!work.path("tables").exists());
    let (told, _) = compensated(&work, Control::Siemens, &["--tables", "2", "--points", "5"]);
    let schema = include_str!("../../docs/compensation-schema.md");
    let documented: Vec<&str> =
        schema.split('`').skip(1).step_by(2).flat_map(|code| code.split(['.', '['])).collect();
    names(&told, &mut |name| assert!(documented.contains(&name), "`{name}` is not in the schema"));
    let lost: Vec<&str> =
        told["lost"].as_array().unwrap().iter().map(|l| l.as_str().unwrap()).collect();
    assert!(lost.iter().any(|lost| lost.contains("no table is left")), "{lost:?}");
    assert!(lost.iter().any(|lost| lost.contains("too few points")), "{lost:?}");

    // So it is told of LinuxCNC and ISG, too, and nothing where there are enough.
    for control in [Control::Linuxcnc, Control::Isg] {
        let few = |more: &[&str]| {
            let (told, _) = compensated(&work, control, more);
            let lost = told["lost"].as_array().unwrap().iter();
            let about = lost.filter(|lost| lost.as_str().unwrap().contains("too few points for"));
            about.count()
        };
        assert_eq!(few(&["--points", "3"]), 3, "{}", control.name());
        assert_eq!(few(&[]), 0, "{}", control.name());
    }

    // Errors a hundred times as large are none that a table should hide.
    let mut read = Analysed::read(&work.path("base/analysis.json"), None).unwrap();
    let asked = |errors: &ErrorModel| Compensating {
        control: Control::Csv,
        limits: Control::Csv.limits(),
        tool_ball_mm: errors.mountings[0].1.tool_ball_mm,
        place_mm: errors.frame.middle_mm,
        existing: Vec::new(),
    };
    assert!(Compensation::of(&read.errors, &asked(&read.errors)).is_ok());
    read.errors.values.iter_mut().for_each(|value| *value *= 100.0);
    let told = Compensation::of(&read.errors, &asked(&read.errors)).unwrap_err().to_string();
    assert!(told.contains("more than 0.5 mm is none"), "{told}");

    // On top of itself it is twice as much.
    let (told, folder) = compensated(&work, Control::Linuxcnc, &[]);
    let (_, once) = read_back(&work, &folder, Control::Linuxcnc, &told);
    let file = format!("{folder}/joint1.comp");
    let (told, folder) = compensated(&work, Control::Linuxcnc, &["--on-top", &file]);
    let (_, twice) = read_back(&work, &folder, Control::Linuxcnc, &told);
    let of = |tables: &Tables| {
        let column = tables.columns.iter().find(|column| column.over == Axis::Y).unwrap();
        column.error_mm[0] - column.error_mm[column.error_mm.len() - 1]
    };
    assert!((of(&twice) - 2.0 * of(&once)).abs() < 1e-5, "{} {}", of(&twice), of(&once));
    assert_eq!(told["holds_what_was_active"], true);

    let still = analysed("vertical", &ErrorFunctions::default(), VERTICAL);
    let told = still.plain(&["compensate", "base", "--for", "csv", "-o", "tables"]).refused(4);
    assert!(told.contains("smaller than their noise"), "{told}");
}

#[test]
fn readers_take_nothing_that_is_not_written() {
    let work = analysed("hu40t", &drawn_errors("hu40t", 24), HU40T);
    for control in Control::ALL {
        let (told, folder) = compensated(&work, control, &[]);
        let (files, _) = read_back(&work, &folder, control, &told);
        let reads = |files: &[Named]| control.read(files, &control.limits());
        let faulty = |change: &dyn Fn(&str) -> String| {
            let mut files = files.clone();
            files[0].1 = change(&files[0].1);
            reads(&files).expect_err(control.name());
        };
        faulty(&|text| format!("{text}nonsense 1\n"));
        faulty(&|text| format!("nonsense 1\n{text}"));
        let number = files[0].1.rfind(|c: char| c.is_ascii_digit()).unwrap();
        faulty(&|text| format!("{}e999{}", &text[..=number], &text[number + 1..]));
        let mut named = files.clone();
        named[0].0 = "other".into();
        reads(&named).expect_err(control.name());
        reads(&[]).expect_err(control.name());
    }
}
