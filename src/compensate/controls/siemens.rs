//! SINUMERIK 840D sl and 828D: positioning as leadscrew error compensation (LEC), all else as cross error compensation (CEC).
//!
//! LEC has one value a position, for both directions; a positive value moves the axis in the negative direction, so that it is
//! the error. CEC adds to the setpoint of its output axis, so that it is the error with the other sign; two tables with the
//! directions 1 and -1 are one by direction. Beyond its ends a CEC table holds.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::asked::{Limits, Named, SMALLEST_MM, Written};
use super::lines::{Line, lines, whole};
use super::points::Asked;
use crate::compensate::tables::{Column, Tables, Ways};
use crate::compensate::wanted::Wanted;
use crate::error::Result;
use crate::machine::Axis;

const LEC: &str = "AX_EEC.INI";
const CEC: &str = "NC_CEC.INI";
/// Points of a table, and tables, of an 828D and as an 840D comes.
pub(super) const MOST_POINTS: usize = 200;
pub(super) const MOST_TABLES: usize = 8;
/// No table has a smaller step, mm.
const LEAST_STEP_MM: f64 = 1e-3;

/// An error of cross error compensation.
struct Cross {
    over: Axis,
    along: Axis,
    /// Largest less smallest, over both senses, of what no table, one for both senses, and one for each leave, mm.
    left_mm: [f64; 3],
}

pub(super) fn write(wanted: &Wanted, limits: &Limits) -> Result<Written> {
    let mut written = Written::default();
    let mut lec = String::from("%_N_AX_EEC_INI\nCHANDATA(1)\n");
    for axis in Axis::ALL {
        let of = |at: f64| wanted.error_mm(axis, axis, at, 0.0);
        if wanted.extent_mm(of, axis) < SMALLEST_MM {
            continue;
        }
        let travel = wanted.machine().slide(axis).travel_mm;
        let asked = Asked { wanted, over: axis, along: &[axis] };
        let points = asked.even(travel, limits, &mut written.lost)?;
        for (k, at) in points.at_mm.iter().enumerate() {
            let value_mm = points.value(of, *at);
            let _ = writeln!(lec, "$AA_ENC_COMP[0,{k},{axis}1]={:.5}", value_mm + 0.0);
        }
        let (first, last) = (points.at_mm[0], points.at_mm[points.at_mm.len() - 1]);
        let _ = writeln!(
            lec,
            "$AA_ENC_COMP_STEP[0,{axis}1]={}\n$AA_ENC_COMP_MIN[0,{axis}1]={first}\n$AA_ENC_COMP_MAX[0,{axis}1]={last}\n$AA_ENC_COMP_IS_MODULO[0,{axis}1]=0",
            points.step_mm
        );
    }
    lec.push_str("M17\n");
    let cec = crossed(wanted, limits, &mut written)?;
    written.files = vec![(LEC.into(), lec), (CEC.into(), cec)];
    written.load = vec![
        "MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0] and MD18342 $MN_MM_CEC_MAX_POINTS of each table are at least the points here; a change of them deletes other data: save the archive first.".into(),
        "Set MD32700 $MA_ENC_COMP_ENABLE[0] and MD32710 $MA_CEC_ENABLE of the axes to 0, load both files as part programs, set the machine data to 1 and SD41300 $SN_CEC_TABLE_ENABLE of each table to 1.".into(),
        "Reset, reference the axes again. X1, Y1 and Z1 stand for the names of your machine axes, AX1, AX2 and AX3 for the first three: exchange them where yours differ.".into(),
    ];
    written.unsure = vec![
        "The sign of CEC follows from what it does, adding to the setpoint, and was not read in a manual of Siemens: check it with one point before it is used.".into(),
        "What LEC does beyond its ends is not certain: the table goes over the whole travel.".into(),
    ];
    Ok(written)
}

