//! LinuxCNC: a `COMP_FILE` of type 0 for each joint, or `BACKLASH` where nothing but lost motion is there.
//!
//! A line has the nominal position and the actual ones when it is reached in the positive and in the negative direction; the motor goes
//! to `commanded + nominal - actual`. The file is read as far as its lines begin with three numbers, 256 of them; so there
//! is no header and no comment. Source: `usrmotLoadComp` and `compute_screw_comp` of LinuxCNC 2.9.

use std::fmt::Write as _;

use super::asked::{Limits, Named, SMALLEST_MM, Written};
use super::lines::{lines, whole};
use super::points::Asked;
use crate::compensate::tables::{Column, Tables, Ways};
use crate::compensate::wanted::Wanted;
use crate::error::Result;
use crate::machine::Axis;

/// Lines that LinuxCNC keeps (`EMCMOT_COMP_SIZE`).
pub(super) const MOST_POINTS: usize = 256;
const INI: &str = "compensation.ini";

fn name(axis: Axis) -> String {
    format!("joint{}.comp", axis.index())
}

pub(super) fn write(wanted: &Wanted, limits: &Limits) -> Written {
    let mut written = Written::default();
    let mut ini = String::from(
        "# for the INI file of the machine, LINEAR_UNITS = mm; X, Y, Z are joints 0, 1, 2\n",
    );
    let limits = Limits { most_points: limits.most_points.min(MOST_POINTS), ..*limits };
    for axis in Axis::ALL {
        let of = |sense: f64| move |at: f64| wanted.error_mm(axis, axis, at, sense);
        let bend_mm = wanted.extent_mm(of(0.0), axis);
        let play_mm = wanted.play_mm(axis);
        let changes_mm = wanted.extent_mm(|at| of(1.0)(at) - of(-1.0)(at), axis);
        let _ = writeln!(ini, "[JOINT_{}]", axis.index());
        if bend_mm < SMALLEST_MM && changes_mm < SMALLEST_MM && play_mm >= 0.0 {
            if play_mm >= SMALLEST_MM {
                let _ = writeln!(ini, "BACKLASH = {play_mm:.6}");
            }
            continue;
        }
        let _ = writeln!(
            ini,
            "# BACKLASH has no effect beside this\nCOMP_FILE = {}\nCOMP_FILE_TYPE = 0",
            name(axis)
        );
        // Beyond its ends a table holds.
        let asked = Asked { wanted, over: axis, along: &[axis] };
        let points = asked.parts(&limits, &mut written.lost);
        let mut text = String::new();
        for at in &points.at_mm {
            let [plus, minus] = [1.0, -1.0].map(|sense| at + points.value(of(sense), *at));
            let _ = writeln!(text, "{at:.4} {plus:.6} {minus:.6}");
        }
        written.files.push((name(axis), text));
    }
    written.files.push((INI.into(), ini));
    written.load = vec![
        "Copy the files beside the INI file, and the lines of compensation.ini into its sections; a COMP_FILE that stands there already is replaced.".into(),
        "Start LinuxCNC again, and home.".into(),
    ];
    written
}

pub(super) fn read(files: &[Named]) -> Result<Tables> {
    let mut tables = Tables::default();
    for file in files {
        if file.0 == INI {
            read_ini(file, &mut tables)?;
            continue;
        }
        let Some(axis) = Axis::ALL.into_iter().find(|axis| name(*axis) == file.0) else {
            return Err(whole(&file.0, "no file of a joint has this name"));
        };
        let (mut at_mm, mut plus, mut minus) = (Vec::new(), Vec::new(), Vec::new());
        for line in lines(file)? {
            let words: Vec<&str> = line.text.split_whitespace().collect();
            let [nominal, up, down] = words[..] else {
                return Err(line.faulty("LinuxCNC stops reading at a line without three numbers"));
            };
            let [nominal, up, down] = [line.number(nominal)?, line.number(up)?, line.number(down)?];
            if at_mm.last().is_some_and(|before| *before >= nominal) {
                return Err(line.faulty("positions must ascend"));
            }
            if at_mm.len() == MOST_POINTS {
                return Err(line.faulty(format!("LinuxCNC reads {MOST_POINTS} lines")));
            }
            at_mm.push(nominal);
            plus.push(up - nominal);
            minus.push(down - nominal);
        }
        if at_mm.is_empty() {
            return Err(whole(&file.0, "it has no line"));
        }
        for (ways, error_mm) in [(Ways::Plus, plus), (Ways::Minus, minus)] {
            let at_mm = at_mm.clone();
            tables.columns.push(Column { over: axis, along: axis, ways, at_mm, error_mm });
        }
    }
    Ok(tables)
}

fn read_ini(file: &Named, tables: &mut Tables) -> Result<()> {
    let mut joint = None;
    for line in lines(file)? {
        let text = line.text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        if let Some(section) = text.strip_prefix("[JOINT_").and_then(|t| t.strip_suffix(']')) {
            let index = line.whole(section)?;
            joint = Axis::ALL.into_iter().find(|axis| axis.index() == index);
            continue;
        }
        let Some((key, value)) = text.split_once('=') else {
            return Err(line.faulty("this is no line of an INI file"));
        };
        let Some(axis) = joint else {
            return Err(line.faulty("it stands in no section of a joint"));
        };
        match key.trim() {
            "BACKLASH" => tables.play_mm[axis.index()] = line.number(value)?,
            "COMP_FILE" if value.trim() == name(axis) => {}
            "COMP_FILE_TYPE" if value.trim() == "0" => {}
            _ => return Err(line.faulty("nothing of the kind is written here")),
        }
    }
    Ok(())
}
