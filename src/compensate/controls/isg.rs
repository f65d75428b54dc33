//! ISG kernel and Beckhoff TF5280: the errors of the three slides, for a control that has the model of the machine itself.
//!
//! Whitespace between columns, a header that names the argument and the errors, `//` before comments, a `#` alone between blocks.
//! Values are errors, mm and rad; the control takes them off. What hangs on the sense of a slide has no place there.

use std::fmt::Write as _;

use super::asked::{Limits, Named, Written};
use super::lines::{lines, whole};
use super::points::Asked;
use crate::compensate::tables::{SlideTable, Tables};
use crate::compensate::wanted::Wanted;
use crate::error::Result;
use crate::machine::{Axis, Pivot, Side};

const CSV: &str = "volcomp.csv";
const LIST: &str = "volcomp.lis";
pub(super) const MOST_POINTS: usize = 1000;

/// Points that are nearer are one, mm.
const SAME_MM: f64 = 0.01;

fn names(axis: Axis) -> String {
    let of = ["X", "Y", "Z", "A", "B", "C"].map(|component| format!("E{component}{axis}"));
    format!("{axis} {}", of.join(" "))
}

pub(super) fn write(wanted: &Wanted, limits: &Limits) -> Result<Written> {
    let machine = wanted.machine();
    let mut text = String::from(
        "// errors of the slides by a ball-bar test, mm and rad; positions are machine coordinates, mm\n",
    );
    for axis in Axis::ALL {
        let pivot = match machine.slide(axis).pivot {
            Pivot::Carriage => "turn about its own carriage, which goes with it",
            Pivot::Base => "turn about a point that stays on its guide",
        };
        let side = match machine.topology().side(axis) {
            Side::Tool => "carries the tool",
            Side::Workpiece => {
                "carries the workpiece; errors are of the slide itself, in programmed directions of F"
            }
        };
        let _ = writeln!(text, "// {axis} {side}; its angles {pivot}");
    }
    let mut lost = Vec::new();
    for axis in Axis::ALL {
        if axis != Axis::X {
            text.push_str("#\n");
        }
        let _ = writeln!(text, "{}", names(axis));
        let travel = machine.slide(axis).travel_mm;
        let asked = Asked { wanted, over: axis, along: &Axis::ALL };
        let points = asked.even(travel, limits, &mut lost)?;
        let mut at_mm = points.at_mm.clone();
        at_mm.extend(wanted.range_mm(axis));
        at_mm.sort_by(f64::total_cmp);
        at_mm.dedup_by(|a, b| (*a - *b).abs() < SAME_MM);
        let zero = wanted.slide(axis, wanted.reference_mm(axis));
        let before = wanted.existing().slides.as_ref().map(|all| &all[axis.index()]);
        for at in at_mm {
            let of = |k: usize| points.value(|at| wanted.slide(axis, at).translation_mm[k], at);
            let now = wanted.slide(axis, at);
            let _ = write!(text, "{at:.4}");
            for k in 0..3 {
                let known = before.map_or(0.0, |table| table.at(at).translation_mm[k]);
                let _ = write!(text, " {:.7}", of(k) - zero.translation_mm[k] + known + 0.0);
            }
            for k in 0..3 {
                let known = before.map_or(0.0, |table| table.at(at).rotation_rad[k]);
                let _ = write!(text, " {:.10}", now.rotation_rad[k] + known + 0.0);
            }
            text.push('\n');
        }
    }
    let of_workpiece = machine.topology().slides(Side::Workpiece);
    let of_tool = machine.topology().slides(Side::Tool);
    let chain: String =
        of_workpiece.iter().rev().chain(of_tool).map(|axis| axis.letter()).collect();
    let list = format!(
        "workpiece_axes {}\nchain {chain}\nX 1\nY 2\nZ 3\ninterpolation GRID\nenable_splicing FALSE\nfilter_steps 20\nmanual_activation FALSE\n\
         file[0] {CSV}\nfile_format[0] ISG_CSV\n",
        of_workpiece.len()
    );
    Ok(Written {
        files: vec![(CSV.into(), text), (LIST.into(), list)],
        load: vec![
            "Name volcomp.lis in vol_comp[0].file_name of the start-up list, with vol_comp[0].max_records at least as many as the file has; X 1, Y 2, Z 3 are logical axis numbers: write yours.".into(),
            "Start the control again; `#VOLCOMP ON [ID0]` switches it on, `#VOLCOMP OFF [ID0]` off.".into(),
        ],
        unsure: vec![
            "About which point the kernel turns an angle of a slide, and in which sense it counts a slide that carries the workpiece, was not found: check one point of each slide, far from the middle in the other two.".into(),
        ],
        lost,
    })
}

pub(super) fn read(files: &[Named]) -> Result<Tables> {
    let mut read: [Option<SlideTable>; 3] = Default::default();
    for file in files {
        match file.0.as_str() {
            CSV => blocks(file, &mut read)?,
            LIST => {}
            _ => return Err(whole(&file.0, "no file of this control has this name")),
        }
    }
    let [Some(x), Some(y), Some(z)] = read else {
        return Err(whole(CSV, "it has not one block for each of X, Y and Z"));
    };
    Ok(Tables { slides: Some([x, y, z]), ..Tables::default() })
}

fn blocks(file: &Named, read: &mut [Option<SlideTable>; 3]) -> Result<()> {
    let mut now: Option<Axis> = None;
    for line in lines(file)? {
        let text = line.text.split("//").next().unwrap_or("").trim();
        if text.is_empty() {
            continue;
        }
        if text == "#" {
            now = None;
            continue;
        }
        let Some(axis) = now else {
            let axis = Axis::ALL.into_iter().find(|axis| names(*axis) == text);
            let axis = axis.ok_or_else(|| {
                line.faulty("this is no header of a block: an axis and its six errors")
            })?;
            if read[axis.index()].is_some() {
                return Err(line.faulty("there is a block of this axis already"));
            }
            read[axis.index()] = Some(SlideTable { at_mm: Vec::new(), errors: Vec::new() });
            now = Some(axis);
            continue;
        };
        let numbers =
            text.split_whitespace().map(|word| line.number(word)).collect::<Result<Vec<f64>>>()?;
        let Ok([at, errors @ ..]) = <[f64; 7]>::try_from(numbers) else {
            return Err(line.faulty("a record is a position and six errors"));
        };
        let Some(table) = read[axis.index()].as_mut() else { continue };
        if table.at_mm.last().is_some_and(|before| *before >= at) {
            return Err(line.faulty("positions must ascend"));
        }
        table.at_mm.push(at);
        table.errors.push(errors);
    }
    if read.iter().flatten().any(|table| table.at_mm.is_empty()) {
        return Err(whole(&file.0, "a block has no record"));
    }
    Ok(())
}