/// The tables of cross error compensation.
fn crossed(wanted: &Wanted, limits: &Limits, written: &mut Written) -> Result<String> {
    let mut text = String::from("%_N_NC_CEC_INI\nCHANDATA(1)\n");
    let mut number = 0;
    let crosses = crosses(wanted);
    for (cross, tables) in crosses.iter().zip(shared(&crosses, limits.most_tables)) {
        let (over, along) = (cross.over, cross.along);
        let left_mm = cross.left_mm[tables];
        if left_mm >= SMALLEST_MM {
            // LEC has what both directions of a positioning have in common.
            let all = tables == 0 && over != along;
            let what = if all { "the error" } else { "what depends on the direction" };
            written.lost.push(format!(
                "no table is left for {what} of {over} along {along}, {:.2} um",
                1e3 * left_mm
            ));
        }
        let ways: &[(i8, f64)] = match tables {
            0 => continue,
            1 => &[(0, 0.0)],
            _ => &[(1, 1.0), (-1, -1.0)],
        };
        // Of a positioning only what hangs on the direction is here, and that is smooth.
        let bent = if over == along { &[][..] } else { std::slice::from_ref(&cross.along) };
        let asked = Asked { wanted, over, along: bent };
        let points = asked.even(wanted.told_mm(over), limits, &mut written.lost)?;
        for (direction, sense) in ways {
            for (k, at) in points.at_mm.iter().enumerate() {
                let value_mm = -points.value(|at| held_mm(wanted, over, along, at, *sense), *at);
                let _ = writeln!(text, "$AN_CEC[{number},{k}]={:.5}", value_mm + 0.0);
            }
            let (input, output) = (over.index() + 1, along.index() + 1);
            let (first, last) = (points.at_mm[0], points.at_mm[points.at_mm.len() - 1]);
            let _ = writeln!(
                text,
                "$AN_CEC_INPUT_AXIS[{number}]=(AX{input})\n$AN_CEC_OUTPUT_AXIS[{number}]=(AX{output})\n$AN_CEC_STEP[{number}]={}\n\
                 $AN_CEC_MIN[{number}]={first}\n$AN_CEC_MAX[{number}]={last}\n$AN_CEC_DIRECTION[{number}]={direction}\n\
                 $AN_CEC_MULT_BY_TABLE[{number}]=0\n$AN_CEC_IS_MODULO[{number}]=0",
                points.step_mm
            );
            number += 1;
        }
    }
    text.push_str("M17\n");
    Ok(text)
}

/// What CEC has of an error: what both directions of a positioning have in common is in LEC, mm.
fn held_mm(wanted: &Wanted, over: Axis, along: Axis, at_mm: f64, sense: f64) -> f64 {
    let of = |sense: f64| wanted.error_mm(over, along, at_mm, sense);
    if over == along { of(sense) - of(0.0) } else { of(sense) }
}

fn crosses(wanted: &Wanted) -> Vec<Cross> {
    let pairs = Axis::ALL.into_iter().flat_map(|over| Axis::ALL.map(|along| (over, along)));
    let of = |(over, along)| {
        let held = |at: f64, sense: f64| held_mm(wanted, over, along, at, sense);
        let none = wanted.extent_both_mm(held, over);
        let one = wanted.extent_both_mm(|at, sense| held(at, sense) - held(at, 0.0), over);
        // What rounds to nothing asks for no table, and a table that takes nothing off is none.
        let one = if none - one < SMALLEST_MM { none } else { one };
        let left_mm = [none, one, if one < SMALLEST_MM { one } else { 0.0 }];
        Cross { over, along, left_mm }
    };
    pairs.map(of).filter(|cross| cross.left_mm[0] >= SMALLEST_MM).collect()
}

/// How many of the tables each error has, so that the sum of what is left is least: over the errors one after the other, the
/// least sum for every number of tables that are still free.
fn shared(crosses: &[Cross], most_tables: usize) -> Vec<usize> {
    let most_tables = most_tables.min(2 * crosses.len());
    let mut least_mm = vec![0.0; most_tables + 1];
    let mut chosen = Vec::new();
    for cross in crosses {
        let best = |free: usize| {
            let with = |tables: usize| (tables, least_mm[free - tables] + cross.left_mm[tables]);
            // Of equals the fewest tables.
            (0..=free.min(2)).map(with).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
        };
        let each: Vec<(usize, f64)> = (0..=most_tables).map(best).collect();
        least_mm = each.iter().map(|best| best.1).collect();
        chosen.push(each);
    }
    let mut free = most_tables;
    let mut tables: Vec<usize> = Vec::new();
    for each in chosen.iter().rev() {
        tables.push(each[free].0);
        free -= each[free].0;
    }
    tables.reverse();
    tables
}

/// What a file says of one table.
#[derive(Default)]
struct Raw {
    values: BTreeMap<usize, f64>,
    words: BTreeMap<String, String>,
}

pub(super) fn read(files: &[Named]) -> Result<Tables> {
    let mut tables = Tables::default();
    for file in files {
        let (head, start) = match file.0.as_str() {
            LEC => ("%_N_AX_EEC_INI", "$AA_ENC_COMP"),
            CEC => ("%_N_NC_CEC_INI", "$AN_CEC"),
            _ => return Err(whole(&file.0, "no file of this control has this name")),
        };
        let mut raw: BTreeMap<String, Raw> = BTreeMap::new();
        let mut ended = false;
        for (k, line) in lines(file)?.iter().enumerate() {
            let text = line.text.split(';').next().unwrap_or("").trim();
            match (k, text) {
                _ if ended && !text.is_empty() => return Err(line.faulty("it stands after M17")),
                (0, text) if text == head => {}
                (0, _) => return Err(line.faulty(format!("the first line is `{head}`"))),
                (1, "CHANDATA(1)") | (_, "") => {}
                (_, "M17") => ended = true,
                _ => assigned(line, text, start, &mut raw)?,
            }
        }
        if !ended {
            return Err(whole(&file.0, "it does not end with M17"));
        }
        for (index, raw) in raw {
            tables.columns.push(column(&file.0, &index, &raw)?);
        }
    }
    Ok(tables)
}

/// `$AN_CEC[0,3]=0.001` or `$AN_CEC_STEP[0]=10`; of LEC `[0,3,X1]` and `[0,X1]`.
fn assigned(line: &Line, text: &str, start: &str, raw: &mut BTreeMap<String, Raw>) -> Result<()> {
    let faulty = || line.faulty("this is no line of a compensation table");
    let (left, value) = text.split_once('=').ok_or_else(faulty)?;
    let (name, indices) = left.split_once('[').ok_or_else(faulty)?;
    let word = name.strip_prefix(start).ok_or_else(faulty)?;
    let indices: Vec<&str> = indices.strip_suffix(']').ok_or_else(faulty)?.split(',').collect();
    let lec = start == "$AA_ENC_COMP";
    let (index, point) = match (lec, word.is_empty(), &indices[..]) {
        (true, true, ["0", point, axis]) => (*axis, Some(*point)),
        (true, false, ["0", axis]) => (*axis, None),
        (false, true, [table, point]) => (*table, Some(*point)),
        (false, false, [table]) => (*table, None),
        _ => return Err(faulty()),
    };
    let table = raw.entry(index.to_owned()).or_default();
    let twice = match point {
        Some(point) => table.values.insert(line.whole(point)?, line.number(value)?).is_some(),
        None => table.words.insert(word.to_owned(), value.trim().to_owned()).is_some(),
    };
    if twice { Err(line.faulty("it was said before")) } else { Ok(()) }
}

fn column(file: &str, index: &str, raw: &Raw) -> Result<Column> {
    let word = |name: &str| {
        raw.words.get(name).map(String::as_str).ok_or_else(|| {
            whole(file, format!("the table of {index} has no {}", name.trim_start_matches('_')))
        })
    };
    let number = |name: &str| {
        let number = word(name)?.parse::<f64>().ok().filter(|number| number.abs() < 1e6);
        number.ok_or_else(|| whole(file, format!("{name} of the table of {index} is no number")))
    };
    let axis = |text: &str| match text {
        "X1" | "(AX1)" => Ok(Axis::X),
        "Y1" | "(AX2)" => Ok(Axis::Y),
        "Z1" | "(AX3)" => Ok(Axis::Z),
        _ => Err(whole(file, format!("`{text}` is none of the first three axes"))),
    };
    let (over, along, sign, ways) = if file == LEC {
        (axis(index)?, axis(index)?, 1.0, Ways::Both)
    } else {
        let ways = match word("_DIRECTION")? {
            "0" => Ways::Both,
            "1" => Ways::Plus,
            "-1" => Ways::Minus,
            _ => {
                return Err(whole(
                    file,
                    format!("the direction of the table {index} is 0, 1 or -1"),
                ));
            }
        };
        if word("_MULT_BY_TABLE")? != "0" {
            return Err(whole(file, "tables that multiply others are not read"));
        }
        (axis(word("_INPUT_AXIS")?)?, axis(word("_OUTPUT_AXIS")?)?, -1.0, ways)
    };
    if word("_IS_MODULO")? != "0" {
        return Err(whole(file, "a linear axis has no table that begins anew"));
    }
    let (step_mm, low_mm, high_mm) = (number("_STEP")?, number("_MIN")?, number("_MAX")?);
    let count = raw.values.len();
    let complete = raw.values.keys().copied().eq(0..count) && count > 0;
    let span = low_mm + step_mm * (count.max(1) - 1) as f64;
    if !complete || step_mm < LEAST_STEP_MM || (span - high_mm).abs() > 1e-6 {
        return Err(whole(
            file,
            format!("the points of the table of {index} do not go from MIN to MAX by STEP"),
        ));
    }
    let at_mm = (0..count).map(|k| low_mm + step_mm * k as f64).collect();
    let error_mm = raw.values.values().map(|value| sign * value).collect();
    Ok(Column { over, along, ways, at_mm, error_mm })
}
